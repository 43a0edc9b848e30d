// The problems of the catalogue that are texts, as examples to begin a scene of one's own with.
import { motion, usualScheme } from "./card.js";

const beside = ["bouncing_ball"]; // moves by events, which are no part of its text

/** `[{name, title, note, reference, problem, initial, scheme, until}]`, the step as the problem suggests it. */
export const examplesOf = (problems) => problems.filter(({ id, text }) => text && !beside.includes(id)).map((card) => ({
  name: card.id, title: card.title, note: card.summary, reference: card.references.join("; "), until: card.until,
  scheme: { id: usualScheme(card) ?? ["variational_midpoint", "runge_kutta_4"].find((id) => card.schemes.includes(id)), step: card.suggested.step },
  problem: { ...card.text, title: card.title }, initial: Object.fromEntries(motion(card).map(({ name, default: begin }) => [name, begin])) }));
