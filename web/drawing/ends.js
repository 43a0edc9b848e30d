// A picture of where many runs end: a pixel for each start, coloured by its end, block by block as they come.
import { brightness, hues } from "./crossings.js";
import { Plane } from "./plane.js";

const shades = 256, stopped = 0xff808080; // opaque grey, as a canvas holds it in memory

/** The rectangle of starts of a request. */
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
  known = 0; // of all how many have come, stopped ones too

  constructor(n) {
    this.n = n;
    this.#last = new Float64Array(n * n).fill(NaN);
    this.#state = new Uint8Array(n * n);
  }

  /** Adds the ends in a line of the service. */
  add({ first, members, final }, column) {
    this.#state.fill(2, first, first + members);
    final.index.forEach((member, k) => {
      this.#state[member] = 1;
      this.#last[member] = final[column][k] ?? NaN;
    });
    this.completed += final.index.length;
    this.known += members;
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

  /** The pixels, the highest row first, in colours over a range of ends; unknown ends are transparent. */
  paint(colours, [low, high]) {
    const { n } = this, pixels = new Uint32Array(n * n), scale = high > low ? (shades - 1) / (high - low) : 0;
    for (let member = 0; member < n * n; member++) {
      const state = this.#state[member], at = (n - 1 - (member % n)) * n + Math.floor(member / n), v = this.#last[member];
      if (state) pixels[at] = state === 1 && !Number.isNaN(v) ? colours[Math.round((v - low) * scale)] : stopped;
    }
    return pixels;
  }
}

/** The edges of the pixels of a rectangle of starts, across and up: each pixel is centred at its start. */
function edges({ left, right, low, high, side: n }) {
  const half = (from, to) => (n > 1 ? (to - from) / (n - 1) / 2 : 0.5);
  return [[left, right], [low, high]].map(([from, to]) => [from - half(from, to), to + half(from, to)]);
}

function imageOf(pixels, n) {
  const made = new OffscreenCanvas(n, n);
  made.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(pixels.buffer), n, n), 0, 0);
  return made;
}

/** The picture of the ends on a canvas; `taken(member)` hears which pixel a hand clicks. */
export class EndsPicture {
  #plane;
  #taken;
  #asked = null;
  #below = null; // {asked, ends}: those that are seen until finer ones cover them
  #due = 0;
  ends = null;

  constructor(canvas, taken = () => {}) {
    this.#plane = new Plane(canvas);
    this.#taken = taken;
  }

  /** Awaits `side` × `side` runs from `left` to `right`, `low` to `high`, `over` the present ones; without `asked` none. */
  start(asked = null, over = false) {
    this.#below = over && this.ends ? { asked: this.#asked, ends: this.ends } : null;
    this.#asked = asked;
    this.ends = asked && new Ends(asked.side);
    this.draw();
  }

  /** Adds the ends in that column of a line of the service, to be drawn in the next frame. */
  add(line, column) {
    this.ends.add(line, column);
    if (this.ends.known >= this.ends.n ** 2) this.#below = null;
    this.#due ||= requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.#due = 0;
    if (!this.ends) return this.#plane.show(null);
    const { x, y, left, right, low, high, side: n, labels = [x, y] } = this.#asked, [across, up] = edges(this.#asked);
    const colours = hues(shades, brightness());
    const layers = [...(this.#below ? [this.#below] : []), { asked: this.#asked, ends: this.ends }], ranges = layers.map(({ ends }) => ends.range);
    const range = [Math.min(...ranges.map(([least]) => least)), Math.max(...ranges.map(([, most]) => most))];
    const painted = layers.map(({ asked, ends }) => ({ edges: edges(asked), image: imageOf(ends.paint(colours, range), ends.n) }));
    const backdrop = (pen, map) => {
      pen.imageSmoothingEnabled = false;
      pen.beginPath();
      pen.rect(map.x(across[0]), map.y(up[1]), map.x(across[1]) - map.x(across[0]), map.y(up[0]) - map.y(up[1]));
      pen.clip(); // pixels of a coarse picture are wider
      for (const { edges: [[from, to], [bottom, top]], image } of painted) {
        pen.drawImage(image, map.x(from), map.y(top), map.x(to) - map.x(from), map.y(bottom) - map.y(top));
      }
    };
    const at = (v, from, to) => Math.round(((v - from) / (to - from)) * (n - 1));
    const pick = (there, below) => {
      const place = this.#plane.map.at(there, below), i = at(place.x, left, right), j = at(place.y, low, high);
      if (i >= 0 && i < n && j >= 0 && j < n) this.#taken(i * n + j);
    };
    this.#plane.show({ curves: [], view: { x: across, y: up, free: true }, labels, backdrop, pick });
  }
}
