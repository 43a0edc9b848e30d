// What the page reads off the cards of a problem and a scheme.
import { spelled, text } from "../language/texts.js";
import { words } from "../forms/forms.js";

/** The variables of the motion. The optional ones are only alternative ways to start it, and are neither requested nor drawn. */
export const motion = (problem) => problem.variables.filter((variable) => !variable.optional);

// The scenes of the catalogue that depend on time, because their cards do not say so.
const timed = ["driven_oscillator", "modulated_oscillator", "spin_orbit", "perturbed_kepler", "lane_emden"];
/** Whether the equations of motion of a scene do not depend on time. */
export const isAutonomous = ({ id, form }) => form?.autonomous ?? !timed.includes(id);

/** Whether a scene has more variables than anybody would choose among: then only those that are drawn are requested. */
const crowded = (problem) => motion(problem).length > 64;

/**
 * What may stand on an axis of the plane, as the options of a select: any column that is a number. The first two are the
 * usual choice.
 */
export function axes(problem, own = []) {
  const moving = [...motion(problem).slice(0, crowded(problem) ? 2 : undefined), { name: "t" }].map(({ name, symbol }) => ({ id: name, title: symbol || name }));
  const others = problem.columns.filter((name) => name !== "parameter" && !problem.variables.some((one) => one.name === name && !one.optional) && name !== "t");
  const derived = problem.columns.includes("energy") ? [{ id: "error_of_energy", title: "|H − H₀| / |H₀|" }] : [];
  return [...moving, ...others.map((name) => ({ id: name, title: words(name) })), ...derived,
          ...own.map(({ name }) => ({ id: name, title: name }))];
}

/**
 * What the workbench begins with where the usual would show little: the span, the axes, a scheme that follows a fast passage.
 */
const openings = {
  damped_kepler: { scheme: "time_transformed" }, perturbed_kepler: { scheme: "time_transformed" },
  lorenz: { until: 40 }, // both wings
  lane_emden: { x: "t", y: "q" }, spin_orbit: { x: "t", y: "p" }, cosmological_oscillator: { x: "q", y: "s" },
};
/** The scheme that a problem begins with: one that keeps its structure, if one fits; for equations as text that is unknown. */
export const usualScheme = ({ id, schemes, columns }) => [
  openings[id]?.scheme, "leapfrog", "contact_leapfrog",
  columns.includes("energy") ? "lifted_splitting" : !schemes.includes("contact_splitting") && "runge_kutta_4",
].find((one) => schemes.includes(one));
export const spanOf = ({ id, until }, preset) => preset?.until?.t ?? openings[id]?.until ?? until.t;
export const usualAxes = ({ id }, [first, second], z = "") => ({ x: first, y: second, z: "", ...(z ? {} : openings[id]) });

/** The preset of a problem or a scheme by its name. */
export const presetOf = ({ presets }, name) => presets.find((preset) => preset.name === name);

/** The cards of the forms, with a preset's values for defaults where one is named. */
export function cards(problem, preset = { parameters: {}, initial: {} }) {
  const start = { name: "t", doc: text("field.start"), default: 0 };
  const slides = (card) => !crowded(problem) && Number.isFinite(card.default) && (card.type ?? "number") === "number" && !card.optional;
  const given = (list, values) => list.map((card) => ({ ...card, default: values[card.name] ?? card.default }))
    .map((card) => ({ ...card, slides: slides(card) && card !== start && card.name !== "t" }));
  return { parameters: given(problem.parameters, preset.parameters),
           initial: given([...problem.variables, start], preset.initial) };
}

/** The parameters that determine how fine a run is: `refine` divides the suggested values. Those of a preset are taken as given. */
export const fineness = ["step", "theta", "sigma", "tolerance"];

/** The initial accuracy for `auto`. */
const accuracy = "1e-6";

/** A scheme's parameters, with the problem's suggestions and then a preset's values for defaults. */
export function schemeCards(scheme, { suggested = {} }, preset, refine) {
  return scheme.parameters.map((card) => {
    if (scheme.id === "auto" && card.name === "accuracy") return { ...card, default: accuracy };
    const named = preset?.parameters[card.name];
    if (named !== undefined) return { ...card, default: named };
    const value = suggested[card.suggested] ?? card.default;
    return { ...card, default: fineness.includes(card.suggested) ? value / refine : value };
  });
}

/** A few words that distinguish a scheme and its settings from others; a preset stands for most of the settings. */
export function title({ parameters }, scheme) {
  const preset = scheme.preset !== "default" && scheme.preset;
  const chosen = ({ name, type, default: usual }) => name !== "composition" && name in scheme && scheme[name] !== usual &&
    (type === "choice" || type === "integer");
  const said = ({ name, type }) => (type === "choice" ? scheme[name] : `${words(name)} ${scheme[name]}`);
  const composition = scheme.composition !== "none" && scheme.composition;
  const variant = [preset, composition, ...(preset ? [] : parameters.filter(chosen).map(said))].filter(Boolean);
  const sizes = parameters.filter(({ name }) => fineness.includes(name) && name in scheme);
  return [words(scheme.id) + (variant.length ? ` (${variant.map(words).join(", ")})` : ""),
          ...sizes.map(({ name, symbol }) => `${symbol || words(name)} = ${spelled(shortest(scheme[name]))}`)].join(", ");
}

/** A value without digits that nobody chose. */
const shortest = (value) => (String(value).length > 12 && Number.isFinite(value) ? Number(value.toPrecision(4)) : value);

/** The scheme's presets as the options of a select; the first option stands for no preset. */
export function schemePresets({ presets }) {
  const offered = presets.map(({ name }) => ({ id: name, title: words(name) }));
  const first = offered.find(({ id }) => id === "default") ?? { id: "", title: text("preset.default") };
  return [first, ...offered.filter((option) => option !== first)];
}

/** What is shown of the energy: its "error" where the motion conserves it, else its "value", or "none". */
export function energyKind({ columns, invariants, form }) {
  if (!columns.includes("energy")) return "none";
  return form?.keeps_energy || invariants.some((invariant) => invariant.name === "energy") ? "error" : "value";
}

/** The columns to ask for, with `more` and `own` ones: for schemes that choose their own steps also how each sample was reached. */
export const columns = (problem, scheme, more = [], own = []) => [...new Set([
  "t", ...(crowded(problem) ? [] : motion(problem).map((variable) => variable.name)), ...(energyKind(problem) === "none" ? [] : ["energy"]),
  ...(scheme?.own_clock && problem.columns.includes("mode") ? ["mode"] : []), ...more.filter((name) => problem.columns.includes(name))]), ...own];

/** The diagnostics of a problem that the page shows (others cost more than the run itself); a run `backward` has few of them. */
export const diagnostics = (problem, backward = false) =>
  ["energy", "momenta", ...(backward ? [] : ["orbit", "decay", "entropy", "zeros", "cycle"])].filter((kind) => problem.diagnostics.includes(kind));

/** The colour of the i-th run. */
export const colourOf = (i) => `--run-${"abcdef"[i]}`;

/** The colour of the i-th of `n` bodies of one run: those of runs, as far as there are as many. */
export const colourOfBody = (i, n) => (n <= 6 ? colourOf(i) : `hsl(${Math.round((300 * i) / (n - 1))} 65% 50%)`);
