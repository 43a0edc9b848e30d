// Where the runs end that begin on a rectangle of starts: a pixel for each, coloured by its end, block by block as they come.
import { text } from "../language/texts.js";
import * as api from "../service/api.js";
import { build, values, words } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { axes, motion } from "../catalogue/card.js";
import { EndsPicture } from "../drawing/ends.js";
import { schemeOf } from "./section.js";

const find = (selector) => document.querySelector(`#basins ${selector}`);
const patience = 60; // seconds that the service may take

function cardsOf(problem) {
  const moving = motion(problem), names = moving.map(({ name }) => name);
  const [x, y] = [names[0], names[Math.floor(names.length / 2)] ?? names[0]];
  const about = (name) => problem.variables.find((card) => card.name === name).default ?? 0;
  const ends = (name) => [-1, 1].map((side) => Number((about(name) + 2 * side).toPrecision(3)));
  const shown = axes(problem).map(({ id }) => id).filter((id) => id !== "error_of_energy" && id !== "mode");
  return [
    { name: "x", label: text("basins.x"), type: "choice", choices: names, default: x },
    { name: "left", label: text("basins.left"), default: ends(x)[0] }, { name: "right", label: text("basins.right"), default: ends(x)[1] },
    { name: "y", label: text("basins.y"), type: "choice", choices: names, default: y },
    { name: "low", label: text("basins.low"), default: ends(y)[0] }, { name: "high", label: text("basins.high"), default: ends(y)[1] },
    { name: "side", label: text("basins.side"), default: 128, doc: text("basins.side.doc") },
    { name: "colour", label: text("basins.colour"), type: "choice", choices: shown, default: y },
  ];
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
    if (x === y) return { faults: [{ detail: text("basins.same") }] };
    const grid = { [`/initial/${x}`]: { grid: [left, right, side] }, [`/initial/${y}`]: { grid: [low, high, side] } };
    this.clear();
    this.#asked = asked;
    find("#start").max = side * side - 1;
    let end = { completed: 0, stopped: {}, warnings: [{ detail: text("study.broken") }] }, ends = null;
    const request = { ...scene, scheme, limits: { seconds: patience }, columns: [colour], keep: ["final"], members: { vary: grid } };
    const { faults } = await api.ensemble(request, signal, (line) => {
      if (line.kind === "end") end = line;
      if (line.kind !== "block") return;
      if (!ends) this.#picture.start(asked);
      ends ??= this.#picture.ends;
      if (ends !== this.#picture.ends) return; // nobody awaits them any more
      this.#picture.add(line, colour);
      find("figure").hidden = find("#one-start").hidden = false;
      told(text("basins.so_far", { done: ends.completed, all: side * side }));
    });
    if (faults) return { faults };
    const [least, most] = ends?.range ?? [0, -1];
    const range = least <= most ? ` ${text("basins.range", { what: words(colour), from: format(least, 3), to: format(most, 3) })}` : "";
    const cut = end.stop ? [text("ended.early", { why: words(end.stop.reason) })] : [];
    const others = Object.entries(end.stopped).map(([reason, some]) => text("basins.stopped", { n: some, why: words(reason) }));
    return { said: [text("basins.done", { n: end.completed, scheme: words(scheme.id) }) + range, ...cut, ...others,
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
