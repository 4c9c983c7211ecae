
// Figures of the long runs: for each motion the energy, the constraints, the velocities along them and the momenta of every method.
const METHODS = distinct(results.long_runs.map((run) => run.method));
const colour = (method) => `var(--c${METHODS.indexOf(method) % 8})`;
const QUANTITIES = [
  ["energy", "|H − H₀|"], ["constraint", "|φ| / ‖G‖‖q‖"], ["hidden_constraint", "|G v| of its terms"], ["momentum", "change of a momentum"],
];

/** One quantity of all runs over their steps; logarithms of the quantity. */
function longRunFigure(title, quantity, runs) {
  const width = 560, height = 300, left = 52, right = 14, top = 10, bottom = 40;
  const figure = element("figure", {}, element("figcaption", {}, title));
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img",
    "aria-label": `${title} over steps, ${runs.length} methods. The largest values are in the table.` });
  figure.append(drawing);
  const values = runs.flatMap((run) => run.series[quantity]).filter((value) => value > 0);
  const low = Math.floor(Math.log10(Math.min(...values))), high = Math.max(Math.ceil(Math.log10(Math.max(...values))), low + 1);
  const last = Math.max(...runs.flatMap((run) => run.series.steps));
  const px = (step) => left + step / last * (width - left - right);
  const py = (value) => top + (high - Math.max(value > 0 ? Math.log10(value) : low, low)) / (high - low) * (height - top - bottom);
  for (let exponent = low; exponent <= high; exponent += Math.ceil((high - low) / 8)) {
    const y = py(10 ** exponent);
    drawing.append(svg("line", { x1: left, x2: width - right, y1: y, y2: y, class: "grid" }),
      svg("text", { x: left - 6, y: y + 4, "text-anchor": "end", class: "faint" }, power(exponent)));
  }
  for (const part of [0, 0.25, 0.5, 0.75, 1]) {
    drawing.append(svg("text", { x: px(part * last), y: height - bottom + 15, "text-anchor": part === 1 ? "end" : "middle", class: "faint" }, short(Math.round(part * last))));
  }
  drawing.append(svg("path", { d: `M${left} ${top}V${height - bottom}H${width - right}`, fill: "none", class: "axis" }),
    svg("text", { x: (left + width - right) / 2, y: height - 6, "text-anchor": "middle" }, "steps"));
  for (const { method, series } of runs) {
    const spots = series.steps.map((step, i) => [step, series[quantity][i]]).filter(([, value]) => value !== null);
    const path = spots.map(([step, value], i) => `${i ? "L" : "M"}${px(step).toFixed(1)} ${py(value).toFixed(1)}`).join("");
    const curve = svg("path", { d: path, class: "curve", stroke: colour(method) });
    curve.append(svg("title", {}, method));
    drawing.append(curve);
  }
  return figure;
}

if (results.long_runs.length > 0) {
  const section = document.getElementById("long-runs");
  section.hidden = false;
  const legend = element("p", { class: "counts" });
  for (const method of METHODS) {
    const dot = element("span", { class: "dot" });
    dot.style.background = colour(method);
    legend.append(element("span", {}, dot, method));
  }
  section.append(legend);
  for (const parameter of distinct(results.long_runs.map((run) => run.parameter))) {
    const runs = results.long_runs.filter((run) => run.parameter === parameter);
    // Not every motion keeps a momentum.
    const kept = QUANTITIES.filter(([quantity]) => runs.some((run) => run.series[quantity].some((value) => value > 0)));
    const figures = kept.map(([quantity, title]) => longRunFigure(title, quantity, runs));
    section.append(element("h3", {}, parameter), element("div", { class: "figures" }, ...figures));
  }
  nav.append(element("a", { href: "#long-runs" }, "long runs"));
}
