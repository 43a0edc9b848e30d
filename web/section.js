// Where many runs cross a plane, or where a clock finds them: points that come block by block, in a colour for each member.
import * as api from "./api.js";
import { axes, motion } from "./card.js";
import { build, values, words } from "./forms.js";
import { count } from "./numbers.js";
import { Plane } from "./plane.js";
import { extent } from "./scale.js";

const find = (selector) => document.querySelector(`#crossings ${selector}`);
const reach = 12; // pixels from which a point is taken

/** What is asked for at first: of a motion in a plane the strobe, of one with more variables the plane where the first is zero. */
function cardsOf(problem) {
  const names = motion(problem).map(({ name }) => name), shown = axes(problem).map(({ id }) => id).filter((id) => id !== "error_of_energy");
  const half = Math.floor(names.length / 2), wide = names.length > 3;
  const angle = (name) => (shown.includes(`${name}_wrapped`) ? `${name}_wrapped` : name);
  const vary = names[1], usual = problem.variables.find(({ name }) => name === vary).default ?? 0;
  const size = 0.2 * Math.max(1, Math.abs(usual)), rounded = (value) => Number(value.toPrecision(3));
  return [
    { name: "where", label: "zero of", type: "text", default: wide ? names[0] : "", hint: "none", doc: "a variable or a formula" },
    { name: "direction", label: "going", type: "choice", choices: ["up", "down", "both"], default: "up" },
    { name: "period", label: "or every period", default: wide ? null : 2 * Math.PI, nullable: true,
      doc: "a clock in the place of a plane" },
    { name: "vary", label: "starts in", type: "choice", choices: problem.variables.map(({ name }) => name), default: vary },
    { name: "from", default: rounded(usual - size) }, { name: "to", default: rounded(usual + size) },
    { name: "count", label: "runs", default: 40, doc: "how many starts, evenly from the one to the other" },
    { name: "x", label: "across", type: "choice", choices: shown, default: angle(wide ? names[1] : names[0]) },
    { name: "y", label: "up", type: "choice", choices: shown, default: wide ? names[half + 1] : names[1] },
  ];
}

/** The colours of members, from red over green to violet, as a canvas holds them in memory. */
function hues(n, bright) {
  return Uint32Array.from({ length: n }, (_, i) => {
    const channel = (shift) => {
      const k = (shift + (i / Math.max(n - 1, 1)) * 9.6) % 12;
      return Math.round(255 * (bright - 0.35 * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
    };
    return 0xff000000 | (channel(4) << 16) | (channel(8) << 8) | channel(0);
  });
}

/** Paints blocks of points into the frame of a picture: in memory, which takes a million at once. */
export function paint(blocks, colours) {
  return (pen, map, _, frame) => {
    const sharp = window.devicePixelRatio || 1, wide = Math.round(frame.width * sharp), high = Math.round(frame.height * sharp);
    const made = new OffscreenCanvas(wide, high), own = made.getContext("2d"), image = own.createImageData(wide, high);
    const pixels = new Uint32Array(image.data.buffer), dot = Math.max(1, Math.round(1.5 * sharp));
    for (const { member, x, y } of blocks) {
      for (let i = 0; i < member.length; i++) {
        if (x[i] === null || y[i] === null) continue;
        const u = Math.round((map.x(x[i]) - frame.left) * sharp), v = Math.round((map.y(y[i]) - frame.top) * sharp);
        if (!(u >= 0 && v >= 0 && u + dot <= wide && v + dot <= high)) continue;
        for (let b = 0; b < dot; b++) for (let a = 0; a < dot; a++) pixels[(v + b) * wide + u + a] = colours[member[i]];
      }
    }
    own.putImageData(image, 0, 0);
    pen.drawImage(made, frame.left, frame.top, frame.width, frame.height);
  };
}

export class Section {
  #plane = new Plane(find("canvas"));
  #picked; // ({name: value}): the start of a member
  #problem = null;
  #blocks = [];
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
    this.#blocks = [];
    find("figure").hidden = find("#one").hidden = true;
  }

  /** The first of the schemes asked for that can go in lanes, else one of the problem that keeps its structure. */
  #schemeOf(schemes, cards) {
    const fits = ({ id }) => cards.some((card) => card.id === id && !card.implicit && !card.own_clock);
    const keeps = cards.filter(({ id, structure, symmetric }) => this.#problem.schemes.includes(id) && structure !== "none" && symmetric);
    return schemes.find(fits) ?? keeps.map(({ id }) => ({ id })).find(fits) ?? schemes[0];
  }

  /**
   * Asks for the members of a `scene`, with one of the `schemes` that are shown where that can be; `told(text)` hears how many
   * points there are. `{faults}` or `{said}`.
   */
  async measure({ scene, schemes }, cards, signal, told) {
    const scheme = this.#schemeOf(schemes, cards);
    const { where, direction, period, vary, from, to, count: n, x, y } = this.chosen();
    const section = period ? { period, phase: 0 } : { expression: where ?? "", direction };
    this.clear();
    this.#asked = { vary, from, to, n, x, y };
    let points = 0, ended = null;
    const request = { ...scene, scheme, section, columns: [...new Set([x, y])], keep: ["section"],
                      members: { vary: { [`/initial/${vary}`]: { grid: [from, to, n] } } } };
    const { faults } = await api.ensemble(request, signal, (line) => {
      if (line.kind === "end") ended = line;
      if (line.kind !== "block") return;
      this.#blocks.push({ member: line.section.member, x: line.section[x], y: line.section[y] });
      points += line.section.member.length;
      told(`${count(points)} points…`);
      this.draw();
    });
    if (faults) return { faults };
    const stopped = Object.entries(ended.stopped).map(([reason, some]) => `${count(some)} stopped (${words(reason)})`);
    const notes = [...stopped, ...ended.warnings.map(({ detail, code }) => detail || code)];
    return { said: [`${count(points)} points of ${count(ended.completed)} runs with ${words(scheme.id)}.`, ...notes].join(" ") };
  }

  draw() {
    const full = this.#blocks.filter(({ member }) => member.length), { n, x, y } = this.#asked ?? {};
    find("figure").hidden = find("#one").hidden = !full.length;
    if (!full.length) return;
    find("#member").max = n - 1;
    const box = (axis) => {
      const ends = full.map((block) => extent(block[axis]));
      return [Math.min(...ends.map(([low]) => low)), Math.max(...ends.map(([, high]) => high))];
    };
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    this.#plane.show({ curves: [], view: { x: box("x"), y: box("y"), free: true }, labels: [x, y],
                       backdrop: paint(full, hues(n, dark ? 0.64 : 0.5)), pick: (left, top) => this.#take(left, top) });
  }

  /** The member of the point nearest to a place. */
  #take(left, top) {
    const { map } = this.#plane;
    let nearest = reach ** 2, found = null;
    for (const { member, x, y } of this.#blocks) {
      for (let i = 0; i < member.length; i++) {
        const d = (map.x(x[i]) - left) ** 2 + (map.y(y[i]) - top) ** 2;
        if (d < nearest) [nearest, found] = [d, member[i]];
      }
    }
    if (found !== null) this.#run(found);
  }

  #run(member) {
    const { vary, from, to, n } = this.#asked;
    if (!(member >= 0 && member < n)) return;
    find("#member").value = String(member);
    this.#picked({ [vary]: n > 1 ? from + ((to - from) * member) / (n - 1) : from });
  }
}
