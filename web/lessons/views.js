// The pictures of a view of some runs: columns that the page itself derives, known curves beside them, histograms.
import { known, named } from "../language/texts.js";
import { colourOf } from "../catalogue/card.js";
import { sun } from "../drawing/bodies.js";
import { circlePicture } from "../drawing/circle.js";
import { errorOfEnergy } from "../drawing/energy.js";
import { levelPicture } from "../drawing/field.js";
import { commonView, curveOf, extent } from "../drawing/mapping.js";
import { inSpace } from "../drawing/space.js";

const names = { error_of_energy: "|H − H₀| / |H₀|", mechanical_energy: "p²/2 + V", energy: "H", entropy: "S", potential: "U" };

/** The columns that a view needs from the service. */
export const columnsOf = (view) => [...["x", "y", "z"].map((axis) => view[axis]), ...(view.between ?? []), ...(view.several ?? []).map(([name]) => name),
                                    ...(Array.isArray(view.body) ? view.body.flatMap(({ at }) => at).filter((entry) => !Number.isFinite(Number(entry))) : [])]
  .filter((name) => name && !["t", "distance", "periods"].includes(name)).map((name) => (name === "error_of_energy" ? "energy" : name));

/** The unit of time of a run: 1, or with the `pace` "cycle" its measured period. */
export const paceOf = ({ diagnostics, trajectory }, pace) =>
  (pace === "cycle" ? diagnostics.cycle?.period ?? trajectory.t.at(-1) / 2 : 1);

/** A trajectory with the columns that the page derives: the `distance` is to the last run, in the columns `between`. */
function whole(trajectory, { y, between }, last, unit) {
  if (unit !== 1) return { ...trajectory, periods: trajectory.t.map((t) => t / unit) };
  if (y === "distance") {
    const apart = (i) => Math.hypot(...between.map((name) => trajectory[name][i] - last[name][i]));
    return { ...trajectory, distance: trajectory.t.map((_, i) => apart(i) || null) };
  }
  return y === "error_of_energy" ? { ...trajectory, error_of_energy: errorOfEnergy(trajectory) } : trajectory;
}

/** The histogram of a column's values as a density, drawn as stairs. */
function histogram(values, [low, high, n]) {
  const width = (high - low) / n, bins = Array(n).fill(0), found = values.filter((v) => v !== null);
  for (const v of found) {
    const bin = Math.floor((v - low) / width);
    if (bin >= 0 && bin < n) bins[bin]++;
  }
  const x = [low], y = [0];
  bins.forEach((count, i) => {
    const density = count / found.length / width;
    x.push(low + i * width, low + (i + 1) * width);
    y.push(density, density);
  });
  return { x: [...x, high], y: [...y, 0], series: false, unmarked: true };
}

/** A known curve: a function over an axis, or points over a range of its parameter, in 600 parts. */
function exactly([title, of, range], runs, span, log) {
  const value = (v) => of(v, runs[0].parameters, runs);
  const [low, high] = range ?? span, n = 600, x = Array.from({ length: n + 1 }, (_, i) => low + ((high - low) * i) / n);
  const drawn = { title: named("term", title), colour: "--ink", dash: [7, 6], exact: true };
  if (range) {
    const points = x.map(value);
    return { x: points.map(([a]) => a), y: points.map(([, b]) => b), ...drawn };
  }
  const y = x.map(value).map((v) => (v !== null && log.includes("y") ? Math.log10(v) : v));
  return { x: x.map((v, i) => (y[i] === null ? null : v)), y, ...drawn };
}

/** The pairs of columns that a view draws against each other, `[[x, y, title, colour]]`: for `x[*]` a pair for each index. */
function pairsOf({ x, y, several }, trajectory) {
  if (several) return several.map(([name, title], i) => [x, name, named("term", title), colourOf(i)]);
  if (!x.endsWith("[*]")) return [[x, y]];
  const elements = (kind) => Object.keys(trajectory).filter((name) => name.startsWith(kind.slice(0, -2)));
  return elements(x).map((name, i) => [name, elements(y)[i]]);
}

const labelsOf = ({ labels }) => labels?.map((name) => named("term", name));

/** A point for each run with a piece of the tangent there: `points: {x, y, slope}` are functions of an outcome. */
function pointsOf({ points: { x, y, slope }, exact = [], box = {}, ...view }, runs) {
  const truths = exact.map((one) => exactly(one, runs, [0, 1], "")), width = Math.max(...truths.map(({ x: along }) => extent(along)[1])) / 14;
  const curves = runs.flatMap(({ outcome, colour, title }) => {
    const [u, v, by] = [x, y, slope].map((of) => of(outcome));
    const tangent = { x: [u - width, u + width], y: [v - width * by, v + width * by], unmarked: true };
    return [{ ...tangent, colour, title }, { x: [u], y: [v], endless: true, colour, title }];
  });
  return { curves: [...truths, ...curves], view: { ...commonView([...truths, ...curves], ["x", "y"], true), ...box }, labels: labelsOf(view) };
}

/** Fixed places, `[name, x, y]` with x and y as functions of the parameters, drawn as discs with their names. */
const standing = (places, parameters) => (pen, map, colour) => {
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const [name, x, y] of places) {
    const [left, top] = [map.x(x(parameters)), map.y(y(parameters))];
    pen.fillStyle = colour("--sun");
    pen.beginPath();
    pen.arc(left, top, 5, 0, 2 * Math.PI);
    pen.fill();
    pen.fillStyle = colour("--soft-ink");
    pen.fillText(named("term", name), left, top + 7);
  }
};

/** The picture that a `view` of a lesson gives of `runs`: `[{title, colour, trajectory, parameters}]` that have one. */
export function pictureOf(view, runs, { angles, symbol = (name) => name, pace } = {}) {
  if (!runs.length) return null;
  if (view.points) return pointsOf(view, runs);
  if (view.multipliers) return circlePicture(view.multipliers(runs[0].outcome), runs[0].colour, labelsOf(view));
  if (view.z) return inSpace([view.x, view.y, view.z], runs, angles, view);
  const { log = "", box = {}, exact = [] } = view, series = ["t", "periods"].includes(view.x);
  const curves = runs.filter((_, i) => (view.runs ?? [view.run ?? i]).includes(i)).flatMap(({ trajectory, ...run }) => {
    const unit = paceOf({ trajectory, ...run.outcome }, pace), all = view.bins ? null : whole(trajectory, view, runs.at(-1).trajectory, unit);
    return (view.bins ? [[]] : pairsOf(view, trajectory)).flatMap(([x, y, title = run.title, colour = run.colour]) => {
      const curve = view.bins ? histogram(trajectory[view.x], view.bins) : curveOf(all, x, y, log);
      if (curve && all?.periods) curve.t = all.periods;
      return curve ? [{ series, thin: view.thin, ...curve, ...run, title, colour }] : [];
    });
  });
  if (!curves.length) return null;
  const timed = series || Boolean(view.bins);
  const span = view.bins ? view.bins.slice(0, 2) : [Math.min(...curves.map(({ x }) => extent(x)[0])),
                                                    Math.max(...curves.map(({ x }) => extent(x)[1]))];
  const free = timed || log !== "";
  const seen = { ...commonView(curves, ["x", "y"], free), ...box };
  const truths = exact.map((one) => exactly(one, runs, span, log));
  if (truths.length && timed && !box.y && !log) seen.y = [Math.min(seen.y[0], 0), seen.y[1]];
  const behind = view.level ? levelPicture((x, y) => view.level(x, y, runs[0].parameters))
    : view.places ? standing(view.places, runs[0].parameters) : view.sun && sun;
  const labels = labelsOf(view) ?? [view.x, view.y].map((name) => names[name] ?? known(`column.${name}`) ?? symbol(name));
  return { curves: timed ? [...truths, ...curves] : [...curves, ...truths], view: seen, labels, log, backdrop: behind };
}
