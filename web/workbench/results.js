// What the workbench shows of its runs: pictures apart or together, energy, numbers, the scene in motion.
import { Player } from "../forms/player.js";
import { energyKind } from "../catalogue/card.js";
import { Bodies, bodyOf, sun } from "../drawing/bodies.js";
import { EnergyPlot, errorOfEnergy } from "../drawing/energy.js";
import { commonView, curveOf, inCoordinate } from "../drawing/mapping.js";
import { Plane } from "../drawing/plane.js";
import { begin, boxOf, inSpace, turnedBy } from "../drawing/space.js";
import { fill } from "./diagnostics.js";

const find = (selector) => document.querySelector(selector);
const column = (trajectory, name) => (name === "error_of_energy" ? trajectory.energy && errorOfEnergy(trajectory) : trajectory[name]);
/** A run whose columns are all numbers. */
const numbered = (run) => (run.trajectory?.mode
  ? { ...run, trajectory: { ...run.trajectory, mode: run.trajectory.mode.map(inCoordinate) } } : run);
const times = ({ outcome }) => (outcome?.events ?? []).map(({ t }) => t);

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
    const curves = new Map(runs.map((run) => {
      const { trajectory, colour, title } = run, [x, y] = trajectory ? axes.map((name) => column(trajectory, name)) : [];
      const curve = x && y && curveOf({ ...trajectory, [axes[0]]: x, [axes[1]]: y }, ...axes, log);
      return [run, curve && { ...curve, series: axes[0] === "t", colour, title, events: times(run) }];
    }));
    const moving = problem.variables.map(({ name }) => name), length = (name, i) => moving.includes(name) && !log.includes("xy"[i]);
    const whole = ["x", "y"].filter((axis, i) => axes[i] === "t" || log.includes(axis)), plain = axes.every(length);
    const centred = bodyOf(problem.id) === "planet" && !log && axes.every((name) => ["x", "y"].includes(name)) && axes[0] !== axes[1];
    const view = commonView([...curves.values()].filter(Boolean), whole, !plain);
    return (some) => {
      const drawn = some.map((run) => curves.get(run)).filter(Boolean);
      return drawn.length ? { curves: drawn, view, labels, log, backdrop: centred ? sun : undefined,
        grab: plain ? (x, y, done) => grab({ [axes[0]]: x, [axes[1]]: y }, done) : undefined } : null;
    };
  }

  #inSpace({ axes, labels, problem }, runs) {
    const whole = (trajectory) => ({ ...trajectory, ...Object.fromEntries(axes.map((name) => [name, column(trajectory, name)])) });
    const full = ({ trajectory }) => trajectory && axes.every((name) => column(trajectory, name)?.some((v) => v !== null));
    const seen = new Map(runs.filter(full).map((run) => [run, { ...run, trajectory: whole(run.trajectory), events: times(run) }]));
    const equal = axes.every((name) => problem.variables.some((variable) => variable.name === name));
    const box = boxOf(axes, [...seen.values()], equal);
    const turn = (right, down) => {
      this.#angles = turnedBy(this.#angles, right, down);
      this.#again();
    };
    return (some) => {
      const drawn = some.filter((run) => seen.has(run)).map((run) => seen.get(run));
      return drawn.length ? { ...inSpace(axes, drawn, this.#angles, { box, labels }), turn } : null;
    };
  }

  #move(problem, runs) {
    const body = bodyOf(problem.id);
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
