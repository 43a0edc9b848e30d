// Curves in space, in a box or about a ball: turned by two angles, seen from far away.
import { text } from "../language/texts.js";
import { format } from "../forms/numbers.js";
import { extent } from "./mapping.js";
import { stroke } from "./strokes.js";

export const begin = { around: -0.65, up: 0.35 }; // the angles of a picture that nobody has turned yet

/** The angles after a hand has moved so many pixels. */
export const turnedBy = ({ around, up }, right, down) =>
  ({ around: around + right / 120, up: Math.max(-1.57, Math.min(1.57, up + down / 120)) });

/** The view from far away under two angles: a point in space to one of the plane. */
export const projection = ({ around, up }) => {
  const [c, s, u, v] = [Math.cos(around), Math.sin(around), Math.cos(up), Math.sin(up)];
  return (x, y, z) => [c * x - s * y, v * (s * x + c * y) + u * z];
};

function ringsOf(seen) {
  const circle = (of) => {
    const points = Array.from({ length: 61 }, (_, i) => seen(...of((i / 60) * 2 * Math.PI)));
    return { x: points.map(([a]) => a), y: points.map(([, b]) => b) };
  };
  const rings = [-0.7, 0, 0.7].map((level) => {
    const r = Math.sqrt(1 - level * level);
    return circle((w) => [r * Math.cos(w), r * Math.sin(w), level]);
  });
  const meridians = [0, 1, 2].map((i) => circle((w) => {
    const a = (i * Math.PI) / 3;
    return [Math.sin(w) * Math.cos(a), Math.sin(w) * Math.sin(a), Math.cos(w)];
  }));
  return [...rings, ...meridians];
}

/**
 * The box around the columns `names` of all runs: `[{middle, half, scale}]`, of one scale where they are `equal`, unless little
 * would be seen then, with the `reach` of the farthest point from its middle.
 */
export function boxOf(names, runs, equal = true) {
  const box = names.map((name) => {
    const ends = runs.map(({ trajectory }) => extent(trajectory[name]));
    const low = Math.min(...ends.map(([least]) => least)), high = Math.max(...ends.map(([, most]) => most));
    return { middle: low / 2 + high / 2, half: high / 2 - low / 2 };
  });
  const most = Math.max(...box.map(({ half }) => half)) || 1, least = Math.min(...box.map(({ half }) => half || most));
  const scaled = box.map(({ middle, half }) => ({ middle, half, scale: 1 / (equal && most < 10 * least ? most : half || 1) }));
  let reach = 0;
  for (const { trajectory } of runs) {
    const [a, b, c] = names.map((name) => trajectory[name]), [p, q, r] = scaled;
    for (let i = 0; i < a.length; i++) {
      if (a[i] === null || b[i] === null || c[i] === null) continue;
      const [u, v, w] = [(a[i] - p.middle) * p.scale, (b[i] - q.middle) * q.scale, (c[i] - r.middle) * r.scale];
      reach = Math.max(reach, u * u + v * v + w * w);
    }
  }
  return Object.assign(scaled, { reach: Math.sqrt(reach) });
}

/** The edges of a box with its ends in numbers. */
function edges(names, box, seen) {
  const arms = box.map((_, k) => {
    const end = (sign, place) => seen(...box.map(({ half, scale }, i) => (i === k ? place : -1) * sign * half * scale));
    return { name: names[k], low: end(1, -1), high: end(1, 1), from: box[k].middle - box[k].half, to: box[k].middle + box[k].half };
  });
  return (pen, map, colour, frame) => {
    const within = (v, low, high, air) => Math.max(low + air, Math.min(high - air, v));
    const said = [], width = 4, height = 16; // half of a letter's, and a line's
    const covers = (one) => (other) => Math.abs(one.x - other.x) < width * (one.what.length + other.what.length) && Math.abs(one.y - other.y) < height;
    const say = (what, x, y, wanted = true) => {
      const one = { what, x: within(map.x(x), frame.left, frame.left + frame.width, 5 * what.length + 6), y: within(map.y(y), frame.top, frame.top + frame.height, 20) };
      if (!wanted && said.some(covers(one))) return;
      said.push(one);
      pen.fillText(what, one.x, one.y);
    };
    const long = arms.filter(({ low: [a, b], high: [c, d] }) => Math.hypot(map.x(c) - map.x(a), map.y(d) - map.y(b)) >= 90); // others have room for an end alone
    pen.textAlign = "center";
    for (const arm of arms) {
      const { name, low: [a, b], high: [c, d], to } = arm, short = !long.includes(arm);
      stroke(pen, map, { x: [a, c], y: [b, d] }, colour("--axis"), 1);
      pen.fillStyle = colour("--soft-ink");
      say(short ? `${name} = ${format(to, 3)}` : format(to, 3), c, d);
      pen.fillStyle = colour("--ink");
      if (!short) say(name, (a + c) / 2, (b + d) / 2);
    }
    pen.fillStyle = colour("--soft-ink"); // the low ends lie near one corner: of those that cover each other the first is told
    for (const { low: [a, b], high: [c, d], from } of long) say(format(from, 3), 0.84 * a + 0.16 * c, 0.84 * b + 0.16 * d, false);
  };
}

function globe(names, seen) {
  const rings = ringsOf(seen), arms = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((arm) => seen(...arm.map((v) => v * 1.2)));
  return (pen, map, colour) => {
    for (const ring of rings) stroke(pen, map, ring, colour("--axis"), 0.7);
    arms.forEach(([a, b], i) => {
      stroke(pen, map, { x: [0, a], y: [0, b] }, colour("--soft-ink"), 1);
      pen.fillStyle = colour("--ink");
      pen.fillText(names[i], map.x(a), map.y(b));
    });
  };
}

/**
 * The picture of the columns `names` of runs `[{title, colour, trajectory}]`, about a `ball` of that radius, else in a `box`;
 * `labels` for the names.
 */
export function inSpace(names, runs, angles, { ball, box = ball ? null : boxOf(names, runs), labels = names } = {}) {
  const seen = projection(angles);
  const whole = ball ? names.map(() => ({ middle: 0, scale: 1 / ball })) : box;
  const curves = runs.map(({ trajectory, ...run }) => {
    const columns = names.map((name) => trajectory[name]), x = [], y = [];
    trajectory.t.forEach((_, i) => {
      const there = columns.every((column) => column[i] !== null);
      const [a, b] = there ? seen(...columns.map((column, k) => (column[i] - whole[k].middle) * whole[k].scale)) : [null, null];
      x.push(a);
      y.push(b);
    });
    return { ...run, t: trajectory.t, x, y };
  });
  const size = ball ? 1.2 : 1.05 * box.reach || 1;
  return { curves, view: { x: [-size, size], y: [-size, size], free: false }, labels: [text("picture.turn"), ""],
           backdrop: ball ? globe(labels, seen) : edges(labels, box, seen), bare: true };
}
