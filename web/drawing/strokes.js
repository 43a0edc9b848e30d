// The parts of a picture on a canvas: its frame with ticks, curves, marks.
import { format, multiples, powerOfTen, roundStep, tickLabel } from "../forms/numbers.js";
import { indexAt, valueAt } from "./mapping.js";
import { Straight } from "./straight.js";

const there = (v) => v !== null;
// Moves points far outside to where clipping still has the right direction, because a canvas cannot draw at 1e300.
const far = (pixel) => Math.max(-1e6, Math.min(1e6, pixel));

/** The marks of an axis: where, and what they say. */
function ticks(low, high, n, log) {
  const round = roundStep(low, high, n), fine = multiples(low, high, round).length > 1 ? round : roundStep(low, high, 2 * n);
  const step = log && high - low > 1.5 ? Math.ceil((high - low) / Math.max(n, 1)) : fine; // one mark is no scale
  const label = (v) => (!log ? tickLabel(v, step) : Number.isInteger(v) ? powerOfTen(v) : format(10 ** v, 2));
  return multiples(low, high, step).map((v) => [v, label(v)]);
}

const downTicks = (frame, map, { log = "" }, size) => ticks(map.low.y, map.high.y, frame.height / (3.3 * size), log.includes("y"));

/** The room that the labels of the vertical axis take. */
export function roomFor(pen, frame, map, picture, { font, size }) {
  pen.font = `${size}px ${font}`;
  const widest = picture.bare ? 0 : Math.max(0, ...downTicks(frame, map, picture, size).map(([, text]) => pen.measureText(text).width));
  return Math.ceil(widest + 2 * size + 8);
}

export function axes(pen, frame, map, { labels, log = "", bare = false }, { colour, font, size }) {
  const right = frame.left + frame.width, bottom = frame.top + frame.height;
  const line = (x0, y0, x1, y1, name) => {
    pen.strokeStyle = colour(name);
    pen.beginPath();
    pen.moveTo(Math.round(x0) + 0.5, Math.round(y0) + 0.5);
    pen.lineTo(Math.round(x1) + 0.5, Math.round(y1) + 0.5);
    pen.stroke();
  };
  const down = bare ? [] : downTicks(frame, map, { log }, size);
  // With equal scales both axes have the marks of the one.
  const across = bare ? [] : ticks(map.low.x, map.high.x,
                       map.free ? frame.width / (5.4 * size)
                                : Math.min(frame.width / (3.5 * size), (frame.height / (3.3 * size)) * (frame.width / frame.height)),
                       log.includes("x"));
  pen.lineWidth = 1;
  pen.font = `${size}px ${font}`;
  pen.fillStyle = colour("--soft-ink");
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const [v, text] of across) {
    line(map.x(v), frame.top, map.x(v), bottom, v === 0 && !log ? "--axis" : "--grid");
    pen.fillText(text, map.x(v), bottom + 6);
  }
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const [v, text] of down) {
    line(frame.left, map.y(v), right, map.y(v), v === 0 && !log ? "--axis" : "--grid");
    pen.fillText(text, frame.left - 7, map.y(v));
  }
  pen.strokeStyle = colour("--axis");
  pen.strokeRect(frame.left + 0.5, frame.top + 0.5, frame.width - 1, frame.height - 1);
  pen.fillStyle = colour("--ink");
  pen.font = `italic ${size + 3}px ${font}`;
  pen.textAlign = "center";
  pen.fillText(labels[0], frame.left + frame.width / 2, bottom + 2.2 * size);
  pen.save();
  pen.translate(size * 0.9, frame.top + frame.height / 2);
  pen.rotate(-Math.PI / 2);
  pen.fillText(labels[1], 0, 0);
  pen.restore();
}

/** Draws inside a frame only. */
export function inside(pen, frame, draw) {
  pen.save();
  pen.beginPath();
  pen.rect(frame.left, frame.top, frame.width, frame.height);
  pen.clip();
  pen.lineJoin = "round";
  draw();
  pen.restore();
}

/**
 * The lines of a curve from sample to sample, where `wanted(i)` says so of the line that ends at i. What lies on a straight line
 * is passed over; of a series (x ascends), what falls in one column of pixels is the bar from its least to its largest: no peak
 * is lost, however many samples there are. Short paths are stroked much faster than one long path.
 */
export function stroke(pen, map, { x, y, series = false }, style, width, { wanted, from = 1, to = x.length } = {}) {
  pen.strokeStyle = style;
  pen.lineWidth = width;
  const straight = new Straight();
  let drawing = false, length = 0, left = 0, top = 0, low = 0, high = 0, last = 0, along = 0;
  const line = (a, b) => {
    pen.lineTo(a, b);
    if (++length < 500) return;
    pen.stroke();
    pen.beginPath();
    pen.moveTo(a, b);
    length = 0;
  };
  const settle = () => { // what is left of the column of pixels, or of the straight line
    if (series && low < high) {
      line(left, low);
      line(left, high);
    }
    line(series ? left : along, last);
  };
  pen.beginPath();
  for (let i = Math.max(from, 1); i < to; i++) {
    if (!there(x[i]) || !there(x[i - 1]) || (wanted && !wanted(i))) { // a gap
      if (drawing) settle();
      drawing = false;
      continue;
    }
    if (!drawing) {
      left = along = far(map.x(x[i - 1]));
      low = high = last = top = far(map.y(y[i - 1]));
      straight.from(left, top);
      pen.moveTo(left, top);
      drawing = true;
    }
    const a = far(map.x(x[i])), b = far(map.y(y[i]));
    if (!series) {
      if (straight.turns(a, b)) {
        line(along, last);
        straight.from(along, last);
        straight.turns(a, b);
      }
    } else if (a - left >= 0.5 || a < left) {
      settle();
      line(a, b);
      left = a;
      low = high = b;
    } else {
      [low, high] = [Math.min(low, b), Math.max(high, b)];
    }
    along = a;
    last = b;
  }
  if (drawing) settle();
  pen.stroke();
}

export function mark(pen, map, x, y, fill, ring, radius = 5) {
  pen.beginPath();
  pen.arc(far(map.x(x)), far(map.y(y)), radius, 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.fill();
  pen.strokeStyle = ring;
  pen.lineWidth = 2.2;
  pen.stroke();
}

/** Where events lie on a curve: diamonds, one where several would cover each other. */
function happened(pen, map, { t, x, y, events = [] }, ink, paper) {
  const seen = new Set();
  for (const when of events) {
    const u = valueAt(t, x, when), v = valueAt(t, y, when);
    if (!there(u) || !there(v)) continue;
    const a = far(map.x(u)), b = far(map.y(v)), key = `${Math.round(a / 4)},${Math.round(b / 4)}`;
    if (seen.has(key)) continue;
    seen.add(key);
    pen.beginPath();
    [[0, -5], [5, 0], [0, 5], [-5, 0], [0, -5]].forEach(([right, down], i) =>
      (i ? pen.lineTo(a + right, b + down) : pen.moveTo(a + right, b + down)));
    pen.fillStyle = paper;
    pen.fill();
    pen.strokeStyle = ink;
    pen.lineWidth = 1.6;
    pen.stroke();
  }
}

/** A chain as it is at a time: its links, and a disc for each place. */
function links(pen, map, { x, y }, ink, fill, width) {
  stroke(pen, map, { x, y }, ink, width);
  x.forEach((v, i) => there(y[i]) && mark(pen, map, v, y[i], fill, ink, x.length > 40 ? 1.5 : 4));
}

/** A curve of a run with its stretches, its events, its start (a ring) and its end (a disc). */
export function trace(pen, map, curve, colour, { width, faint = false }) {
  if (curve.shape) {
    const from = curve.t[0], to = curve.t.at(-1);
    if (!faint) links(pen, map, curve.shape(to), colour(curve.colour), colour(curve.colour), width);
    return links(pen, map, curve.shape(from), colour(curve.colour), colour("--paper"), 0.5 * width);
  }
  const { x, y } = curve, ink = colour(curve.colour);
  pen.setLineDash(curve.dash ?? []);
  pen.globalAlpha = faint ? 0.3 : 1;
  if (curve.stretched) stroke(pen, map, curve, colour("--stretch"), 4.5 * width, { wanted: curve.stretched });
  stroke(pen, map, curve, ink, curve.thin ? 0.5 * width : width, { wanted: curve.joined });
  pen.setLineDash([]);
  pen.globalAlpha = 1;
  if (curve.exact || curve.unmarked || faint) return;
  happened(pen, map, curve, ink, colour("--paper"));
  const first = x.findIndex(there), last = x.findLastIndex(there);
  if (!curve.endless) mark(pen, map, x[last], y[last], ink, ink);
  mark(pen, map, x[first], y[first], colour("--paper"), ink);
}

/** Marks the places where a curve leaves the frame by triangles at the edge, at most one in 12 pixels. */
export function clippings(pen, frame, map, { x, y, colour: name }, colour) {
  const right = frame.left + frame.width, bottom = frame.top + frame.height, seen = new Set();
  pen.fillStyle = colour(name);
  for (let i = 1; i < x.length && seen.size < 200; i++) {
    if (!there(x[i]) || !there(x[i - 1])) continue;
    const a = map.x(x[i]), b = map.y(y[i]);
    const [dx, dy] = [a < frame.left ? -1 : a > right ? 1 : 0, b < frame.top ? -1 : b > bottom ? 1 : 0];
    if (!dx && !dy) continue;
    const c = map.x(x[i - 1]), d = map.y(y[i - 1]);
    if (c < frame.left || c > right || d < frame.top || d > bottom) continue;
    const u = Math.min(right, Math.max(frame.left, a)), v = Math.min(bottom, Math.max(frame.top, b));
    const key = `${Math.round(u / 12)},${Math.round(v / 12)}`;
    if (seen.has(key)) continue;
    seen.add(key);
    const [ex, ey] = dx ? [dx, 0] : [0, dy];
    pen.beginPath();
    pen.moveTo(u, v);
    pen.lineTo(u - 9 * ex + 5 * ey, v - 9 * ey + 5 * ex);
    pen.lineTo(u - 9 * ex - 5 * ey, v - 9 * ey - 5 * ex);
    pen.fill();
  }
  return seen.size;
}

/** Draws a run at time t with its recent path; returns its place `{left, top}`, or null where it has none. */
export function head(pen, map, curve, t, colour, { width }) {
  const { t: times, x, y } = curve;
  if (!times || t < Math.min(times[0], times.at(-1))) return null;
  if (curve.shape) return links(pen, map, curve.shape(t), colour(curve.colour), colour(curve.colour), 1.5 * width), null;
  const at = indexAt(times, t), back = indexAt(times, t - (times.at(-1) - times[0]) / 25);
  const u = valueAt(times, x, t), v = valueAt(times, y, t);
  if (!there(u) || !there(v)) return null;
  stroke(pen, map, curve, colour(curve.colour), 2.2 * width, { wanted: curve.joined, from: Math.max(back, at - 2000) + 1, to: at + 1 });
  mark(pen, map, u, v, colour(curve.colour), colour("--paper"), 6.5);
  return { left: map.x(u), top: map.y(v) };
}
