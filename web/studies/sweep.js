// One parameter over a range: where the motion crosses a plane or is at the times of a clock (a bifurcation
// diagram), its amplitude (a resonance curve), or its end.
import { text } from "../language/texts.js";
import * as api from "../service/api.js";
import { rounded } from "../service/work.js";
import { words } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { motion, spanOf } from "../catalogue/card.js";
import { paint } from "../drawing/crossings.js";
import { extent } from "../drawing/mapping.js";
import { Plane } from "../drawing/plane.js";
import { broken, notesOf, patience, Study } from "./part.js";
import { columnsOf, numbersOf, pointerTo } from "./pointers.js";
import { schemeOf } from "./section.js";

/** The name of the quantity that is drawn for a column. */
const named = (show, name) => (show === "amplitude" ? text("sweep.amplitude_of", { name }) : name);

function cardsOf(problem) {
  const names = motion(problem).map(({ name }) => name), parameters = numbersOf(problem), [vary] = parameters;
  const usual = problem.parameters.find(({ name }) => name === vary)?.default ?? 1, size = Math.abs(usual) || 1, span = spanOf(problem);
  const shown = columnsOf(problem).filter((name) => name !== "t");
  const shows = { crossings: text("sweep.crossings"), amplitude: text("sweep.amplitude"), end: text("sweep.end") };
  return [
    { name: "vary", label: text("sweep.vary"), type: "choice", choices: parameters, default: vary },
    { name: "from", label: text("section.from"), default: rounded(usual - size / 2) }, { name: "to", label: text("section.to"), default: rounded(usual + size / 2) },
    { name: "count", label: text("section.count"), default: 400 },
    { name: "show", label: text("sweep.show"), type: "choice", choices: Object.keys(shows), words: shows, default: "crossings" },
    { name: "y", label: text("section.y"), type: "choice", choices: shown, default: names[0] },
    { name: "where", label: text("section.where"), type: "text", default: names[Math.floor(names.filter((name) => name !== "s").length / 2)] ?? names[0], hint: text("none"), doc: text("section.where.doc") },
    { name: "direction", label: text("section.direction"), type: "choice", choices: ["up", "down", "both"], default: "down" },
    { name: "period", label: text("section.period"), default: null, nullable: true, doc: text("section.period.doc") },
    { name: "until", label: text("scene.until"), default: rounded(4 * span) }, { name: "after", label: text("sweep.after"), default: rounded(3 * span), doc: text("sweep.after.doc") },
  ];
}

export class Sweep extends Study {
  #plane = new Plane(this.find("canvas"));
  #picked; // ({name: value}, "problem"): a value that is to be run
  #asked = null;
  #blocks = []; // {member, x, y}: of an amplitude or an end one point for each run
  #due = 0;

  constructor(picked) {
    super("sweep", cardsOf);
    this.#picked = picked;
  }

  clear() {
    this.#blocks = [];
    this.#asked = null;
    this.find("figure").hidden = true;
    this.draw();
  }

  /** Asks for the members of a `scene`, as Section.measure does. */
  async measure({ scene, schemes }, cards, signal, told) {
    const asked = this.chosen(), { vary, from, to, count: n, show, y, where, direction, period, until, after } = asked;
    if (!vary) return { faults: [{ detail: text("sweep.nothing") }] };
    const scheme = schemeOf(this.problem, schemes, cards);
    this.clear();
    const mine = (this.#asked = asked);
    let points = 0, ended = broken();
    const section = period ? { period, phase: 0 } : { expression: where ?? "", direction: show === "amplitude" ? "both" : direction };
    const request = { ...scene, scheme, until: { t: until }, ...(show === "end" ? {} : { section }), columns: [y], limits: { seconds: patience },
                      keep: [show === "end" ? "final" : "section"], members: { vary: { [pointerTo(this.problem, vary)]: { grid: [from, to, n] } } } };
    const { faults } = await api.ensemble(request, signal, (line) => {
      if (line.kind === "end") ended = line;
      if (line.kind !== "block" || this.#asked !== mine) return;
      points += this.#add(show === "end" ? { member: line.final.index, y: line.final[y] } : late(line.section, y, after));
      told(text("section.so_far", { n: points }));
    });
    if (faults) return { faults };
    const said = text("section.done", { points, n: ended.completed, scheme: words(scheme.id) }) + (points && show !== "crossings" ? this.#peak() : "");
    return { said: [said, ...notesOf(ended)].join(" ") };
  }

  /** Adds points of members, to be drawn in the next frame; returns their number. */
  #add({ member, y }) {
    const { from, to, count: n, show } = this.#asked;
    const block = show === "amplitude" ? swings(member, y) : { member, y };
    this.#blocks.push({ ...block, x: block.member.map((m) => (n > 1 ? from + ((to - from) * m) / (n - 1) : from)) });
    this.#due ||= requestAnimationFrame(() => this.draw());
    return block.member.length;
  }

  /** The words about the largest value drawn and its place. */
  #peak() {
    const { vary, show, y: name } = this.#asked;
    let [at, most] = [null, -Infinity];
    for (const { x, y } of this.#blocks) y.forEach((v, i) => v !== null && v > most && ([at, most] = [x[i], v]));
    return ` ${text("sweep.largest", { what: named(show, name), value: format(most, 4), vary, at: format(at, 4) })}`;
  }

  draw() {
    this.#due = 0;
    const full = this.#blocks.filter(({ member }) => member.length);
    this.find("figure").hidden = !full.length;
    if (!full.length) return this.#plane.show(null);
    const { vary, from, to, count: n, show, y } = this.#asked, ends = full.map((block) => extent(block.y));
    const view = { x: [Math.min(from, to), Math.max(from, to)], y: [Math.min(...ends.map(([low]) => low)), Math.max(...ends.map(([, high]) => high))], free: true };
    const labels = [vary, named(show, y)];
    const pick = (left, top) => this.#run(this.#plane.map.at(left, top).x);
    const curve = { x: full.flatMap((block) => block.x), y: full.flatMap((block) => block.y), colour: "--run-b", title: "", unmarked: true };
    if (show !== "crossings") return this.#plane.show({ curves: [curve], view, labels, pick });
    const ink = getComputedStyle(this.find("canvas")).getPropertyValue("--run-b").trim().slice(1), [r, g, b] = ink.match(/../g).map((two) => parseInt(two, 16));
    const colours = new Uint32Array(n).fill(0xff000000 | (b << 16) | (g << 8) | r);
    this.#plane.show({ curves: [], view, labels, backdrop: paint(full, colours), pick });
  }

  /** Runs the value of the parameter that is nearest to a place. */
  #run(place) {
    const { vary, from, to, count: n } = this.#asked, step = n > 1 ? (to - from) / (n - 1) : 0;
    const member = step ? Math.min(n - 1, Math.max(0, Math.round((place - from) / step))) : 0;
    this.#picked({ [vary]: rounded(from + member * step, 12) }, "problem");
  }
}

/** The crossings from a time on, with the column `name`. */
function late({ member, t, ...columns }, name, after) {
  const kept = member.map((_, i) => i).filter((i) => t[i] >= after);
  return { member: kept.map((i) => member[i]), y: kept.map((i) => columns[name][i]) };
}

/** The amplitude of each member: half the difference of its largest and its smallest value. */
function swings(member, y) {
  const ends = new Map();
  member.forEach((m, i) => {
    if (y[i] === null) return;
    const [low, high] = ends.get(m) ?? [Infinity, -Infinity];
    ends.set(m, [Math.min(low, y[i]), Math.max(high, y[i])]);
  });
  return { member: [...ends.keys()], y: [...ends.values()].map(([low, high]) => (high - low) / 2) };
}
