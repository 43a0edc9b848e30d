// The state of the page as the part of the address behind `#`, and back: `lesson=orbit`, or an experiment,
// `problem=kepler&initial.x=0&A=leapfrog&A.step=0.01…`, which has the sections of a request and its schemes under the names
// of the runs: {problem: {id, …}, preset: {id}, initial: {…}, until: {t}, record: {samples}, axes: {x, y, z}, A: {id, …}, …}.
// What has its default is left out. The text of a scene of one's own stands in the section of its problem.
import { happeningsText } from "./happenings.js";
import { linked } from "./text.js";

export const names = ["A", "B", "C", "D", "E", "F"];
const sections = ["problem", "preset", "initial", "until", "record", "columns", "events", "axes", "view", "study", "section", "basins", "tangent", "sweep", "closed", "starts", ...names];

export function toHash(experiment) {
  const pairs = new URLSearchParams();
  for (const [section, values] of Object.entries(experiment)) {
    for (const [name, value] of Object.entries(values)) {
      pairs.append(name === "id" ? section : `${section}.${name}`, value === null ? "" : String(value));
    }
  }
  return `#${pairs}`.replace(/%(2C|28|29|2F|3D)/g, decodeURIComponent);
}

/** The experiment of a link, with all values as texts, which the fields convert; `unread`: keys without a meaning. */
export function fromHash(hash) {
  const experiment = {}, unread = [];
  for (const [key, value] of new URLSearchParams(hash.replace(/^#/, ""))) {
    const [section, name = "id"] = key.split(".");
    if (sections.includes(section)) (experiment[section] ??= {})[name] = value;
    else if (key !== "lang") unread.push(key); // "lang" is the language of the page
  }
  return { experiment, unread };
}

/** Whether a link asks for presentation mode, `…&present`; and a link that does, or does not. */
export const presents = (hash) => new URLSearchParams(hash.replace(/^#/, "")).has("present");
export const presenting = (hash, on) => hash.replace(/&present(=[^&]*)?(?=&|$)/g, "") + (on ? "&present" : "");

/** `lesson=orbit&set=0.1` as `{id, state}`, or null where the link is to no lesson. */
export function lessonOf(hash) {
  const pairs = new URLSearchParams(hash.replace(/^#/, "")), id = pairs.get("lesson");
  if (id === null) return null;
  const numbers = (name) => pairs.get(name)?.split(",").map(Number);
  const set = numbers("set")?.[0], steps = numbers("steps");
  return { id, state: { ...(Number.isFinite(set) ? { set } : {}), ...(steps?.every((v) => v > 0) ? { steps } : {}) } };
}

export const lessonHash = (id, { set, steps } = {}) =>
  `#lesson=${id}${set === undefined ? "" : `&set=${set}`}${steps ? `&steps=${steps.join(",")}` : ""}`;

/** The starts of a portrait: those of all requests but the first, if they differ only by two variables of the start. */
function startsOf(requests) {
  const rest = ({ problem, until, scheme }) => JSON.stringify([problem, until, scheme]), [first, ...others] = requests;
  const names = Object.keys(first.initial ?? {}), like = (request) => rest(request) === rest(first) && String(Object.keys(request.initial)) === String(names);
  if (names.length !== 2 || !others.length || !others.every(like)) return {};
  return { starts: { of: String(names), at: String(others.map(({ initial }) => names.map((name) => initial[name]))) } };
}

/**
 * The link to the workbench with the scene of the first request (with its basins, events and columns) and the runs of those
 * requests that have the same scene, over `axes`; `back`: each run goes back from its end.
 */
export function benchLink(requests, axes = {}, back = false) {
  const scene = ({ problem, initial, until }) => ({ problem, initial, until }), first = JSON.stringify(scene(requests[0]));
  const { problem: { preset, ...asked }, ...rest } = scene(requests[0]), problem = linked(asked);
  const schemes = requests.filter((request) => JSON.stringify(scene(request)) === first).map(({ scheme }) => scheme);
  const { basins, events = [], columns = [] } = requests[0], own = columns.filter(({ name }) => name);
  const more = (section, list) => (list.length ? { [section]: { more: happeningsText(list) } } : {});
  return toHash({ problem, ...(preset ? { preset: { id: preset } } : {}), ...rest, ...(back ? { until: { ...rest.until, back } } : {}),
                  ...more("columns", own), ...more("events", events), ...(basins ? { basins } : {}), axes,
                  ...startsOf(requests),
                  ...Object.fromEntries(schemes.map((scheme, i) => [names[i], typeof scheme === "string" ? { id: scheme } : scheme])) });
}
