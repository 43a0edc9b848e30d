// Equal work: steps with which all runs evaluate the force as often as the first.

/** The setting to which the work of a scheme is inversely proportional, or none. */
export const workSetting = (scheme) => ["step", "sigma"].find((name) => Number.isFinite(scheme[name]) && !("theta" in scheme));

/** A number rounded to so many significant `digits`. */
export const rounded = (value, digits = 3) => Number(value.toPrecision(digits));

/**
 * `[{scheme, outcome}]` → the settings of equal work, null where a run has no such setting or failed. The first stays.
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
