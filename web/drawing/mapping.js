// From the values of a curve to pixels. A logarithmic axis holds the logarithms, so that all maps are linear.

const there = (v) => v !== null;

/** A mode of integration as a number: 0 in time, 1 in a coordinate; null if there is none. */
export const inCoordinate = (mode) => (typeof mode === "string" ? Number(mode === "jacobi_maupertuis") : mode ?? null);

/**
 * The curve `{t, x, y, stretched}` of a trajectory over two of its columns, null in both where either has no value; null:
 * nothing to draw. `log` names the axes that are logarithmic, as in "xy". `stretched(i)`: whether the curve comes to its
 * point i by the Jacobi–Maupertuis principle.
 */
export function curveOf(trajectory, x, y, log = "") {
  const scaled = (name, axis) =>
    (log.includes(axis) ? trajectory[name].map((v) => (v > 0 ? Math.log10(v) : null)) : trajectory[name]);
  const own = { x: scaled(x, "x"), y: scaled(y, "y") };
  const beside = (column, other) => column.map((v, i) => (other[i] === null ? null : v));
  const stretched = (i) => inCoordinate(trajectory.mode?.[i]) === 1;
  const curve = { t: trajectory.t, x: beside(own.x, own.y), y: beside(own.y, own.x), stretched };
  const turned = [[x, curve.x], [y, curve.y]].filter(([name]) => name.endsWith("_wrapped")).map(([, values]) => values);
  if (turned.length) curve.joined = (i) => turned.every((values) => Math.abs(values[i] - values[i - 1]) < Math.PI); // not over the edge
  return curve.x.some(there) ? curve : null;
}

/** The least and the largest of a column. */
export function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const v of values) {
    if (v === null) continue;
    if (v < low) low = v;
    if (v > high) high = v;
  }
  return [low, high];
}

/**
 * One view `{x: [low, high], y: [low, high], free}` for all curves: the box around them, but an escaping run does not
 * shrink the others beyond half. All is seen on the axes that are `whole`. Scales are equal, unless they are `free`: a time
 * has no length to compare with, and of a curve ten times as long as it is wide nothing would be seen.
 */
export function commonView(curves, whole = [], free = whole.length > 0) {
  if (!curves.length) return null;
  const boxes = curves.map(({ x, y }) => ({ x: extent(x), y: extent(y) }));
  const lengths = ["x", "y"].filter((axis) => !whole.includes(axis));
  const size = (b) => Math.max(0, ...lengths.map((k) => b[k][1] - b[k][0]));
  const smallest = boxes.reduce((a, b) => (size(b) < size(a) ? b : a));
  const axis = (k) => {
    const room = whole.includes(k) ? Infinity : size(smallest) / 2 || Infinity;
    return [Math.max(Math.min(...boxes.map((b) => b[k][0])), smallest[k][0] - room),
            Math.min(Math.max(...boxes.map((b) => b[k][1])), smallest[k][1] + room)];
  };
  const view = { x: axis("x"), y: axis("y") }, [wide, high] = [view.x[1] - view.x[0], view.y[1] - view.y[0]];
  return { ...view, free: free || (wide > 0 && high > 0 && Math.max(wide / high, high / wide) > 10) };
}

/**
 * The map from values to pixels in a frame `{left, top, width, height}`, with a little air around the view. `zoom`
 * (`{by, x, y}`, or null) enlarges about a point of its own.
 */
export function mapping(view, frame, zoom = null) {
  const middle = (v) => v[0] / 2 + v[1] / 2;
  const fitting = (length, [low, high]) => length / (high - low) / 1.08;
  const usable = (scale) => (Number.isFinite(scale) ? scale : frame.height / 2);
  const fit = { x: fitting(frame.width, view.x), y: fitting(frame.height, view.y) };
  const equal = usable(Math.min(fit.x, fit.y)), by = zoom?.by ?? 1;
  const scale = view.free ? { x: usable(fit.x) * by, y: usable(fit.y) * by } : { x: equal * by, y: equal * by };
  const centre = zoom ?? { x: middle(view.x), y: middle(view.y) };
  const reach = { x: frame.width / 2 / scale.x, y: frame.height / 2 / scale.y };
  return {
    scale, centre, free: view.free,
    x: (v) => frame.left + frame.width / 2 + (v - centre.x) * scale.x,
    y: (v) => frame.top + frame.height / 2 - (v - centre.y) * scale.y,
    at: (left, top) => ({ x: centre.x + (left - frame.left - frame.width / 2) / scale.x,
                          y: centre.y - (top - frame.top - frame.height / 2) / scale.y }),
    low: { x: centre.x - reach.x, y: centre.y - reach.y },
    high: { x: centre.x + reach.x, y: centre.y + reach.y },
  };
}

/** The index of the last sample of a run up to time `t`; times grow, or fall for a run backward. */
export function indexAt(times, t) {
  const way = times.at(-1) < times[0] ? -1 : 1;
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (way * times[middle] <= way * t) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** A column at time t, linearly interpolated between samples. */
export function valueAt(times, column, t) {
  const i = indexAt(times, t), a = column[i], b = column[i + 1] ?? a, span = times[i + 1] - times[i];
  if (a === null || b === null || !span) return a;
  return a + (b - a) * Math.min(1, Math.max(0, (t - times[i]) / span));
}
