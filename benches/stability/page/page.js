// Draws the rows: for each case a matrix of parameters and methods, whose cells tell their numbers.
const KINDS = ["stable", "bounded", "drifting", "diverged", "refused", "no solution"];
const look = (verdict) => verdict === "no solution" ? "none" : verdict;
const distinct = (values) => [...new Set(values)];

/** The word of a cell. */
function word(row) {
  switch (row.verdict) {
    case "stable": return short(row.energy_error);
    case "bounded": return `${short(row.energy_error)}, from ${row.first_step}`;
    case "refused": return "refused";
    case "no solution": return `none at ${row.first_step}`;
    default: return `${row.verdict} at ${row.first_step}`;
  }
}

/** Shows every number of a row. */
function tell(row) {
  const facts = [
    ["verdict", row.verdict], ["first step", row.first_step], ["largest energy error", row.energy_error],
    ["slope per step", row.slope_per_step === null ? null : `${short(row.slope_per_step)} ± ${short(row.slope_half_width)}`],
    ["h, steps", `${short(row.h)}, ${row.steps}`], ["largest |φ| / ‖G‖‖q‖", row.constraint_error],
    ["largest |G v| of its terms", row.hidden_constraint_error], ["largest change of a momentum", row.momentum_error],
    ["check", row.checked_steps === 0 ? null
      : `${row.checked_steps} steps, worst ${short(row.check_roundings)} roundings at step ${row.check_step}: ${row.check_equation}`],
    ["theory", row.theory], ["measured", row.figures], ["reason", row.reason], ["faults", row.faults],
  ].filter(([, value]) => value !== null && value !== undefined && value !== "");
  const list = element("dl");
  for (const [name, value] of facts) list.append(element("dt", {}, name), element("dd", {}, short(value)));
  document.getElementById("cell").replaceChildren(
    element("strong", {}, `${row.case}: ${row.parameter}, ${row.method}`), list);
}

function cell(row) {
  if (row === undefined) return element("td");
  const dot = element("span", { class: `dot ${look(row.verdict)}`, title: row.verdict });
  const node = element("td", { tabindex: 0, class: row.agrees ? "" : "fault", "aria-label": `${row.method}: ${row.verdict}, ${word(row)}` },
    dot, word(row));
  node.addEventListener("click", () => tell(row));
  node.addEventListener("focus", () => tell(row));
  return node;
}

function matrix(rows) {
  const methods = distinct(rows.map((row) => row.method));
  const head = element("tr", {}, element("th", { scope: "col" }, ""), ...methods.map((method) => element("th", { scope: "col" }, method)));
  const at = new Map(rows.map((row) => [`${row.parameter}\n${row.method}`, row]));
  const lines = distinct(rows.map((row) => row.parameter)).map((parameter) =>
    element("tr", {}, element("th", { scope: "row" }, parameter),
      ...methods.map((method) => cell(at.get(`${parameter}\n${method}`)))));
  return element("div", { class: "matrix" },
    element("table", {}, element("thead", {}, head), element("tbody", {}, ...lines)));
}

document.getElementById("machine").textContent = results.machine.processor + ", " + results.machine.compiler + ", revision " +
  results.machine.revision + (results.quick ? "; a first look, by --quick" : "");
const counts = document.getElementById("counts");
for (const kind of KINDS) {
  const number = results.rows.filter((row) => row.verdict === kind).length;
  counts.append(element("span", {}, element("span", { class: `dot ${look(kind)}` }), `${kind} ${number}`));
}
const main = document.getElementById("main"), nav = document.getElementById("cases");
for (const { name, summary } of results.cases) {
  const rows = results.rows.filter((row) => row.case === name);
  if (rows.length === 0) continue;
  nav.append(element("a", { href: `#${name}` }, name));
  main.append(element("section", { "aria-labelledby": name }, element("h2", { id: name }, name),
    element("p", {}, summary[0].toUpperCase() + summary.slice(1) + "."), matrix(rows)));
}
const faulty = results.rows.filter((row) => !row.agrees);
if (faulty.length > 0) {
  const section = document.getElementById("faults");
  section.hidden = false;
  for (const row of faulty) {
    section.querySelector("ul").append(element("li", {}, `${row.case}: ${row.parameter}, ${row.method}: ${row.faults}`));
  }
}
