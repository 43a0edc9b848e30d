// A curve in the plane on a canvas: equal scales on both axes unless one is the time, marks, sharp on any display.
import { multiples, roundStep, tickLabel } from "./numbers.js";

const margin = { left: 52, right: 14, top: 12, bottom: 40 };

/**
 * The curve `{x, y, stretched}` of a trajectory over two of its columns, null in both where either is; null: nothing to
 * draw. `stretched(i)`: whether the curve comes to its point i by the Jacobi–Maupertuis principle.
 */
export function curveOf(trajectory, x, y) {
  const beside = (column, other) => trajectory[column].map((v, i) => (trajectory[other][i] === null ? null : v));
  const stretched = (i) => trajectory.mode?.[i] === "jacobi_maupertuis";
  const curve = { x: beside(x, y), y: beside(y, x), stretched };
  return curve.x.some((v) => v !== null) ? curve : null;
}

/**
 * One view `{x: [low, high], y: [low, high], free}` for all curves: the box around them, but a run that flees does not
 * shrink the others beyond half. All of the time is seen on the axes that are `timed`, and the scales are then `free`:
 * a time has no length to compare with.
 */
export function commonView(curves, timed = []) {
  if (!curves.length) return null;
  const boxes = curves.map(({ x, y }) => ({ x: around(x), y: around(y) }));
  const lengths = ["x", "y"].filter((axis) => !timed.includes(axis));
  const size = (b) => Math.max(0, ...lengths.map((k) => b[k][1] - b[k][0]));
  const smallest = boxes.reduce((a, b) => (size(b) < size(a) ? b : a));
  const axis = (k) => {
    const room = timed.includes(k) ? Infinity : size(smallest) / 2 || Infinity;
    return [Math.max(Math.min(...boxes.map((b) => b[k][0])), smallest[k][0] - room),
            Math.min(Math.max(...boxes.map((b) => b[k][1])), smallest[k][1] + room)];
  };
  return { x: axis("x"), y: axis("y"), free: timed.length > 0 };
}

const around = (values) =>
  values.reduce(([a, b], v) => (v === null ? [a, b] : [Math.min(a, v), Math.max(b, v)]), [Infinity, -Infinity]);

/** A drawing area on `canvas`; `show(picture)` draws, and again whenever the canvas changes its size. */
export class Plane {
  #canvas;
  #picture = null;

  constructor(canvas) {
    this.#canvas = canvas;
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** `{curve: {x, y, stretched}, view, labels: [x, y], colour: name of a CSS variable}`, or null for an empty plane. */
  show(picture) {
    this.#picture = picture;
    this.draw();
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (!width || !height) return;
    const sharp = window.devicePixelRatio || 1;
    this.#canvas.width = Math.round(width * sharp);
    this.#canvas.height = Math.round(height * sharp);
    const pen = this.#canvas.getContext("2d");
    pen.scale(sharp, sharp);
    if (!this.#picture) return;
    const frame = { left: margin.left, top: margin.top, width: width - margin.left - margin.right,
                    height: height - margin.top - margin.bottom };
    const map = mapping(this.#picture.view, frame);
    const style = getComputedStyle(this.#canvas);
    const colour = (name) => style.getPropertyValue(name).trim();
    axes(pen, frame, map, this.#picture.labels, colour, style.fontFamily);
    trace(pen, frame, map, this.#picture.curve, colour(this.#picture.colour), colour);
  }
}

/** The map from the plane to pixels: one scale unless they are free, the view in the middle with a little air. */
function mapping(view, frame) {
  const middle = (v) => v[0] / 2 + v[1] / 2;
  const fitting = (length, [low, high]) => length / (high - low) / 1.08;
  const usable = (scale) => (Number.isFinite(scale) ? scale : frame.height / 2);
  const fit = { x: fitting(frame.width, view.x), y: fitting(frame.height, view.y) };
  const equal = usable(Math.min(fit.x, fit.y));
  const scale = view.free ? { x: usable(fit.x), y: usable(fit.y) } : { x: equal, y: equal };
  const centre = { x: middle(view.x), y: middle(view.y) };
  const reach = { x: frame.width / 2 / scale.x, y: frame.height / 2 / scale.y };
  return {
    free: view.free,
    x: (v) => frame.left + frame.width / 2 + (v - centre.x) * scale.x,
    y: (v) => frame.top + frame.height / 2 - (v - centre.y) * scale.y,
    low: { x: centre.x - reach.x, y: centre.y - reach.y },
    high: { x: centre.x + reach.x, y: centre.y + reach.y },
  };
}

function axes(pen, frame, map, labels, colour, font) {
  const right = frame.left + frame.width, bottom = frame.top + frame.height;
  const line = (x0, y0, x1, y1, name) => {
    pen.strokeStyle = colour(name);
    pen.beginPath();
    pen.moveTo(Math.round(x0) + 0.5, Math.round(y0) + 0.5);
    pen.lineTo(Math.round(x1) + 0.5, Math.round(y1) + 0.5);
    pen.stroke();
  };
  const step = roundStep(map.low.y, map.high.y, frame.height / 55);
  const across = map.free ? roundStep(map.low.x, map.high.x, frame.width / 70) : step;
  pen.lineWidth = 1;
  pen.font = `13px ${font}`;
  pen.fillStyle = colour("--soft-ink");
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const v of multiples(map.low.x, map.high.x, across)) {
    line(map.x(v), frame.top, map.x(v), bottom, v === 0 ? "--axis" : "--grid");
    pen.fillText(tickLabel(v, across), map.x(v), bottom + 6);
  }
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const v of multiples(map.low.y, map.high.y, step)) {
    line(frame.left, map.y(v), right, map.y(v), v === 0 ? "--axis" : "--grid");
    pen.fillText(tickLabel(v, step), frame.left - 7, map.y(v));
  }
  pen.strokeStyle = colour("--axis");
  pen.strokeRect(frame.left + 0.5, frame.top + 0.5, frame.width - 1, frame.height - 1);
  pen.fillStyle = colour("--ink");
  pen.font = `italic 16px ${font}`;
  pen.textAlign = "center";
  pen.fillText(labels[0], frame.left + frame.width / 2, bottom + 29);
  pen.save();
  pen.translate(12, frame.top + frame.height / 2);
  pen.rotate(-Math.PI / 2);
  pen.fillText(labels[1], 0, 0);
  pen.restore();
}

function trace(pen, frame, map, { x, y, stretched }, ink, colour) {
  // What lies far outside is pulled to where clipping still sees the right direction: a canvas cannot draw at 1e300.
  const far = (pixel) => Math.max(-1e6, Math.min(1e6, pixel));
  pen.save();
  pen.beginPath();
  pen.rect(frame.left, frame.top, frame.width, frame.height);
  pen.clip();
  pen.lineJoin = "round";
  const there = (v) => v !== null;
  /** The lines to those points that `drawn` says. */
  const stroke = (style, width, drawn) => {
    pen.strokeStyle = style;
    pen.lineWidth = width;
    pen.beginPath();
    let at = -1; // where the pen is
    for (let i = 1; i < x.length; i++) {
      if (!there(x[i]) || !there(x[i - 1]) || !drawn(i)) continue; // a gap
      if (at !== i - 1) pen.moveTo(far(map.x(x[i - 1])), far(map.y(y[i - 1])));
      pen.lineTo(far(map.x(x[i])), far(map.y(y[i])));
      at = i;
    }
    pen.stroke();
  };
  stroke(colour("--stretch"), 7, stretched);
  stroke(ink, 1.6, () => true);
  const first = x.findIndex(there), last = x.findLastIndex(there);
  mark(pen, far(map.x(x[last])), far(map.y(y[last])), ink, ink);
  mark(pen, far(map.x(x[first])), far(map.y(y[first])), colour("--paper"), ink);
  pen.restore();
}

function mark(pen, x, y, fill, stroke) {
  pen.beginPath();
  pen.arc(x, y, 5, 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.fill();
  pen.strokeStyle = stroke;
  pen.lineWidth = 2.2;
  pen.stroke();
}
