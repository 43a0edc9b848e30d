// A curve in the plane on a canvas: equal scales on both axes, marks, sharp on any display.
import { multiples, roundStep, tickLabel } from "./numbers.js";

const margin = { left: 52, right: 14, top: 12, bottom: 40 };

/** The box `{x: [low, high], y: [low, high]}` around a curve `{x, y}`. */
export function box({ x, y }) {
  const around = (values) => values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
  return { x: around(x), y: around(y) };
}

/** One view for all boxes: their union, but a run that flees does not shrink the others beyond half. */
export function commonView(boxes) {
  if (!boxes.length) return null;
  const size = (b) => Math.max(b.x[1] - b.x[0], b.y[1] - b.y[0]);
  const smallest = boxes.reduce((a, b) => (size(b) < size(a) ? b : a));
  const room = size(smallest) / 2 || Infinity;
  const axis = (k) => [
    Math.max(Math.min(...boxes.map((b) => b[k][0])), smallest[k][0] - room),
    Math.min(Math.max(...boxes.map((b) => b[k][1])), smallest[k][1] + room),
  ];
  return { x: axis("x"), y: axis("y") };
}

/** A drawing area on `canvas`; `show(picture)` draws, and again whenever the canvas changes its size. */
export class Plane {
  #canvas;
  #picture = null;

  constructor(canvas) {
    this.#canvas = canvas;
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** `{curve: {x, y}, view, labels: [x, y], colour: name of a CSS variable}`, or null for an empty plane. */
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
    curve(pen, frame, map, this.#picture.curve, colour(this.#picture.colour), colour("--paper"));
  }
}

/** The map from the plane to pixels: one scale, the view in the middle with a little air. */
function mapping(view, frame) {
  const middle = (v) => v[0] / 2 + v[1] / 2;
  const extent = (v) => v[1] - v[0];
  let scale = Math.min(frame.width / extent(view.x), frame.height / extent(view.y)) / 1.08;
  if (!Number.isFinite(scale)) scale = frame.height / 2;
  const centre = { x: middle(view.x), y: middle(view.y) };
  return {
    scale,
    x: (v) => frame.left + frame.width / 2 + (v - centre.x) * scale,
    y: (v) => frame.top + frame.height / 2 - (v - centre.y) * scale,
    low: { x: centre.x - frame.width / 2 / scale, y: centre.y - frame.height / 2 / scale },
    high: { x: centre.x + frame.width / 2 / scale, y: centre.y + frame.height / 2 / scale },
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
  pen.lineWidth = 1;
  pen.font = `13px ${font}`;
  pen.fillStyle = colour("--soft-ink");
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const v of multiples(map.low.x, map.high.x, step)) {
    line(map.x(v), frame.top, map.x(v), bottom, v === 0 ? "--axis" : "--grid");
    pen.fillText(tickLabel(v, step), map.x(v), bottom + 6);
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

function curve(pen, frame, map, { x, y }, colour, paper) {
  // What lies far outside is pulled to where clipping still sees the right direction: a canvas cannot draw at 1e300.
  const far = (pixel) => Math.max(-1e6, Math.min(1e6, pixel));
  pen.save();
  pen.beginPath();
  pen.rect(frame.left, frame.top, frame.width, frame.height);
  pen.clip();
  pen.strokeStyle = colour;
  pen.lineWidth = 1.6;
  pen.lineJoin = "round";
  pen.beginPath();
  for (let i = 0; i < x.length; i++) pen.lineTo(far(map.x(x[i])), far(map.y(y[i])));
  pen.stroke();
  const last = x.length - 1;
  mark(pen, far(map.x(x[last])), far(map.y(y[last])), colour, colour);
  mark(pen, far(map.x(x[0])), far(map.y(y[0])), paper, colour);
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
