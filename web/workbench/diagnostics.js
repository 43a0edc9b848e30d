// The diagnostics and the cost of the runs as a table, one column per run.
import { count, listed, text } from "../language/texts.js";
import { element, symbol, words } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { energyKind } from "../catalogue/card.js";

const degrees = (radians) => (radians === null ? "" : ` (${format((radians * 180) / Math.PI, 2)}°)`);
const ended = ({ status, stop }) => (stop ? text("row.ended", { status: words(status), t: format(stop.t, 5) }) : words(status));

// Diagnostics with rows of their own; any other is shown as it comes.
const own = ["energy", "momenta", "orbit"];

const energyRows = {
  none: [],
  error: [
    { id: "energy", name: "energy", raw: (o) => o.diagnostics.energy?.max_abs_error },
    { id: "drift", name: "drift", raw: (o) => o.diagnostics.energy?.drift_per_time },
  ],
  value: [
    { id: "energy_initial", name: "initial", raw: (o) => o.diagnostics.energy?.initial },
    { id: "energy_final", name: "final", raw: (o) => o.diagnostics.energy?.final },
  ],
};

/** The paths to the values in a diagnostic: `[[]]` for a value or a list, `[["period"], ["amplitude"]]` for an object. */
function paths(value) {
  if (value === null || typeof value !== "object" || Array.isArray(value)) return [[]];
  return Object.entries(value).flatMap(([key, part]) => paths(part).map((path) => [key, ...path]));
}

/** The rows of a diagnostic that has none of its own: one for each part that any outcome has. */
function plainRows(kind, outcomes) {
  const found = outcomes.flatMap((outcome) => paths(outcome.diagnostics[kind] ?? null)).map((path) => path.join("."));
  // A diagnostic that is null in one outcome and has parts in another is shown by its parts.
  const whole = (part, _, every) => !every.some((other) => other !== part && other.startsWith(part && `${part}.`));
  const parts = [...new Set(found)].filter(whole);
  const title = words(kind)[0].toUpperCase() + words(kind).slice(1);
  return parts.map((part) => ({
    id: [kind, part].filter(Boolean).join("."), name: part ? `${title}: ${words(part.replaceAll(".", " "))}` : title,
    raw: (o) => part.split(".").filter(Boolean).reduce((at, key) => at?.[key], o.diagnostics[kind]), shown: plainly,
  }));
}

/** Any value as text; a list is shown by its length and its beginning. */
function plainly(value) {
  if (typeof value === "number") return format(value);
  if (typeof value === "boolean") return text(value ? "yes" : "no");
  if (typeof value === "string") return words(value);
  if (value.length === 0) return text("none");
  const some = value.slice(0, 3).map((item) => (item === null || typeof item === "number" ? format(item, 4) : "…"));
  return listed(value.length > 3 ? [...some, `… (${value.length})`] : some);
}

/** The rows for these outcomes: `{id, name, doc, raw: outcome → value, shown?: value → text}`. */
function rows(outcomes, problem) {
  const kinds = new Set(outcomes.flatMap((outcome) => Object.keys(outcome.diagnostics)));
  const momenta = new Set(outcomes.flatMap((outcome) => Object.keys(outcome.diagnostics.momenta ?? {})));
  const symbolOf = (name) => problem.invariants.find((invariant) => invariant.name === name)?.symbol ?? words(name);
  return [
    { id: "status", name: text("row.status"), raw: (o) => o.status, shown: (_, o) => ended(o) },
    ...energyRows[energyKind(problem)].map((row) => ({ ...row, name: text(`row.${row.name}`) })),
    ...[...momenta].map((name) => ({
      id: name, name: [`${text("row.change")} `, symbol(symbolOf(name))], doc: words(name),
      raw: (o) => o.diagnostics.momenta?.[name]?.max_abs_error,
    })),
    ...(kinds.has("orbit") ? [
      { id: "apsidal_rotation", name: text("row.precession"), doc: text("row.precession.doc"),
        raw: (o) => o.diagnostics.orbit?.apsidal_rotation, shown: (x) => format(x) + degrees(x) },
      { id: "closure", name: text("row.closure"), doc: text("row.closure.doc"),
        raw: (o) => o.diagnostics.orbit?.closure },
    ] : []),
    ...[...kinds].filter((kind) => !own.includes(kind)).flatMap((kind) => plainRows(kind, outcomes)),
    ...(outcomes.some(({ back }) => back) ? [{ id: "missed", name: text("row.missed"), doc: text("row.missed.doc"),
                                              raw: (o) => (o.back && !o.back.stop ? o.back.missed : null) }] : []),
    { id: "steps", name: text("row.steps"), raw: (o) => o.cost.steps, shown: count },
    { id: "force_evaluations", name: text("row.forces"), raw: (o) => o.cost.force_evaluations, shown: count },
    { id: "nanoseconds_per_step", name: text("row.time"), doc: text("row.time.doc"),
      raw: (o) => o.cost.nanoseconds_per_step,
      shown: (x) => (x < 1e3 ? `${format(x)} ns` : `${format(x / 1e3)} µs`) },
  ];
}

/** The whole of a list as text, for the tooltip of its beginning. */
const whole = (value) => (Array.isArray(value) ? value.join(", ") : "");

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
      const textContent = value === null ? "–" : shown(value, outcome);
      row.append(element("td", {}, element("data", { value: value ?? "", textContent, title: whole(value) })));
    }
    return row;
  });
  table.replaceChildren(element("thead", {}, head), element("tbody", {}, ...body));
}
