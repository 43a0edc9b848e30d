// Where the runs end that begin on a rectangle of starts: a pixel for each, coloured by its end, block by block as they come.
import { text } from "../language/texts.js";
import * as api from "../service/api.js";
import { rounded } from "../service/work.js";
import { words } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { motion } from "../catalogue/card.js";
import { EndsPicture } from "../drawing/ends.js";
import { broken, Members, notesOf, patience, Study } from "./part.js";
import { columnsOf } from "./pointers.js";
import { schemeOf } from "./section.js";

function cardsOf(problem) {
  const moving = motion(problem), names = moving.map(({ name }) => name);
  const [x, y] = [names[0], names[Math.floor(names.length / 2)] ?? names[0]];
  const about = (name) => problem.variables.find((card) => card.name === name).default ?? 0;
  const ends = (name) => [-1, 1].map((side) => rounded(about(name) + 2 * side));
  return [
    { name: "x", label: text("basins.x"), type: "choice", choices: names, default: x },
    { name: "left", label: text("basins.left"), default: ends(x)[0] }, { name: "right", label: text("basins.right"), default: ends(x)[1] },
    { name: "y", label: text("basins.y"), type: "choice", choices: names, default: y },
    { name: "low", label: text("basins.low"), default: ends(y)[0] }, { name: "high", label: text("basins.high"), default: ends(y)[1] },
    { name: "side", label: text("basins.side"), default: 128, doc: text("basins.side.doc") },
    { name: "colour", label: text("basins.colour"), type: "choice", choices: columnsOf(problem), default: y },
  ];
}

export class Basins extends Study {
  #members = new Members(this, (member) => this.#run(member));
  #picture = new EndsPicture(this.find("canvas"), (member) => this.#members.pick(member));
  #picked; // ({name: value}): the start of a member
  #asked = null;

  constructor(picked) {
    super("basins", cardsOf);
    this.#picked = picked;
  }

  clear() {
    this.#picture.start();
    this.#members.offer(0);
    this.find("figure").hidden = true;
  }

  /** Asks for the runs of a `scene`, as Section.measure does. */
  async measure({ scene, schemes }, cards, signal, told) {
    const scheme = schemeOf(this.problem, schemes, cards), asked = this.chosen(), { x, y, left, right, low, high, side, colour } = asked;
    if (x === y) return { faults: [{ detail: text("basins.same") }] };
    const grid = { [`/initial/${x}`]: { grid: [left, right, side] }, [`/initial/${y}`]: { grid: [low, high, side] } };
    this.clear();
    this.#asked = asked;
    let end = broken(), ends = null;
    const request = { ...scene, scheme, limits: { seconds: patience }, columns: [colour], keep: ["final"], members: { vary: grid } };
    const { faults } = await api.ensemble(request, signal, (line) => {
      if (line.kind === "end") end = line;
      if (line.kind !== "block") return;
      if (!ends) this.#picture.start(asked);
      ends ??= this.#picture.ends;
      if (ends !== this.#picture.ends) return; // nobody awaits them any more
      this.#picture.add(line, colour);
      this.find("figure").hidden = false;
      this.#members.offer(side * side);
      told(text("basins.so_far", { done: ends.completed, all: side * side }));
    });
    if (faults) return { faults };
    const [least, most] = ends?.range ?? [0, -1];
    const range = least <= most ? [text("basins.range", { what: words(colour), from: format(least, 3), to: format(most, 3) })] : [];
    return { said: [text("basins.done", { n: end.completed, scheme: words(scheme.id) }), ...range, ...notesOf(end)].join(" ") };
  }

  draw() {
    this.#picture.draw();
  }

  #run(member) {
    const { x, y, left, right, low, high, side: n } = this.#asked;
    const on = (from, to, k) => (n > 1 ? from + ((to - from) * k) / (n - 1) : from);
    this.#picked({ [x]: on(left, right, Math.floor(member / n)), [y]: on(low, high, member % n) });
  }
}
