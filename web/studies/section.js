// Where many runs cross a plane, or where a clock finds them: points that come block by block, in a colour for each member.
import { text } from "../language/texts.js";
import * as api from "../service/api.js";
import { build, values, words } from "../forms/forms.js";
import { axes, isAutonomous, motion, spanOf } from "../catalogue/card.js";
import { Crossings } from "../drawing/crossings.js";

const find = (selector) => document.querySelector(`#crossings ${selector}`);

/** The period of what drives a scene, as far as a parameter says so, which may be `set`. */
export function periodOf({ parameters }, set = {}) {
  const frequencies = parameters.filter(({ name }) => /^(omega|w|frequency)$/i.test(name)).map(({ name, default: usual }) => set[name] ?? usual);
  return (2 * Math.PI) / (frequencies.find((one) => one > 0) ?? 1);
}

/**
 * What is asked for at first. Of a motion in a plane by itself its portrait: a clock so fast that its points lie on curves. Of one
 * that is driven, the strobe in the rhythm of the drive; of one with more variables, the plane where the first is zero.
 */
function cardsOf(problem) {
  const names = motion(problem).map(({ name }) => name), shown = axes(problem).map(({ id }) => id).filter((id) => id !== "error_of_energy" && id !== "mode");
  const half = Math.floor(names.length / 2), wide = names.length > 3, alone = !wide && isAutonomous(problem);
  const angle = (name) => (shown.includes(`${name}_wrapped`) ? `${name}_wrapped` : name);
  const vary = names[1], usual = problem.variables.find(({ name }) => name === vary).default ?? 0;
  const size = (alone ? 2.5 : 0.2) * Math.max(1, Math.abs(usual)), rounded = (value) => Number(value.toPrecision(3));
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

/** Of the schemes asked for the first that can go in lanes, else one of the problem's that keeps its structure. */
export function schemeOf(problem, schemes, cards) {
  const fits = ({ id }) => cards.some((card) => card.id === id && !card.implicit && !card.own_clock);
  const keeps = cards.filter(({ id, structure, symmetric }) => problem.schemes.includes(id) && structure !== "none" && symmetric);
  return schemes.find(fits) ?? keeps.map(({ id }) => ({ id })).find(fits) ?? schemes[0];
}

export class Section {
  #crossings = new Crossings(find("canvas"), (member) => this.#run(member));
  #picked; // ({name: value}): the start of a member
  #problem = null;
  #asked = null;

  constructor(picked) {
    this.#picked = picked;
    find("#run-member").addEventListener("click", () => this.#run(Number(find("#member").value)));
    this.clear();
  }

  /** The form for a problem, with `wanted` values as a link holds them. */
  offer(problem, wanted) {
    this.#problem = problem;
    build(find(".fields"), cardsOf(problem), "/crossings", wanted);
    this.clear();
  }

  /** What is set, of `changed` values only. */
  chosen(changed = false) {
    return values(find(".fields"), changed);
  }

  clear() {
    this.#crossings.start(0);
    find("figure").hidden = find("#one").hidden = true;
  }

  /**
   * Asks for the members of a `scene`, with one of the `schemes` that are shown where that can be; `told(text)` hears how many
   * points there are. `{faults}` or `{said}`.
   */
  async measure({ scene, schemes }, cards, signal, told) {
    const scheme = schemeOf(this.#problem, schemes, cards);
    const { where, direction, period, vary, from, to, count: n, x, y } = this.chosen();
    const section = period ? { period, phase: 0 } : { expression: where ?? "", direction };
    this.clear();
    this.#asked = { vary, from, to, n };
    this.#crossings.start(n, x, y);
    find("#member").max = n - 1;
    let points = 0, ended = { completed: 0, stopped: {}, warnings: [{ detail: text("study.broken") }] };
    const request = { ...scene, scheme, section, columns: [...new Set([x, y])], keep: ["section"],
                      members: { vary: { [`/initial/${vary}`]: { grid: [from, to, n] } } } };
    const { faults } = await api.ensemble(request, signal, (line) => {
      if (line.kind === "end") ended = line;
      if (line.kind !== "block") return;
      find("figure").hidden = find("#one").hidden = line.section.member.length + points === 0;
      points = this.#crossings.add(line);
      told(text("section.so_far", { n: points }));
    });
    if (faults) return { faults };
    const stopped = Object.entries(ended.stopped).map(([reason, some]) => text("section.stopped", { n: some, why: words(reason) }));
    const cut = ended.stop ? [text("ended.early", { why: words(ended.stop.reason) })] : [];
    const notes = [...cut, ...stopped, ...ended.warnings.map(({ detail, code }) => detail || code)];
    return { said: [text("section.done", { points, n: ended.completed, scheme: words(scheme.id) }), ...notes].join(" ") };
  }

  draw() {
    this.#crossings.draw();
  }

  #run(member) {
    const { vary, from, to, n } = this.#asked;
    if (!(member >= 0 && member < n)) return;
    find("#member").value = String(member);
    this.#picked({ [vary]: n > 1 ? from + ((to - from) * member) / (n - 1) : from });
  }
}
