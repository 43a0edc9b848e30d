// Which states of a run a picture is made of.
import { energyKind } from "./card.js";
import { bodiesOf, kindsOf } from "./kinds.js";

const along = 4000; // states along a curve, more than a screen can tell apart

/**
 * The record of a run over a `span`, of at most `most` states: every N-th step, so that the drawn states are the scheme's own.
 * N is unknown for a scheme that chooses its own steps. Where steps would be left out, and either the motion conserves its
 * energy and the scheme keeps a structure, or there is no energy to plot, states lie evenly along the curve: at equal times
 * they would be rare where the motion is fast, and cut its corners.
 */
export function recordOf({ problem, axes, log }, card, { step }, span, most) {
  const every = card?.own_clock ? NaN : Math.max(1, Math.ceil(span / step / most));
  const moving = problem.variables.map(({ name }) => name), drawn = bodiesOf(axes, kindsOf(problem)).flat();
  const plane = !log && drawn.every((name) => moving.includes(name));
  const kind = energyKind(problem), returns = kind === "none" || (kind === "error" && card?.structure !== "none");
  if (plane && returns && card?.id !== "auto" && every !== 1 && most >= 2) return { curve: Math.min(most, along) };
  return most >= 2 && Number.isSafeInteger(every) ? { every } : { samples: most };
}
