// Names of variables that differ only by an index, x1, x2 or x[1], x[2], are of one kind, and a scene has
// one of them for each of its bodies or for each link of a chain.
import { motion } from "./card.js";
import { statedViews } from "./stated.js";

/** The axis of a chain: the position of its members in the chain. */
export const index = "index";

/** The variables of a scene by kind, `x*` → [x1, x2], as far as there are several of a kind. */
export function kindsOf(problem) {
  const kinds = new Map();
  for (const { name } of motion(problem)) {
    const [, letter] = /^([A-Za-z]+)(?:_?\d+|\[\d+\])$/.exec(name) ?? [];
    if (letter) kinds.set(`${letter}*`, [...(kinds.get(`${letter}*`) ?? []), name]);
  }
  return new Map([...kinds].filter(([, names]) => names.length > 1));
}

/**
 * The axes of the picture that a scene as text begins with: the first that it states; else its bodies in the plane or in space,
 * or its chain over the index; null where the names say neither.
 */
export function arrangementOf(problem) {
  if (!problem.form) return null; // the scenes of the catalogue have pictures of their own
  if (problem.views?.length) return statedViews(problem)[0];
  const kinds = kindsOf(problem), size = (axis) => kinds.get(axis)?.length ?? 0;
  if (["x", "y", "z"].every((name) => motion(problem).some((variable) => variable.name === name))) return ["x", "y", "z"];
  if (size("x*") && size("x*") === size("y*")) return size("x*") === size("z*") ? ["x*", "y*", "z*"] : ["x*", "y*"];
  const [first] = kinds.keys(), links = size(first), all = motion(problem).filter(({ name }) => name !== "s");
  return links > 2 && all.length === 2 * links && [...kinds.values()].every((names) => names.length === links) ? [index, first] : null;
}

/** The variables that a place in a picture over these axes sets as a start; null where it is no picture of two of them. */
export function startsOf([x, y, ...more], log, problem) {
  const names = [x, y].map((axis) => axis.replace(/_wrapped$/, "")), moving = motion(problem).map(({ name }) => name);
  return !more.length && !log && names[0] !== names[1] && names.every((name) => moving.includes(name)) ? names : null;
}

/** Whether the axes are lengths to be compared: those of a view that is stated, or coordinates. */
export function isEqual(axes, problem) {
  if (axes.includes("t")) return false;
  const moving = motion(problem).map(({ name }) => name);
  return statedViews(problem).some((view) => String(view) === String(axes)) ||
    bodiesOf(axes, kindsOf(problem)).every((names) => names.every((name) => moving.includes(name)));
}

/** The columns that an axis stands for: those of its kind, or one. */
export const columnsOf = (axis, kinds) => kinds.get(axis) ?? (axis === index ? [] : [axis]);

/** The columns that some axes need. */
export const drawnOf = (axes, kinds) => axes.flatMap((axis) => columnsOf(axis, kinds));

/** The columns that are drawn against each other on some axes, for each body or once. */
export function bodiesOf(axes, kinds) {
  const columns = axes.map((axis) => columnsOf(axis, kinds)), several = columns.filter((names) => names.length > 1);
  const bodies = several.length ? Math.min(...several.map((names) => names.length)) : 1;
  return Array.from({ length: bodies }, (_, i) => columns.map((names) => (names.length > 1 ? names[i] : names[0])));
}
