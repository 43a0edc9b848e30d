// The numbers of a request that a study varies, the starts and the parameters of a scene, by their names and JSON pointers; the
// columns that it shows.
import { axes, motion } from "../catalogue/card.js";

const listed = /^(.+)\[(\d+)\]$/; // an entry of a list of parameters, counted from 1

/** The names of the parameters of a scene that are numbers, without choices and those that are off. */
export const numbersOf = ({ parameters }) =>
  parameters.filter(({ type = "number", default: usual }) => type === "number" && Number.isFinite(usual)).map(({ name }) => name);

/** The variables that a run may start from. */
export const startsOf = (problem) => motion(problem).map(({ name }) => name);

/** The columns that many runs may have in a picture; others need all samples of a run. */
export const columnsOf = (problem) => axes(problem).map(({ id }) => id).filter((id) => id !== "error_of_energy" && id !== "mode");

/** The JSON pointer to a start or a parameter in a request. */
export function pointerTo(problem, name) {
  if (startsOf(problem).includes(name)) return `/initial/${name}`;
  const [, list, i] = listed.exec(name) ?? [];
  return list ? `/problem/${list}/${i - 1}` : `/problem/${name}`;
}

/** The value of a start or a parameter in the echo of a request. */
export const valueOf = (problem, { problem: parameters, initial }, name) => (startsOf(problem).includes(name) ? initial : parameters)[name];

/** A request with another value of a start or a parameter. */
export function withValue(problem, request, name, value) {
  const section = startsOf(problem).includes(name) ? "initial" : "problem";
  return { ...request, [section]: { ...request[section], [name]: value } };
}
