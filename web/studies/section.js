// The points of many runs on a plane, or at the times of a clock: they come block by block, in a colour for each member.
import { text } from "../language/texts.js";
import * as api from "../service/api.js";
import { rounded } from "../service/work.js";
import { words } from "../forms/forms.js";
import { isAutonomous, motion, spanOf } from "../catalogue/card.js";
import { Crossings } from "../drawing/crossings.js";
import { broken, Members, notesOf, Study } from "./part.js";
import { columnsOf } from "./pointers.js";

/** The period of the drive of a scene, by the parameter with its frequency, which may be `set`; 2π if there is none. */
export function periodOf({ parameters }, set = {}) {
  const frequencies = parameters.filter(({ name }) => /^(omega|w|frequency)$/i.test(name)).map(({ name, default: usual }) => set[name] ?? usual);
  return (2 * Math.PI) / (frequencies.find((one) => one > 0) ?? 1);
}

/**
 * What is asked for at first. Of a motion in a plane by itself its portrait: a clock so fast that its points lie on curves. Of one
 * that is driven, the strobe in the rhythm of the drive; of one with more variables, the plane where the first is zero.
 */
function cardsOf(problem) {
  const names = motion(problem).map(({ name }) => name), shown = columnsOf(problem);
  const half = Math.floor(names.length / 2), wide = names.length > 3, alone = !wide && isAutonomous(problem);
  const angle = (name) => (shown.includes(`${name}_wrapped`) ? `${name}_wrapped` : name);
  const vary = names[1], usual = problem.variables.find(({ name }) => name === vary).default ?? 0;
  const size = (alone ? 2.5 : 0.2) * Math.max(1, Math.abs(usual));
  return [
    { name: "where", label: text("section.where"), type: "text", default: wide ? names[0] : "", hint: text("none"), doc: text("section.where.doc") },
    { name: "direction", label: text("section.direction"), type: "choice", choices: ["up", "down", "both"], default: "up" },
    { name: "period", label: text("section.period"), default: wide ? null : alone ? rounded(spanOf(problem) / 400) : periodOf(problem), nullable: true,
      doc: text("section.period.doc") },
    { name: "vary", label: text("section.vary"), type: "choice", choices: problem.variables.map(({ name }) => name), default: vary },
    { name: "from", label: text("section.from"), default: rounded(usual - size) }, { name: "to", label: text("section.to"), default: rounded(usual + size) },
    { name: "count", label: text("section.count"), default: 40, doc: text("section.count.doc") },
    { name: "x", label: text("section.x"), type: "choice", choices: shown, default: angle(wide ? names[1] : names[0]) },
    { name: "y", label: text("section.y"), type: "choice", choices: shown, default: wide ? names[half + 1] : names[1] },
  ];
}

/** The first of `schemes` that is explicit and does not choose its steps; else such a symmetric one that keeps a structure. */
export function schemeOf(problem, schemes, cards) {
  const fits = ({ id }) => cards.some((card) => card.id === id && !card.implicit && !card.own_clock);
  const keeps = cards.filter(({ id, structure, symmetric }) => problem.schemes.includes(id) && structure !== "none" && symmetric);
  return schemes.find(fits) ?? keeps.map(({ id }) => ({ id })).find(fits) ?? schemes[0];
}

export class Section extends Study {
  #members = new Members(this, (member) => this.#run(member));
  #crossings = new Crossings(this.find("canvas"), (member) => this.#members.pick(member));
  #picked; // ({name: value}): the start of a member
  #asked = null;

  constructor(picked) {
    super("section", cardsOf);
    this.#picked = picked;
  }

  clear() {
    this.#crossings.start(0);
    this.#members.offer(0);
    this.find("figure").hidden = true;
  }

  /**
   * Asks for the members of a `scene`, with one of the `schemes` that are shown where that can be; `told(text)` hears how many
   * points there are. `{faults}` or `{said}`.
   */
  async measure({ scene, schemes }, cards, signal, told) {
    const scheme = schemeOf(this.problem, schemes, cards);
    const { where, direction, period, vary, from, to, count: n, x, y } = this.chosen();
    const section = period ? { period, phase: 0 } : { expression: where ?? "", direction };
    this.clear();
    this.#asked = { vary, from, to, n };
    this.#crossings.start(n, x, y);
    let points = 0, end = broken();
    const request = { ...scene, scheme, section, columns: [...new Set([x, y])], keep: ["section"],
                      members: { vary: { [`/initial/${vary}`]: { grid: [from, to, n] } } } };
    const { faults } = await api.ensemble(request, signal, (line) => {
      if (line.kind === "end") end = line;
      if (line.kind !== "block") return;
      points = this.#crossings.add(line);
      this.find("figure").hidden = points === 0;
      this.#members.offer(points ? n : 0);
      told(text("section.so_far", { n: points }));
    });
    return faults ? { faults } : { said: [text("section.done", { points, n: end.completed, scheme: words(scheme.id) }), ...notesOf(end)].join(" ") };
  }

  draw() {
    this.#crossings.draw();
  }

  #run(member) {
    const { vary, from, to, n } = this.#asked;
    this.#picked({ [vary]: n > 1 ? from + ((to - from) * member) / (n - 1) : from });
  }
}
