// What the workbench shows of its runs: pictures apart or together, energy, numbers, the scene in motion.
import { Player } from "../forms/player.js";
import { energyKind } from "../catalogue/card.js";
import { statedBodies } from "../catalogue/stated.js";
import { Bodies, bodyOf } from "../drawing/bodies.js";
import { EnergyPlot } from "../drawing/energy.js";
import { inCoordinate } from "../drawing/mapping.js";
import { Plane } from "../drawing/plane.js";
import { begin, turnedBy } from "../drawing/space.js";
import { fill } from "./diagnostics.js";
import { inBox, inPlane } from "./pictures.js";

const find = (selector) => document.querySelector(selector);
/** A run whose columns are all numbers. */
const numbered = (run) => (run.trajectory?.mode
  ? { ...run, trajectory: { ...run.trajectory, mode: run.trajectory.mode.map(inCoordinate) } } : run);

export class Results {
  #energy = new EnergyPlot(find("#energy"));
  #together = new Plane(find("#all-runs"), (t) => this.point(t));
  #bodies = new Bodies(find("#bodies"));
  #panes = [];
  #angles = begin;
  #again = () => {};
  #seen = () => {}; // of each time that is drawn
  #player = new Player(find("#motion .player"), (t) => this.#at(t));

  /** Runs `[{name, title, colour, trajectory, starts}]` over the axes of the scene, each in its pane; `hands` as inPlane takes them. */
  show(scene, panes, given, hands) {
    const runs = given.map(numbered), turn = (right, down) => {
      this.#angles = turnedBy(this.#angles, right, down);
      this.#again();
    };
    this.#panes = panes;
    const pictures = scene.axes.length > 2 ? inBox(scene, runs, this.#angles, turn, hands.over) : inPlane(scene, runs, hands);
    panes.forEach((pane, i) => pane.show(pictures(runs.slice(i, i + 1), pane.plane)));
    this.#together.show(pictures(runs, this.#together));
    this.#again = () => this.show(scene, panes, given, hands);
    this.#move(scene.problem, runs.filter(({ trajectory }) => trajectory?.t.length > 1));
  }

  #move(problem, runs) {
    const body = statedBodies(problem) ?? bodyOf(problem);
    find("#motion").hidden = runs.length === 0;
    find("#bodies").hidden = !body || runs.length === 0;
    this.#bodies.show(body, runs);
    const times = runs.flatMap(({ trajectory: { t } }) => [t[0], t.at(-1)]);
    const ends = [Math.min(...times), Math.max(...times)], backward = runs.every(({ trajectory: { t } }) => t.at(-1) < t[0]);
    if (times.length) this.#player.span(...(backward ? ends.toReversed() : ends));
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

  /** Shows the runs at time t, at which the pointer is; null: it is at no run. */
  point(t) {
    if (!this.#player.playing) this.#at(t ?? this.#player.time, t !== null);
  }

  /** The bounds of the visible picture, `{low: {x, y}, high: {x, y}}`, null if nothing is drawn. */
  get extent() {
    return (find("#together").checked ? this.#together : this.#panes[0]?.plane)?.map ?? null;
  }

  toggle() {
    this.#player.toggle();
  }

  /** Plays all from the start; `seen(t)` hears of what is drawn, null at the end. */
  play(seen) {
    this.#player.rest();
    this.#seen = seen;
    this.#player.play();
  }

  rest() {
    this.#player.rest();
  }

  draw() {
    [this.#together, ...this.#panes.map(({ plane }) => plane), this.#bodies, this.#energy].forEach((part) => part.draw());
  }

  #at(t, told) {
    [this.#together, ...this.#panes.map(({ plane }) => plane), this.#bodies].forEach((part) => part.at(t, told));
    this.#seen(t);
  }
}
