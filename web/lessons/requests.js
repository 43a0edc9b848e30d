// What a lesson asks of the service.
import { named } from "../language/texts.js";
import { workSetting } from "../service/work.js";
import { presetOf } from "../catalogue/card.js";
import { columnsOf } from "./views.js";

const fine = 4000; // samples of a picture
export const coarse = 700; // while a hand moves the control

/** A problem of a request, its title in the language that is spoken. */
const entitled = (problem) => (problem.title ? { ...problem, title: named("scene", problem.title) } : problem);

/** The request for run `i` at the present state of the control, with the columns and diagnostics that the lesson shows. */
export function requestOf(lesson, i, { set, steps }, samples = lesson.points ?? fine) {
  const run = lesson.runs[i], { control } = lesson;
  const { problem, initial, until, scheme } = { ...lesson.scene, ...run };
  const request = { problem: entitled({ ...lesson.scene.problem, ...problem }), initial: { ...lesson.scene.initial, ...initial },
                    scheme: { ...scheme }, until: { ...until } };
  if (samples === coarse && lesson.brief) request.until.t /= lesson.brief;
  if (steps) request.scheme[workSetting(scheme)] = steps[i];
  if (control.starts) request.initial = { ...request.initial, ...control.starts(set ?? control.usual, i) };
  else if (set !== undefined && control.sets !== "steps" && (control.run ?? i) === i) {
    const [section, name] = control.sets.split(".");
    request[section][name] = set;
  }
  const own = lesson.scene.columns ?? []; // formulas by name
  const columns = new Set(["t", ...lesson.views.flatMap(columnsOf), ...(scheme.id === "jacobi_maupertuis" ? ["mode"] : [])]);
  const kinds = (lesson.tells ?? []).map(([, path]) => typeof path === "string" && /^diagnostics\.(\w+)/.exec(path)?.[1]).filter(Boolean);
  if (lesson.views.some(({ body }) => typeof body === "string")) ["q", "p"].forEach((name) => columns.add(name));
  const { events } = lesson.scene, sensitivities = run.sensitivities ?? lesson.scene.sensitivities;
  return { ...request, record: lesson.curve ? { curve: samples } : { samples }, diagnostics: [...new Set(kinds)],
           columns: [...columns].map((name) => own.find((one) => one.name === name) ?? name), ...(events ? { events } : {}),
           ...(sensitivities ? { sensitivities } : {}) };
}

/**
 * `ask(request, signal)` for a lesson whose control changes some of its runs: the answers of others are reused if they have as many
 * samples. The dozen used last are kept.
 */
export function remembering(ask) {
  const kept = new Map(); // by request without its record: {size, answer}
  return async ({ record, ...request }, signal) => {
    const key = JSON.stringify(request), size = record.samples ?? record.curve, before = kept.get(key);
    if (before) kept.delete(key), kept.set(key, before);
    if (before?.size >= size) return before.answer;
    const answer = await ask({ ...request, record }, signal);
    if (answer.outcome) kept.delete(key), kept.set(key, { size, answer });
    if (kept.size > 12) kept.delete(kept.keys().next().value);
    return answer;
  };
}

/**
 * The answers to all runs by `ask(request, signal)`; a run `back` from the end of another waits for the latter. For a lesson
 * that `grows`, `came(answers)` is called with the first answers while others are still to come.
 */
export function answersTo(lesson, requests, ask, signal, came) {
  const answers = [];
  for (const [i, request] of requests.entries()) {
    const { back } = lesson.runs[i];
    answers.push(back === undefined ? ask(request, signal) : answers[back].then((there) => (
      there.outcome ? ask({ ...request, initial: there.outcome.final, until: { t: there.outcome.initial.t } }, signal) : there)));
  }
  const grow = async () => {
    for (let i = 1; i < answers.length; i++) came(await Promise.all(answers.slice(0, i)));
  };
  if (lesson.grows) grow().catch(() => {}); // the promise of all answers rejects as well
  return Promise.all(answers);
}

/** The request of a lesson with a `study` of schemes or a `portrait` of many runs, at the present state of the control. */
export function measureOf({ study, portrait, control }, { set }) {
  const asked = structuredClone(study ?? portrait);
  asked.problem = entitled(asked.problem);
  if (set === undefined) return asked;
  const [section, name] = control.sets.split(".");
  asked[section][name] = set;
  return asked;
}

/** The value at a path in an answer, `last` being the end of a column; or the value of a function of the answer. */
export const told = (outcome, path) => (typeof path === "function" ? path(outcome) : at(outcome, path));
const at = (outcome, path) =>
  path.split(".").reduce((at, key) => (key === "last" ? at?.at(-1) : at?.[key]), outcome);

/** The value that the control of a lesson has in a state. */
export function controlled(lesson, { set, steps }, card) {
  const { control, runs } = lesson;
  if (control.sets === "steps") return steps?.[0] ?? runs[0].scheme[workSetting(runs[0].scheme)];
  if (set !== undefined || control.starts) return set ?? control.usual;
  const [section, name] = control.sets.split("."), request = runs ? requestOf(lesson, control.run ?? 0, {}) : measureOf(lesson, {});
  return request[section][name] ?? presetOf(card, request.problem.preset)?.parameters[name] ??
         card.parameters.find((parameter) => parameter.name === name).default;
}
