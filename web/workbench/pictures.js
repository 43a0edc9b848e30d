// The pictures of runs over the chosen axes: functions that draw some of the runs, all in the same view.
import { colourOfBody } from "../catalogue/card.js";
import { bodiesOf, columnsOf, index, isEqual, kindsOf, startsOf } from "../catalogue/kinds.js";
import { bodyOf, sun } from "../drawing/bodies.js";
import { errorOfEnergy } from "../drawing/energy.js";
import { commonView, curveOf, extent, valueAt } from "../drawing/mapping.js";
import { boxOf, inSpace } from "../drawing/space.js";

const column = (trajectory, name) => (name === "error_of_energy" ? trajectory.energy && errorOfEnergy(trajectory) : trajectory[name]);
const times = ({ outcome }) => (outcome?.events ?? []).map(({ t }) => t);

const above = { title: "", events: [], exact: true };

/** The extents of all curves together, in the form of one curve. */
const boxOfAll = (curves) => ({ x: curves.flatMap(({ x }) => extent(x)), y: curves.flatMap(({ y }) => extent(y)) });

/** The curve of a trajectory over two columns in a list, which is empty if a column is missing. */
function curvesOf(trajectory, [across, up], log, more) {
  const [x, y] = trajectory ? [across, up].map((name) => column(trajectory, name)) : [];
  const curve = x && y && curveOf({ ...trajectory, [across]: x, [up]: y }, across, up, log);
  return curve ? [{ ...curve, series: across === "t", ...more }] : [];
}

/** A run as a chain over its index, which has a shape at every time. */
function chainsOf({ trajectory, colour, title }, names) {
  if (!trajectory?.t.length || !names.every((name) => trajectory[name])) return [];
  const x = names.map((_, i) => i + 1), columns = names.map((name) => trajectory[name]);
  const shape = (t) => ({ x, y: columns.map((values) => valueAt(trajectory.t, values, t)) });
  return [{ t: trajectory.t, x: [1, names.length], y: columns.flatMap(extent), shape, colour, title, events: [] }];
}

/**
 * Pictures in the plane. The start of a run is dragged by `hands.grab({name: value…}, done)`, one of a portrait by `hands.move(i,
 * [x, y], done)`; `hands.pick([x, y])` hears of a click, `hands.unpick()` that it became a double one; `hands.backdrop` lies behind; `hands.over`,
 * `[{trajectory, colour, dash}]`, above all.
 */
export function inPlane({ axes, log, labels, problem }, runs, hands) {
  const kinds = kindsOf(problem), bodies = bodiesOf(axes, kinds), starts = bodies.length > 1 ? null : startsOf(axes, log, problem);
  const chain = axes[0] === index && columnsOf(axes[1], kinds), several = bodies.length > 1;
  const taken = (pair) => startsOf(pair, log, problem);
  const hued = (run, i) => ({ colour: run.colour, body: several ? colourOfBody(i, bodies.length) : run.colour, title: run.title });
  const back = (run) => (run.outcome?.back ? bodies.flatMap((pair, i) => curvesOf(run.outcome.back.trajectory, pair, log, {
    ...hued(run, i), body: "--ink", colour: "--ink", dash: [3, 5], events: [], exact: true })) : []); // above the way forth
  const own = (run) => (chain ? chainsOf(run, chain) : [...bodies.flatMap((pair, i) => curvesOf(run.trajectory, pair, log, {
    ...hued(run, i), events: times(run), grab: taken(pair) && ((x, y, done) => hands.grab({ [taken(pair)[0]]: x, [taken(pair)[1]]: y }, done)) })),
    ...back(run)]);
  const others = (run) => (starts ? run.starts : []).flatMap(({ at, trajectory }, i) => {
    const begins = { x: [at[0]], y: [at[1]], t: [0] }; // what is still to come, or was refused
    return (trajectory ? curvesOf(trajectory, axes, log, {}) : [begins]).map((curve) => ({ ...curve, colour: run.colour, title: run.title,
      events: [], thin: true, endless: true, grab: (x, y, done) => hands.move(i, [x, y], done) }));
  });
  const curves = new Map(runs.map((run) => [run, own(run)])), portraits = new Map(runs.map((run) => [run, others(run)]));
  const plain = Boolean(starts) || (!log && isEqual(axes, problem));
  const whole = ["x", "y"].filter((axis, i) => axes[i] === "t" || log.includes(axis));
  const centred = bodyOf(problem) === "planet" && !log && axes.every((name) => ["x", "y"].includes(name)) && axes[0] !== axes[1];
  const view = commonView(boxesOf(runs, curves, portraits), whole, !plain);
  const over = chain ? [] : hands.over.flatMap(({ trajectory, ...look }) => bodies.flatMap((pair) => curvesOf(trajectory, pair, log, { ...look, ...above })));
  return (some, plane) => { // of one run each body has its colour, of several each run
    const drawn = some.flatMap((run) => curves.get(run)).map((curve) => (some.length > 1 ? curve : { ...curve, colour: curve.body ?? curve.colour }));
    const beside = some.flatMap((run) => portraits.get(run));
    const pick = starts ? (left, top) => {
      const { x, y } = plane.map.at(left, top);
      hands.pick([x, y]);
    } : undefined;
    const backdrop = hands.backdrop ?? (centred ? sun : undefined);
    return drawn.length ? { curves: [...drawn, ...beside, ...over], view, labels, log, pick, unpick: hands.unpick, backdrop } : null;
  };
}

/** What the view is made of: the box of each run with the starts beside it, and those with all of their curves. */
function boxesOf(runs, curves, portraits) {
  return runs.filter((run) => curves.get(run).length).flatMap((run) => {
    const beside = portraits.get(run), begins = beside.map(({ x, y }) => ({ x: [x[0]], y: [y[0]] }));
    const box = boxOfAll([...curves.get(run), ...begins]);
    return [box, ...beside.map((curve) => boxOfAll([box, curve]))];
  });
}

/** Pictures in space, turned by `angles`, which `turn` changes, `over` as in the plane. */
export function inBox({ axes, labels, problem }, runs, angles, turn, over) {
  const bodies = bodiesOf(axes, kindsOf(problem));
  const of = (run, names, i) => {
    const columns = run.trajectory ? names.map((name) => column(run.trajectory, name)) : [];
    if (!columns.length || columns.some((values) => !values?.some((v) => v !== null))) return [];
    const trajectory = { ...run.trajectory, ...Object.fromEntries(axes.map((axis, k) => [axis, columns[k]])) };
    return [{ ...run, trajectory, events: times(run), body: bodies.length > 1 ? colourOfBody(i, bodies.length) : run.colour }];
  };
  const seen = new Map(runs.map((run) => [run, bodies.flatMap((names, i) => of(run, names, i))]));
  const box = boxOf(axes, [...seen.values()].flat(), isEqual(axes, problem));
  return (some) => {
    const drawn = some.flatMap((run) => seen.get(run)).map((one) => (some.length > 1 ? one : { ...one, colour: one.body }));
    const beside = over.flatMap((one) => bodies.flatMap((names, i) => of(one, names, i))).map((one) => ({ ...one, ...above }));
    return drawn.length ? { ...inSpace(axes, [...drawn, ...beside], angles, { box, labels }), turn } : null;
  };
}
