// Where the runs end that begin on a rectangle of starts: a pixel for each, coloured by its end, block by block as they come.
import * as api from "./api.js";
import { axes, motion } from "./card.js";
import { hues } from "./crossings.js";
import { build, values, words } from "./forms.js";
import { count, format } from "./numbers.js";
import { Plane } from "./plane.js";
import { schemeOf } from "./section.js";

const find = (selector) => document.querySelector(`#basins ${selector}`);
const patience = 60; // seconds that the service may take
const shades = 256, stopped = 0xff808080; // opaque grey, as a canvas holds it in memory

function cardsOf(problem) {
  const moving = motion(problem), names = moving.map(({ name }) => name);
  const [x, y] = [names[0], names[Math.floor(names.length / 2)] ?? names[0]];
  const about = (name) => problem.variables.find((card) => card.name === name).default ?? 0;
  const ends = (name) => [-1, 1].map((side) => Number((about(name) + 2 * side).toPrecision(3)));
  const shown = axes(problem).map(({ id }) => id).filter((id) => id !== "error_of_energy" && id !== "mode");
  return [
    { name: "x", label: "starts across", type: "choice", choices: names, default: x },
    { name: "left", default: ends(x)[0] }, { name: "right", default: ends(x)[1] },
    { name: "y", label: "starts up", type: "choice", choices: names, default: y },
    { name: "low", default: ends(y)[0] }, { name: "high", default: ends(y)[1] },
    { name: "side", label: "runs a side", default: 128, doc: "as many starts across as up" },
    { name: "colour", label: "colour by the last", type: "choice", choices: shown, default: y },
  ];
}

/** What the form would hold, of a request. */
export function rectangleOf({ columns: [colour], members: { vary } }) {
  const [[x, { grid: [left, right, side] }], [y, { grid: [low, high] }]] = Object.entries(vary);
  const name = (pointer) => pointer.replace("/initial/", "");
  return { x: name(x), left, right, y: name(y), low, high, side, colour };
}

/** The ends of `n` × `n` runs: the member at column i and row j of the picture is i·n + j, rows from below. */
export class Ends {
  #last; // of each member, NaN: not known
  #state; // 0: to come, 1: completed, 2: stopped
  completed = 0;

  constructor(n) {
    this.n = n;
    this.#last = new Float64Array(n * n).fill(NaN);
    this.#state = new Uint8Array(n * n);
  }

  /** What a line of the service brings. */
  add({ first, members, final }, column) {
    this.#state.fill(2, first, first + members);
    final.index.forEach((member, k) => {
      this.#state[member] = 1;
      this.#last[member] = final[column][k] ?? NaN;
    });
    this.completed += final.index.length;
  }

  get values() {
    return this.#last;
  }

  /** The least and the largest of the ends so far. */
  get range() {
    let low = Infinity, high = -Infinity;
    for (const v of this.#last) {
      if (v < low) low = v;
      if (v > high) high = v;
    }
    return [low, high];
  }

  /** The picture in memory, the highest row first: transparent where nothing is known. */
  paint(colours) {
    const { n } = this, pixels = new Uint32Array(n * n), [low, high] = this.range, scale = high > low ? (shades - 1) / (high - low) : 0;
    for (let member = 0; member < n * n; member++) {
      const state = this.#state[member], at = (n - 1 - (member % n)) * n + Math.floor(member / n), v = this.#last[member];
      if (state) pixels[at] = state === 1 && !Number.isNaN(v) ? colours[Math.round((v - low) * scale)] : stopped;
    }
    return pixels;
  }
}

/** The picture of the ends on a canvas; `taken(member)` hears which pixel a hand clicks. */
export class EndsPicture {
  #plane;
  #taken;
  #asked = null;
  #due = 0;
  ends = null;

  constructor(canvas, taken = () => {}) {
    this.#plane = new Plane(canvas);
    this.#taken = taken;
  }

  /** Awaits `side` × `side` runs from `left` to `right` in x and `low` to `high` in y; nothing: forgets all. */
  start(asked = null) {
    this.#asked = asked;
    this.ends = asked && new Ends(asked.side);
    this.draw();
  }

  /** Adds what a line of the service brings of that column, to be seen in the next frame. */
  add(line, column) {
    this.ends.add(line, column);
    this.#due ||= requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.#due = 0;
    if (!this.ends) return this.#plane.show(null);
    const { x, y, left, right, low, high, side: n, labels = [x, y] } = this.#asked;
    const half = (from, to) => (n > 1 ? (to - from) / (n - 1) / 2 : 0.5); // a pixel lies about its start
    const across = [left - half(left, right), right + half(left, right)], up = [low - half(low, high), high + half(low, high)];
    const dark = matchMedia("(prefers-color-scheme: dark)").matches, pixels = this.ends.paint(hues(shades, dark ? 0.64 : 0.5));
    const made = new OffscreenCanvas(n, n);
    made.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(pixels.buffer), n, n), 0, 0);
    const backdrop = (pen, map) => {
      pen.imageSmoothingEnabled = false;
      pen.drawImage(made, map.x(across[0]), map.y(up[1]), map.x(across[1]) - map.x(across[0]), map.y(up[0]) - map.y(up[1]));
    };
    const at = (v, from, to) => Math.round(((v - from) / (to - from)) * (n - 1));
    const pick = (there, below) => {
      const place = this.#plane.map.at(there, below), i = at(place.x, left, right), j = at(place.y, low, high);
      if (i >= 0 && i < n && j >= 0 && j < n) this.#taken(i * n + j);
    };
    this.#plane.show({ curves: [], view: { x: across, y: up, free: true }, labels, backdrop, pick });
  }
}

export class Basins {
  #picture = new EndsPicture(find("canvas"), (member) => this.#run(member));
  #picked; // ({name: value}): the start of a member
  #problem = null;
  #asked = null;

  constructor(picked) {
    this.#picked = picked;
    find("#run-start").addEventListener("click", () => this.#run(Number(find("#start").value)));
    this.clear();
  }

  /** The form for a problem, with `wanted` values as a link holds them. */
  offer(problem, wanted) {
    this.#problem = problem;
    build(find(".fields"), cardsOf(problem), "/basins", wanted);
    this.clear();
  }

  /** What is set, of `changed` values only. */
  chosen(changed = false) {
    return values(find(".fields"), changed);
  }

  clear() {
    this.#picture.start();
    find("figure").hidden = find("#one-start").hidden = true;
  }

  /** Asks for the runs of a `scene`, as Section.measure does. */
  async measure({ scene, schemes }, cards, signal, told) {
    const scheme = schemeOf(this.#problem, schemes, cards), asked = this.chosen(), { x, y, left, right, low, high, side, colour } = asked;
    if (x === y) return { faults: [{ detail: "Starts across and up must be two variables." }] };
    const grid = { [`/initial/${x}`]: { grid: [left, right, side] }, [`/initial/${y}`]: { grid: [low, high, side] } };
    this.clear();
    this.#asked = asked;
    find("#start").max = side * side - 1;
    let end = { completed: 0, stopped: {}, warnings: [{ detail: "The answer broke off." }] }, ends = null;
    const request = { ...scene, scheme, limits: { seconds: patience }, columns: [colour], keep: ["final"], members: { vary: grid } };
    const { faults } = await api.ensemble(request, signal, (line) => {
      if (line.kind === "end") end = line;
      if (line.kind !== "block") return;
      if (!ends) this.#picture.start(asked);
      ends ??= this.#picture.ends;
      if (ends !== this.#picture.ends) return; // nobody awaits them any more
      this.#picture.add(line, colour);
      find("figure").hidden = find("#one-start").hidden = false;
      told(`${count(ends.completed)} of ${count(side * side)} runs…`);
    });
    if (faults) return { faults };
    const [least, most] = ends?.range ?? [0, -1];
    const range = least <= most ? ` ${words(colour)} at the end from ${format(least, 3)}, red, to ${format(most, 3)}, violet.` : "";
    const cut = end.stop ? [`Ended early: ${words(end.stop.reason)}.`] : [];
    const others = Object.entries(end.stopped).map(([reason, some]) => `${count(some)} stopped (${words(reason)}), grey.`);
    return { said: [`${count(end.completed)} runs with ${words(scheme.id)}.${range}`, ...cut, ...others,
                    ...end.warnings.map(({ detail, code }) => detail || code)].join(" ") };
  }

  draw() {
    this.#picture.draw();
  }

  #run(member) {
    const { x, y, left, right, low, high, side: n } = this.#asked;
    if (!(member >= 0 && member < n * n)) return;
    find("#start").value = String(member);
    const on = (from, to, k) => (n > 1 ? from + ((to - from) * k) / (n - 1) : from);
    this.#picked({ [x]: on(left, right, Math.floor(member / n)), [y]: on(low, high, member % n) });
  }
}
