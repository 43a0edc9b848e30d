// What the workbench shows of its runs: pictures apart or together, energy, numbers, the scene in motion.
import { Player } from "../forms/player.js";
import { colourOfBody, energyKind } from "../catalogue/card.js";
import { bodiesOf, columnsOf, index, kindsOf } from "../catalogue/kinds.js";
import { Bodies, bodyOf, sun } from "../drawing/bodies.js";
import { EnergyPlot, errorOfEnergy } from "../drawing/energy.js";
import { commonView, curveOf, extent, inCoordinate, valueAt } from "../drawing/mapping.js";
import { Plane } from "../drawing/plane.js";
import { begin, boxOf, inSpace, turnedBy } from "../drawing/space.js";
import { fill } from "./diagnostics.js";

const find = (selector) => document.querySelector(selector);
const column = (trajectory, name) => (name === "error_of_energy" ? trajectory.energy && errorOfEnergy(trajectory) : trajectory[name]);
/** A run whose columns are all numbers. */
const numbered = (run) => (run.trajectory?.mode
  ? { ...run, trajectory: { ...run.trajectory, mode: run.trajectory.mode.map(inCoordinate) } } : run);
const times = ({ outcome }) => (outcome?.events ?? []).map(({ t }) => t);
/** The ends of all curves of a run, as those of one. */
const boxOfAll = (curves) => ({ x: curves.flatMap(({ x }) => extent(x)), y: curves.flatMap(({ y }) => extent(y)) });
/** A run as a chain over its index, which has a shape at every time. */
function chainsOf({ trajectory, colour, title }, names) {
  if (!trajectory?.t.length || !names.every((name) => trajectory[name])) return [];
  const x = names.map((_, i) => i + 1), columns = names.map((name) => trajectory[name]);
  const shape = (t) => ({ x, y: columns.map((values) => valueAt(trajectory.t, values, t)) });
  return [{ t: trajectory.t, x: [1, names.length], y: columns.map(extent).reduce(([a, b], [c, d]) => [Math.min(a, c), Math.max(b, d)]),
            shape, colour, title, events: [] }];
}

export class Results {
  #energy = new EnergyPlot(find("#energy"));
  #together = new Plane(find("#all-runs"), (t) => this.point(t));
  #bodies = new Bodies(find("#bodies"));
  #panes = [];
  #angles = begin;
  #again = () => {};
  #player = new Player(find("#motion .player"), (t) => this.#at(t));

  /**
   * Runs `[{name, title, colour, trajectory}]` over the axes of the scene, each in its pane. A start is dragged by
   * `grab({name: value…}, done)`.
   */
  show(scene, panes, given, grab) {
    const runs = given.map(numbered);
    this.#panes = panes;
    const pictures = scene.axes.length > 2 ? this.#inSpace(scene, runs) : this.#inPlane(scene, runs, grab);
    panes.forEach((pane, i) => pane.show(pictures(runs.slice(i, i + 1))));
    this.#together.show(pictures(runs));
    this.#again = () => this.show(scene, panes, given, grab);
    this.#move(scene.problem, runs.filter(({ trajectory }) => trajectory?.t.length > 1));
  }

  /** The picture of some of the runs, all seen alike: a function of them. */
  #inPlane({ axes, log, labels, problem }, runs, grab) {
    const kinds = kindsOf(problem), bodies = bodiesOf(axes, kinds), moving = problem.variables.map(({ name }) => name);
    const length = (name, i) => moving.includes(name) && !log.includes("xy"[i]), plain = bodies.every((pair) => pair.every(length));
    const chain = axes[0] === index && columnsOf(axes[1], kinds);
    const curves = new Map(runs.map((run) => [run, chain ? chainsOf(run, chain) : bodies.flatMap((pair, i) => {
      const { trajectory, colour, title } = run, [x, y] = trajectory ? pair.map((name) => column(trajectory, name)) : [];
      const curve = x && y && curveOf({ ...trajectory, [pair[0]]: x, [pair[1]]: y }, ...pair, log), [across, up] = pair;
      const taken = plain ? (a, b, done) => grab({ [across]: a, [up]: b }, done) : undefined;
      return curve ? [{ ...curve, series: across === "t", colour, body: bodies.length > 1 ? colourOfBody(i, bodies.length) : colour,
                        title, events: times(run), grab: taken }] : [];
    })]));
    const whole = ["x", "y"].filter((axis, i) => axes[i] === "t" || log.includes(axis));
    const centred = bodyOf(problem) === "planet" && !log && axes.every((name) => ["x", "y"].includes(name)) && axes[0] !== axes[1];
    const view = commonView([...curves.values()].filter((own) => own.length).map(boxOfAll), whole, !plain);
    return (some) => { // of one run each body has its colour, of several each run
      const drawn = some.flatMap((run) => curves.get(run)).map((curve) => (some.length > 1 ? curve : { ...curve, colour: curve.body ?? curve.colour }));
      return drawn.length ? { curves: drawn, view, labels, log, backdrop: centred ? sun : undefined } : null;
    };
  }

  #inSpace({ axes, labels, problem }, runs) {
    const bodies = bodiesOf(axes, kindsOf(problem)), moving = problem.variables.map(({ name }) => name);
    const of = (run, names, i) => {
      const columns = run.trajectory ? names.map((name) => column(run.trajectory, name)) : [];
      if (!columns.length || columns.some((values) => !values?.some((v) => v !== null))) return [];
      const trajectory = { ...run.trajectory, ...Object.fromEntries(axes.map((axis, k) => [axis, columns[k]])) };
      return [{ ...run, trajectory, events: times(run), body: bodies.length > 1 ? colourOfBody(i, bodies.length) : run.colour }];
    };
    const seen = new Map(runs.map((run) => [run, bodies.flatMap((names, i) => of(run, names, i))]));
    const box = boxOf(axes, [...seen.values()].flat(), bodies.every((names) => names.every((name) => moving.includes(name))));
    const turn = (right, down) => {
      this.#angles = turnedBy(this.#angles, right, down);
      this.#again();
    };
    return (some) => {
      const drawn = some.flatMap((run) => seen.get(run)).map((one) => (some.length > 1 ? one : { ...one, colour: one.body }));
      return drawn.length ? { ...inSpace(axes, drawn, this.#angles, { box, labels }), turn } : null;
    };
  }

  #move(problem, runs) {
    const body = bodyOf(problem);
    find("#motion").hidden = runs.length === 0;
    find("#bodies").hidden = !body;
    this.#bodies.show(body, runs);
    const times = runs.flatMap(({ trajectory: { t } }) => [t[0], t.at(-1)]);
    if (times.length) this.#player.span(Math.min(...times), Math.max(...times));
  }

  /** The energy and the numbers of runs that have an `outcome`. */
  tell(problem, runs) {
    const { title, what, note } = this.#energy.show(energyKind(problem), runs);
    find("#energy-name").textContent = title;
    find("#energy-what").textContent = what;
    find("#energy-note").textContent = note;
    fill(find("#numbers"), runs, problem);
  }

  /** The pictures that are in sight, by name. */
  planes(panes) {
    return find("#together").checked ? [["all", this.#together]] : panes.map(({ name, plane }) => [name, plane]);
  }

  /** A hand points at time t of a run, null: at none. */
  point(t) {
    if (!this.#player.playing) this.#at(t ?? this.#player.time, t !== null);
  }

  toggle() {
    this.#player.toggle();
  }

  rest() {
    this.#player.rest();
  }

  draw() {
    [this.#together, ...this.#panes.map(({ plane }) => plane), this.#bodies, this.#energy].forEach((part) => part.draw());
  }

  #at(t, told) {
    [this.#together, ...this.#panes.map(({ plane }) => plane), this.#bodies].forEach((part) => part.at(t, told));
  }
}
