// A picture of the points where many runs cross a plane: in a colour for each member, and a million at once.
import { extent } from "./mapping.js";
import { Plane } from "./plane.js";

const reach = 12; // pixels from which a point is taken

/** The colours of members, from red over green to violet, as a canvas holds them in memory. */
export function hues(n, bright) {
  return Uint32Array.from({ length: n }, (_, i) => {
    const channel = (shift) => {
      const k = (shift + (i / Math.max(n - 1, 1)) * 9.6) % 12;
      return Math.round(255 * (bright - 0.35 * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
    };
    return 0xff000000 | (channel(4) << 16) | (channel(8) << 8) | channel(0);
  });
}

/** How bright the colours of members are on the paper, light or dark. */
export const brightness = () => (matchMedia("(prefers-color-scheme: dark)").matches ? 0.64 : 0.5);

/** Paints blocks `{member, x, y}` of points into the frame of a picture: in memory. */
export function paint(blocks, colours) {
  return (pen, map, _, frame) => {
    const sharp = window.devicePixelRatio || 1, wide = Math.round(frame.width * sharp), high = Math.round(frame.height * sharp);
    const made = new OffscreenCanvas(wide, high), own = made.getContext("2d"), image = own.createImageData(wide, high);
    const few = blocks.reduce((sum, { member }) => sum + member.length, 0) < 5000; // which would not be seen as fine dots
    const pixels = new Uint32Array(image.data.buffer), dot = Math.round((few ? 3 : 1.5) * sharp);
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

export class Crossings {
  #plane;
  #taken; // (member) of the point that a hand clicks
  #asked = null;
  #due = 0;
  blocks = [];

  constructor(canvas, taken = () => {}) {
    this.#plane = new Plane(canvas);
    this.#taken = taken;
  }

  /** Forgets all and awaits points of `n` members in the columns `x` and `y`, under `labels`. */
  start(n, x, y, labels = [x, y]) {
    this.blocks = [];
    this.#asked = { n, x, y, labels };
    this.draw();
  }

  /** Adds the points in a line of the service, to be drawn in the next frame; returns how many points there are. */
  add({ section }) {
    if (!this.#asked.x) return 0; // of an answer that nobody awaits any more
    this.blocks.push({ member: section.member, x: section[this.#asked.x], y: section[this.#asked.y] });
    this.#due ||= requestAnimationFrame(() => this.draw());
    return this.blocks.reduce((sum, { member }) => sum + member.length, 0);
  }

  draw() {
    this.#due = 0;
    const full = this.blocks.filter(({ member }) => member.length);
    if (!full.length) return this.#plane.show(null);
    const box = (axis) => {
      const ends = full.map((block) => extent(block[axis]));
      return [Math.min(...ends.map(([low]) => low)), Math.max(...ends.map(([, high]) => high))];
    };
    const { n, labels } = this.#asked;
    this.#plane.show({ curves: [], view: { x: box("x"), y: box("y"), free: true }, labels,
                       backdrop: paint(full, hues(n, brightness())), pick: (left, top) => this.#take(left, top) });
  }

  /** The member of the point nearest to a place. */
  #take(left, top) {
    const { map } = this.#plane;
    let nearest = reach ** 2, found = null;
    for (const { member, x, y } of this.blocks) {
      for (let i = 0; i < member.length; i++) {
        const d = (map.x(x[i]) - left) ** 2 + (map.y(y[i]) - top) ** 2;
        if (d < nearest) [nearest, found] = [d, member[i]];
      }
    }
    if (found !== null) this.#taken(found);
  }
}
