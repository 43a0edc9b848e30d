// A picture of where many runs end: a pixel for each start, coloured by its end, block by block as they come.
import { hues } from "./crossings.js";
import { Plane } from "./plane.js";

const shades = 256, stopped = 0xff808080; // opaque grey, as a canvas holds it in memory

/** The rectangle of starts that a request is of. */
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
