// A lesson of many runs at once: their points on a plane, their points at the times of a clock, or their ends.
import { named, text } from "../language/texts.js";
import { ensemble } from "../service/api.js";
import { element, faultText, words } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { brightness, Crossings, hues } from "../drawing/crossings.js";
import { EndsPicture, rectangleOf } from "../drawing/ends.js";

/**
 * The requests of a portrait. Starts on the surface of an energy form no grid, so each has a request. They lie in the plane
 * x = 0 of Hénon and Heiles, on the axes of y and of its momentum.
 */
function each({ surface, ...request }) {
  if (!surface) return [request];
  const { energy, starts } = surface, height = (y) => (y * y) / 2 - (y * y * y) / 3;
  const reach = (side) => { // where the motion turns on the axis of y
    let [near, far] = [0, side];
    for (let i = 0; i < 50; i++) [near, far] = height((near + far) / 2) < energy ? [(near + far) / 2, far] : [near, (near + far) / 2];
    return near;
  };
  const [left, right, fastest] = [reach(-0.5), reach(1), Math.sqrt(2 * energy)];
  const places = Array.from({ length: starts }, (_, i) => (i + 0.5) / starts);
  return [...places.map((part) => [left + (right - left) * part, 0]), ...places.map((part) => [0, fastest * part])].map(([y, py]) => ({
    ...request, initial: { x: 0, y, px: Math.sqrt(2 * (energy - height(y)) - py * py), py }, members: { count: 1 } }));
}

/**
 * A smaller request for a quick picture: an eighth of the span, half the starts on a surface; for ends, some eighty starts a side
 * among those of the whole request.
 */
function coarsened({ until, keep, members, surface, ...request }) {
  if (surface) return { ...request, keep, until: { t: until.t / 8 }, surface: { ...surface, starts: surface.starts / 2 } };
  if (!keep.includes("final")) return { ...request, keep, members, until: { t: until.t / 8 } };
  const fewer = (n) => {
    for (let k = Math.floor(n / 64); k > 1; k--) if ((n - 1) % k === 0) return (n - 1) / k + 1;
    return n;
  };
  const grids = Object.entries(members.vary).map(([name, { grid: [from, to, n] }]) => [name, { grid: [from, to, fewer(n)] }]);
  return { ...request, keep, until, members: { vary: Object.fromEntries(grids) } };
}

export class Portrait {
  #crossings; // or null: of the ends
  #ends;
  #said = element("p", { className: "note" });
  #key = element("p", { className: "note key" });
  #names; // of the colours
  #labels;
  outcome = null; // the points: `{member, x, y}`, or `{ends}`

  constructor(figures, { labels, key }, ends) {
    this.#labels = labels.map((name) => named("term", name));
    this.#names = key.map((name) => named("term", name));
    const canvas = element("canvas", { className: "plane", role: "img", ariaLabel: text("lesson.of_many", { x: this.#labels[0], y: this.#labels[1] }) });
    figures.replaceChildren(element("figure", { className: "of-all" }, canvas, this.#key, this.#said));
    this.#crossings = ends ? null : new Crossings(canvas);
    this.#ends = ends ? new EndsPicture(canvas) : null;
    this.#tell();
  }

  /** Shows the key of the colours: from the first start to the last, or over the range of the ends so far. */
  #tell() {
    const [first, last] = this.#names, [low, high] = this.#ends?.ends?.range ?? [];
    const ends = this.#ends ? (Number.isFinite(low) ? [`${first} ${format(low)}`, format(high)] : ["", ""]) : [first, last];
    const colours = hues(24, brightness()), css = [...colours].map((c) => `rgb(${c & 255} ${(c >> 8) & 255} ${(c >> 16) & 255})`);
    const scale = element("span", { className: "hues" });
    scale.style.background = `linear-gradient(to right, ${css.join(", ")})`;
    this.#key.replaceChildren(...(ends[0] ? [ends[0], scale, ends[1]] : []));
  }

  /**
   * Runs all members; rejects when it was stopped. `seen()` is called when every request has brought some points. For ends a coarse
   * picture comes first, over which the fine one appears; while a hand `moves`, there is only the coarse one.
   */
  async run(asked, signal, seen, moves = false) {
    if (this.#ends || moves) await this.#follow(coarsened(asked), signal, seen);
    if (!moves) await this.#follow(asked, signal, this.#ends ? null : seen);
    const all = (name) => this.#crossings.blocks.flatMap((block) => block[name]);
    this.outcome = this.#ends ? { ends: [...(this.#ends.ends?.values ?? [])] } : { member: all("member"), x: all("x"), y: all("y") };
  }

  /** Runs the members of a request, which are drawn as they come; without `seen` they are drawn over the present picture. */
  async #follow(asked, signal, seen) {
    const requests = each(asked), begun = new Set();
    let cut = "", wrong = "";
    const follow = async (first) => { // two at a time
      for (let i = first; i < requests.length && !wrong; i += 2) {
        const request = requests[i];
        const { faults = [] } = await ensemble(request, signal, (line) => {
          if (line.stop) cut = text("ended.early", { why: words(line.stop.reason) });
          if (line.kind !== "block") return;
          if (!begun.size) this.#begin(asked, requests.length, !seen); // until then the last picture stays
          if (requests.length > 1) line.section.member.fill(i);
          if (this.#ends) this.#ends.add(line, request.columns[0]);
          else this.#crossings.add(line);
          if (begun.size < begun.add(i).size && begun.size === requests.length) seen?.();
        });
        wrong ||= faults.map(faultText)[0] ?? "";
        this.#said.textContent = wrong || cut;
      }
    };
    await Promise.all([follow(0), follow(1)]);
    this.#tell();
  }

  #begin(request, several, over) {
    const { columns: [x, y], members } = request;
    if (this.#ends) this.#ends.start({ ...rectangleOf(request), labels: this.#labels }, over);
    else this.#crossings.start(members ? Object.values(members.vary)[0].grid[2] : several, x, y, this.#labels);
  }

  /** The runs that a workbench begins with. */
  requests(asked) {
    const { problem, initial, until, scheme, ...request } = each(asked)[0];
    return [{ problem, initial, until, scheme, ...(this.#ends ? { basins: rectangleOf(request) } : {}) }];
  }

  draw() {
    this.#tell();
    (this.#ends ?? this.#crossings).draw();
  }
}
