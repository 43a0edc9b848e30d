// Equal work: steps with which all runs evaluate the force as often as the first.

/** The setting of a scheme that its work is inversely proportional to, or none. */
export const workSetting = (scheme) => ["step", "sigma"].find((name) => Number.isFinite(scheme[name]) && !("theta" in scheme));

/** A number with no more digits than say something. */
export const rounded = (value, digits = 3) => Number(value.toPrecision(digits));

/**
 * `[{scheme, outcome}]` → the settings, null where a run has none that its work goes with, or failed. The first stays.
 */
export function equalWork(runs) {
  const forces = (run) => run.outcome?.status === "completed" && run.outcome.cost.force_evaluations;
  const goal = forces(runs[0]);
  return runs.map((run, i) => {
    const setting = workSetting(run.scheme);
    if (!goal || !forces(run) || !setting) return null;
    return i === 0 ? run.scheme[setting] : rounded((run.scheme[setting] * forces(run)) / goal, 4);
  });
}
