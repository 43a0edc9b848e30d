// Events and columns of one's own as they are typed and stand in a link, and as they stand in a request:
// `floor = x down {vx = -0.9*vx} stop most 100`, of which all after the formula may be missing.
import { entries } from "./text.js";

const end = /^(.*?)((?:\s+(?:up|down|both|stop|most\s+\d+)|\s*\{[^{}]*\})*)\s*$/s;

/** Columns: `[{name, expression}]`. */
export const columnsOf = (text) => entries(text).map(({ name, value }) => ({ name, expression: value ?? "" }));

/** Events: `[{name, expression, direction?, stop?, most?, set?}]`. */
export function eventsOf(text) {
  return columnsOf(text).map(({ name, expression: typed }) => {
    const [, expression, rest] = end.exec(typed), [, acts] = /\{([^{}]*)\}/.exec(rest) ?? [], said = rest.replace(/\{[^{}]*\}/, " ");
    const [direction] = /\b(up|down|both)\b/.exec(said) ?? [], [, most] = /\bmost\s+(\d+)/.exec(said) ?? [];
    const set = acts === undefined ? null : Object.fromEntries(entries(acts).map((one) => [one.name, one.value ?? ""]));
    return { name, expression, ...(direction ? { direction } : {}), ...(/\bstop\b/.test(said) ? { stop: true } : {}),
             ...(most ? { most: Number(most) } : {}), ...(set ? { set } : {}) };
  });
}

/** The text of columns or events of a request. */
export const happeningsText = (list) => list.map(({ name, expression, direction, stop, most, set }) => [
  `${name} = ${expression}`, ...(direction && direction !== "both" ? [direction] : []),
  ...(set ? [`{${Object.entries(set).map(([variable, value]) => `${variable} = ${value}`).join(", ")}}`] : []),
  ...(stop ? ["stop"] : []), ...(most ? [`most ${most}`] : [])].join(" ")).join(", ");
