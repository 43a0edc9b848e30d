// The diagnostics and the cost of the runs as a table, one column per run.
import { element, symbol, words } from "./forms.js";
import { count, format } from "./numbers.js";

const degrees = (radians) => (radians === null ? "" : ` (${format((radians * 180) / Math.PI, 2)}°)`);
const ended = ({ status, stop }) => (stop ? `${status} at t = ${format(stop.t, 5)}` : status);

/** The rows for these outcomes: `{id, name, doc, raw: outcome → number, shown?: number → text}`. */
function rows(outcomes, problem) {
  const offered = (kind) => outcomes.some((outcome) => outcome.diagnostics[kind]);
  const momenta = new Set(outcomes.flatMap((outcome) => Object.keys(outcome.diagnostics.momenta ?? {})));
  const symbolOf = (name) => problem.invariants.find((invariant) => invariant.name === name)?.symbol ?? words(name);
  return [
    { id: "status", name: "Run", raw: (o) => o.status, shown: (_, o) => ended(o) },
    { id: "energy", name: "Largest |H − H₀|", raw: (o) => o.diagnostics.energy?.max_abs_error },
    { id: "drift", name: "Drift of H per time", raw: (o) => o.diagnostics.energy?.drift_per_time },
    ...[...momenta].map((name) => ({
      id: name, name: ["Largest change of ", symbol(symbolOf(name))], doc: words(name),
      raw: (o) => o.diagnostics.momenta?.[name]?.max_abs_error,
    })),
    ...(offered("orbit") ? [
      { id: "apsidal_rotation", name: "Precession per period",
        doc: "apsidal rotation in radians, mean of the revolutions; the true orbit has none",
        raw: (o) => o.diagnostics.orbit?.apsidal_rotation, shown: (x) => format(x) + degrees(x) },
      { id: "closure", name: "Closure", doc: "distance by which the last revolution misses the start",
        raw: (o) => o.diagnostics.orbit?.closure },
    ] : []),
    { id: "steps", name: "Steps", raw: (o) => o.cost.steps, shown: count },
    { id: "force_evaluations", name: "Force evaluations", raw: (o) => o.cost.force_evaluations, shown: count },
    { id: "nanoseconds_per_step", name: "Time per step", doc: "diagnostics and recording included; short runs measure little",
      raw: (o) => o.cost.nanoseconds_per_step,
      shown: (x) => (x < 1e3 ? `${format(x)} ns` : `${format(x / 1e3)} µs`) },
  ];
}

/** Fills `table`; `runs` are `[{name, title, outcome}]`. */
export function fill(table, runs, problem) {
  if (!runs.length) return table.replaceChildren();
  const head = element("tr", {}, element("td"), ...runs.map((run) => {
    const cell = element("th", { scope: "col", textContent: run.name, title: run.title });
    cell.dataset.run = run.name;
    return cell;
  }));
  const body = rows(runs.map((run) => run.outcome), problem).map(({ id, name, doc = "", raw, shown = (x) => format(x) }) => {
    const row = element("tr", {}, element("th", { scope: "row", title: doc }, ...[name].flat()));
    row.dataset.row = id;
    for (const { outcome } of runs) {
      const value = raw(outcome) ?? null;
      const text = value === null ? "–" : shown(value, outcome);
      row.append(element("td", {}, element("data", { value: value ?? "", textContent: text })));
    }
    return row;
  });
  table.replaceChildren(element("thead", {}, head), element("tbody", {}, ...body));
}
