// What the page reads off a problem's card.

/** The variables of the motion. The optional ones are only ways to start it, and are neither asked for nor drawn. */
export const motion = (problem) => problem.variables.filter((variable) => !variable.optional);

/** What may stand on an axis of the plane, as the options of a select. The first two are the usual choice. */
export const axes = (problem) =>
  [...motion(problem), { name: "t" }].map(({ name, symbol }) => ({ id: name, title: symbol || name }));

export const presetOf = (problem, name) => problem.presets.find((preset) => preset.name === name);

/** The cards of the forms, with a preset's values for defaults where one is named. */
export function cards(problem, preset = { parameters: {}, initial: {} }) {
  const start = { name: "t", doc: "when the run starts", default: 0 };
  const given = (list, values) => list.map((card) => ({ ...card, default: values[card.name] ?? card.default }));
  return { parameters: given(problem.parameters, preset.parameters),
           initial: given([...problem.variables, start], preset.initial) };
}

/** What there is to see of the energy: its "error" where the motion keeps it, else its "value", or "none" at all. */
export function energyKind({ columns, invariants }) {
  if (!columns.includes("energy")) return "none";
  return invariants.some((invariant) => invariant.name === "energy") ? "error" : "value";
}

export const columns = (problem) =>
  ["t", ...motion(problem).map((variable) => variable.name), ...(energyKind(problem) === "none" ? [] : ["energy"])];

/** Those of its diagnostics that the page shows: the others cost more than the run itself. */
export const diagnostics = (problem) =>
  ["energy", "momenta", "orbit", "decay", "entropy", "zeros", "cycle"].filter((kind) => problem.diagnostics.includes(kind));
