// Which states of a run a picture is made of.
import { energyKind } from "./card.js";
import { bodiesOf, kindsOf } from "./kinds.js";

const along = 4000; // states along a curve, more than a screen can tell apart

/**
 * The record of a run over a `span`, of `most` states. Every N-th step: what is drawn are states the scheme was in; N cannot
 * be said of a scheme that sets its own clock. Where that would leave steps out and the motion comes back for ever, or has no
 * energy to be seen over time, the states lie evenly along its curve: at equal times they would be rare where it is fast, and cut
 * its corners.
 */
export function recordOf({ problem, axes, log }, card, { step }, span, most) {
  const every = card?.own_clock ? NaN : Math.max(1, Math.ceil(span / step / most));
  const moving = problem.variables.map(({ name }) => name), drawn = bodiesOf(axes, kindsOf(problem)).flat();
  const plane = !log && drawn.every((name) => moving.includes(name));
  const kind = energyKind(problem), returns = kind === "none" || (kind === "error" && card?.structure !== "none");
  if (plane && returns && card?.id !== "auto" && every !== 1 && most >= 2) return { curve: Math.min(most, along) };
  return most >= 2 && Number.isSafeInteger(every) ? { every } : { samples: most };
}
