// Draws the results: one section per scene, with figures as SVG and a table that can be sorted.
const COLOURS = 8;
const MARKS = ["circle", "square", "triangle", "diamond", "cross"];
const shown = new Set(results.methods.map((method) => method.name));
const look = new Map(results.methods.map((method, i) => [method.name, {
  colour: `var(--c${i % COLOURS})`,
  mark: MARKS[(i + Math.floor(i / COLOURS)) % MARKS.length],
  dash: method.is_member ? "" : method.path === "generic" ? "2 3" : "6 3",
}]));

// Numbers.
function duration(seconds) {
  for (const [unit, size] of [["s", 1], ["ms", 1e-3], ["µs", 1e-6]]) {
    if (seconds >= size) return `${(seconds / size).toPrecision(3)} ${unit}`;
  }
  return `${(seconds / 1e-9).toPrecision(3)} ns`;
}

// Figures.
const WIDTH = 560, HEIGHT = 380, LEFT = 52, TOP = 10, BOTTOM = 42;

/** Curves `{name, points: [[x, y], ..], label, labelAt}` on axes of which y, and x unless it is linear, are logarithmic. */
function plot({ title, x: xTitle, y: yTitle, curves, linearX = false, right: RIGHT = 24 }) {
  const figure = element("figure", {}, element("figcaption", {}, title));
  const visible = curves.filter((curve) => shown.has(curve.name));
  const points = visible.flatMap((curve) => curve.points).filter(([, y]) => y > 0);
  const drawing = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img",
    "aria-label": `${title}: ${yTitle} over ${xTitle}, ${visible.length} methods. The numbers are in the table of this scene.` });
  figure.append(drawing);
  if (points.length === 0) {
    drawing.append(svg("text", { x: WIDTH / 2, y: HEIGHT / 2, "text-anchor": "middle", class: "faint" }, "nothing to show"));
    return figure;
  }
  const log = Math.log10;
  const xs = points.map(([x]) => x), ys = points.map(([, y]) => log(y));
  const [xMin, xMax] = linearX ? [0, Math.max(...xs)] : [Math.floor(Math.min(...xs.map(log)) * 2) / 2, Math.ceil(Math.max(...xs.map(log)) * 2) / 2];
  const yMin = Math.floor(Math.min(...ys)), yMax = Math.max(Math.min(Math.ceil(Math.max(...ys)), 3), yMin + 1);
  const px = (x) => LEFT + ((linearX ? x : log(x)) - xMin) / (xMax - xMin || 1) * (WIDTH - LEFT - RIGHT);
  const py = (y) => TOP + (yMax - Math.min(log(y), yMax)) / (yMax - yMin) * (HEIGHT - TOP - BOTTOM);
  const stride = Math.ceil((yMax - yMin) / 9);
  for (let exponent = yMin; exponent <= yMax; exponent += stride) {
    const y = py(10 ** exponent);
    drawing.append(svg("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: y, y2: y, class: "grid" }),
      svg("text", { x: LEFT - 6, y: y + 4, "text-anchor": "end", class: "faint" }, power(exponent)));
  }
  for (const [x, text] of ticks(xMin, xMax, linearX)) {
    drawing.append(svg("line", { x1: px(x), x2: px(x), y1: TOP, y2: HEIGHT - BOTTOM, class: "grid" }),
      svg("text", { x: px(x), y: HEIGHT - BOTTOM + 15, "text-anchor": "middle", class: "faint" }, text));
  }
  drawing.append(svg("path", { d: `M${LEFT} ${TOP}V${HEIGHT - BOTTOM}H${WIDTH - RIGHT}`, fill: "none", class: "axis" }),
    svg("text", { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 8, "text-anchor": "middle" }, xTitle),
    svg("text", { transform: `translate(12 ${(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)`, "text-anchor": "middle" }, yTitle));
  const labels = [], taken = [];
  for (const curve of visible) {
    const { colour, dash } = look.get(curve.name);
    const spots = curve.points.filter(([x, y]) => y > 0 && (linearX || x > 0)).map(([x, y]) => [px(x), py(y), x, y]);
    if (spots.length === 0) continue;
    const path = spots.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
    drawing.append(svg("path", { d: path, class: "curve", stroke: colour, "stroke-dasharray": dash }));
    if (spots.length <= 80) {
      for (const [x, y, dataX, dataY] of spots) {
        const dot = mark(curve.name, x, y);
        dot.append(svg("title", {}, `${curve.name}: ${xTitle} ${short(dataX)}, ${yTitle} ${short(dataY)}`));
        drawing.append(dot);
      }
    }
    if (curve.label) labels.push([curve.label, spots.at(curve.labelAt ?? -1), colour]);
  }
  // On top of all curves.
  for (const label of labels) place(drawing, ...label, taken);
  return figure;
}

function ticks(min, max, linear) {
  if (!linear) {
    const whole = [];
    for (let e = Math.ceil(min); e <= max; e++) whole.push([10 ** e, e >= 0 ? `${10 ** e}` : power(e)]);
    return whole;
  }
  const rough = (max - min) / 5, base = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * base).find((s) => s >= rough);
  return Array.from({ length: Math.floor(max / step + 1e-9) + 1 }, (_, i) => [i * step, short(i * step)]);
}

/** A mark of the method at a point. */
function mark(name, x, y) {
  const { colour, mark: kind } = look.get(name), r = 3;
  const shapes = {
    circle: () => svg("circle", { cx: x, cy: y, r }),
    square: () => svg("rect", { x: x - r, y: y - r, width: 2 * r, height: 2 * r }),
    triangle: () => svg("path", { d: `M${x} ${y - r - 1}l${r + 1} ${2 * r}h${-2 * r - 2}z` }),
    diamond: () => svg("path", { d: `M${x} ${y - r - 1}l${r + 1} ${r + 1}l${-r - 1} ${r + 1}l${-r - 1} ${-r - 1}z` }),
    cross: () => svg("path", { d: `M${x - r} ${y - r}l${2 * r} ${2 * r}M${x + r} ${y - r}l${-2 * r} ${2 * r}`, "stroke-width": 1.6 }),
  };
  const shape = shapes[kind]();
  shape.setAttribute("fill", colour);
  shape.setAttribute("stroke", colour);
  return shape;
}

/** Writes a label beside a point, where no other label is. */
function place(drawing, text, [x, y], colour, taken) {
  const width = 6 * text.length + 4, height = 12;
  const places = [[7, 4], [7, -8], [7, 16], [-width - 5, 4], [7, -20], [7, 28], [-width - 5, -10], [-width - 5, 18]];
  const boxes = places.map(([dx, dy]) => ({ x: Math.min(x + dx, WIDTH - width), y: Math.min(Math.max(y + dy, 12), HEIGHT - BOTTOM - 2) }));
  const isFree = (box) => taken.every((other) => Math.abs(other.x - box.x) >= Math.max(width, other.width) || Math.abs(other.y - box.y) >= height);
  const box = boxes.find(isFree);
  if (!box) return;
  taken.push({ ...box, width });
  const label = svg("text", { x: box.x, y: box.y, class: "label" }, text);
  label.style.fill = colour;
  drawing.append(label);
}

// Sections.
const QUANTITIES = [
  ["position_error", "Position error", "‖q − q*‖"], ["energy_error", "Energy error", "|H − H₀|"],
  ["constraint_error", "Constraint error", "|φ|"], ["momentum_error", "Momentum error", "|J − J₀|"],
];

function sceneSection(scene) {
  const rows = results.rows.filter((row) => row.scene === scene.name);
  const of = (list) => list.filter((item) => item.scene === scene.name);
  const orders = new Map(of(results.orders).map((fit) => [fit.method, fit]));
  const verdict = of(results.verdicts)[0];
  const figures = element("div", { class: "figures" });
  // Runs that end farther off than the configuration is long would only stretch the axes.
  const isUseful = (row) => row.seconds !== null && row.position_error !== null && row.position_error <= scene.size;
  const section = element("section", { id: scene.name, "aria-labelledby": `${scene.name}-title` },
    element("h2", { id: `${scene.name}-title` }, scene.name),
    element("p", {}, scene.summary),
    element("p", { class: "facts" }, `${scene.n_coordinates} coordinates, ${scene.n_constraints} constraints, horizon ${short(scene.horizon)}; ` +
      `reference: ${scene.reference}. ${scene.origin}`),
    element("p", { class: "verdict" }, verdict ? verdict.sentence : ""), figures);
  const draw = () => {
    figures.replaceChildren();
    for (const [key, title, yTitle] of QUANTITIES) {
      const curves = results.methods.map(({ name }) => ({
        name,
        ...curve(rows.filter((row) => row.method === name && isUseful(row)), key, orders.get(name)),
      })).filter((curve) => curve.points.length > 0);
      if (curves.length > 0) figures.append(plot({ title, x: "run time in seconds", y: yTitle, curves }));
    }
    const long = of(results.long_runs);
    if (long.length > 0) {
      figures.append(plot({ title: "Energy error over a long time, at about equal run time", x: "time", y: "|H − H₀|", linearX: true, right: 110,
        curves: long.map((run) => ({ name: run.method, points: run.times.map((t, i) => [t, run.energy_errors[i]]),
          label: run.status === "ok" ? run.method : `${run.method} fails` })) }));
    }
  };
  draw();
  document.addEventListener("methods", draw);
  section.append(table("Times and orders", timesHead(), timesRows(rows, verdict, orders)),
    table("All runs", Object.keys(results.rows[0]).filter((key) => key !== "scene"), rows.map((row) => Object.entries(row).filter(([key]) => key !== "scene").map(([, value]) => value))));
  return section;
}

/** Points of one method, with its fitted order at the finest step of the fit. */
function curve(rows, key, fit) {
  const measured = rows.filter((row) => row[key] !== null);
  const isLabelled = key === "position_error" && fit !== undefined;
  return {
    points: measured.map((row) => [row.seconds, row[key]]),
    label: isLabelled ? fit.order.toFixed(2) : "",
    labelAt: isLabelled ? measured.findIndex((row) => row.h === fit.to_h) : -1,
  };
}

const LEVELS = results.errors.map((error) => error.toExponential(0));
const timesHead = () => ["method", "nominal order", "fitted order", ...LEVELS.map((level) => `µs to ${level}`), "note"];
function timesRows(rows, verdict, orders) {
  return results.methods.map((method) => {
    const times = verdict?.seconds.find(([name]) => name === method.name)?.[1] ?? LEVELS.map(() => null);
    const fit = orders.get(method.name);
    const note = rows.filter((row) => row.method === method.name).every((row) => row.seconds === null)
      ? rows.find((row) => row.method === method.name)?.status ?? "not measured" : "";
    return [method.name, method.order, fit ? Number(fit.order.toFixed(2)) : null, ...times.map((t) => t === null ? null : t * 1e6), note];
  });
}

/** A table whose columns sort when their heads are pressed. */
function table(title, head, rows) {
  const body = element("tbody");
  const fill = (sorted) => body.replaceChildren(...sorted.map((row) => element("tr", {},
    ...row.map((cell) => element("td", typeof cell === "number" ? { class: "number" } : {}, short(cell))))));
  const heads = head.map((text, column) => {
    const button = element("button", { type: "button" }, text), cell = element("th", { scope: "col" }, button);
    button.addEventListener("click", () => {
      const direction = cell.getAttribute("aria-sort") === "ascending" ? "descending" : "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      cell.setAttribute("aria-sort", direction);
      const sign = direction === "ascending" ? 1 : -1;
      // Empty cells come last in both directions.
      fill([...rows].sort((a, b) => a[column] === null ? 1 : b[column] === null ? -1
        : sign * (typeof a[column] === "number" ? a[column] - b[column] : String(a[column]).localeCompare(String(b[column])))));
    });
    return cell;
  });
  fill(rows);
  return element("details", {}, element("summary", {}, `${title} (${rows.length} rows)`),
    element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": title }, element("table", {}, element("thead", {}, element("tr", {}, ...heads)), body)));
}

/** Factors of the specialised over the generic path, one bar per scene and method. */
function speedups() {
  const bars = results.speedups.map((s) => ({ label: `${s.scene}, ${s.method}`, time: s.generic_ns / s.specialised_ns,
    instructions: s.specialised_instructions ? s.generic_instructions / s.specialised_instructions : null }));
  if (bars.length === 0) return element("p", {}, "Not measured.");
  const row = 22, left = 250, width = 1000, height = bars.length * row + 20;
  const most = Math.max(...bars.flatMap((bar) => [bar.time, bar.instructions ?? 0]));
  const length = (value) => value / most * (width - left - 230);
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": "Speed-up of the specialised over the generic path, by scene and method; the numbers stand beside the bars." });
  bars.forEach((bar, i) => {
    const y = 8 + i * row;
    drawing.append(svg("text", { x: left - 8, y: y + 12, "text-anchor": "end" }, bar.label),
      svg("rect", { x: left, y, width: length(bar.time), height: 8, fill: "var(--c0)" }));
    if (bar.instructions !== null) drawing.append(svg("rect", { x: left, y: y + 8, width: length(bar.instructions), height: 6, fill: "var(--c1)" }));
    drawing.append(svg("text", { x: left + length(Math.max(bar.time, bar.instructions ?? 0)) + 8, y: y + 12 },
      `${bar.time.toFixed(0)} × in time` + (bar.instructions === null ? "" : `, ${bar.instructions.toFixed(0)} × in instructions`)));
  });
  return element("figure", {}, drawing);
}

function legend() {
  const box = document.getElementById("legend");
  const inputs = [];
  for (const method of results.methods) {
    const input = element("input", { type: "checkbox" });
    input.checked = true;
    inputs.push(input);
    input.addEventListener("change", () => {
      if (input.checked) shown.add(method.name); else shown.delete(method.name);
      document.dispatchEvent(new Event("methods"));
    });
    const { colour, dash } = look.get(method.name);
    const sample = svg("svg", { viewBox: "0 0 30 12", "aria-hidden": "true" });
    sample.style.width = "30px";
    sample.append(svg("path", { d: "M0 6H30", class: "curve", stroke: colour, "stroke-dasharray": dash }), mark(method.name, 15, 6));
    box.append(element("label", { title: method.summary }, input, sample, `${method.name} (${method.order})`));
  }
  for (const [text, state] of [["all", true], ["none", false]]) {
    const button = element("button", { type: "button" }, text);
    button.addEventListener("click", () => {
      results.methods.forEach((method, i) => { inputs[i].checked = state; if (state) shown.add(method.name); else shown.delete(method.name); });
      document.dispatchEvent(new Event("methods"));
    });
    box.append(button);
  }
}

const { machine } = results;
document.getElementById("machine").textContent = `${new Date(machine.date * 1000).toISOString().slice(0, 16).replace("T", " ")} UTC; ${machine.processor}, ` +
  `${machine.cores} cores, ${machine.system}; ${machine.compiler}, flags: ${machine.flags || "none"}, ${machine.vector_instructions}; revision ${machine.revision}` +
  (results.quick ? "; a quick measurement, for a first look" : "");
document.getElementById("scenes").append(...results.scenes.map((scene) => element("a", { href: `#${scene.name}` }, scene.name)));
document.getElementById("speedups").append(speedups());
legend();
document.getElementById("main").append(...results.scenes.map(sceneSection));
