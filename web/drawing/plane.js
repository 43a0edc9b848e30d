// A picture of curves on a canvas, sharp on any display. Above it lies a second canvas for what moves: the heads of the
// runs at a time, and the cross-hair.
import { listed } from "../language/texts.js";
import { format } from "../forms/numbers.js";
import { mapping } from "./mapping.js";
import { follow } from "./pointer.js";
import { axes, clippings, head, inside, roomFor, trace } from "./strokes.js";
import { SvgPen } from "./svg.js";

/** A drawing area on `canvas`; `show(picture)` draws, and again whenever the canvas changes its size. */
export class Plane {
  #canvas;
  #over;
  #picture = null;
  #time = null;
  #told = false;
  #hair = null;
  #map = null;
  #held = null; // the view of a start that is being dragged
  #left = 52;
  zoom = null;

  /** `hovered(t)` hears at which time of a run the cross-hair stands, null where at none. */
  constructor(canvas, hovered = () => {}) {
    this.#canvas = canvas;
    const node = document.createElement("div");
    node.className = "picture";
    canvas.replaceWith(node);
    this.#over = Object.assign(document.createElement("canvas"), { className: "over", ariaHidden: "true" });
    node.append(canvas, this.#over);
    follow(this, node, canvas, hovered);
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  get picture() {
    return this.#picture;
  }

  get map() {
    return this.#map;
  }

  get frame() {
    const { clientWidth: width, clientHeight: height } = this.#canvas, size = this.#size();
    const left = this.#left, top = 12, right = 14;
    return { left, top, width: width - left - right, height: height - top - 3.1 * size };
  }

  /**
   * `{curves: [{t, x, y, colour: a colour or the name of a CSS variable, title, stretched?, exact?, dash?, shape?(t), grab?(x, y,
   * done)}], view, labels: [x, y], log?, backdrop?(pen, map, colour, frame), pick?(left, top)}`, or null for an empty plane. A
   * curve with a `shape` is a chain that moves; with `grab` its start can be dragged; `pick` hears where a hand clicks, `unpick`
   * that it clicked twice.
   */
  show(picture) {
    if (String(picture?.labels) !== String(this.#picture?.labels)) this.zoom = null;
    this.#picture = picture;
    this.draw();
  }

  /** Shows the runs at time t, null: whole; if `told`, with the values at t. */
  at(t, told = false) {
    const began = (this.#time === null) !== (t === null);
    this.#time = t;
    this.#told = told;
    if (began) this.draw();
    else this.#drawOver();
  }

  /** The cross-hair at a place of the canvas, or none. */
  hair(place) {
    this.#hair = place;
    this.#drawOver();
  }

  /** Keeps the view while a start is dragged. */
  hold(held) {
    this.#held = held ? this.#picture.view : null;
  }

  draw() {
    const pen = this.#pen(this.#canvas);
    if (!pen) return;
    this.#map = null;
    if (!this.#picture) return void this.#drawOver();
    const mapped = () => mapping(this.#held ?? this.#picture.view, this.frame, this.zoom);
    this.#left = roomFor(pen, this.frame, mapped(), this.#picture, this.#style());
    this.#map = mapped();
    this.#drawWith(pen);
    this.#drawOver();
  }

  /** The picture as SVG. */
  svg() {
    const pen = new SvgPen(), { clientWidth: width, clientHeight: height } = this.#canvas;
    if (this.#map) this.#drawWith(pen);
    return pen.document(width, height, this.#style().colour("--paper"));
  }

  /** The picture as PNG, each of its pixels as so many `times` as many. */
  png(times) {
    const { clientWidth: width, clientHeight: height } = this.#canvas, canvas = new OffscreenCanvas(times * width, times * height);
    const pen = canvas.getContext("2d");
    pen.scale(times, times);
    pen.fillStyle = this.#style().colour("--paper");
    pen.fillRect(0, 0, width, height);
    if (this.#map) this.#drawWith(pen);
    return canvas.convertToBlob({ type: "image/png" });
  }

  get width() {
    return this.#canvas.width;
  }
  get height() {
    return this.#canvas.height;
  }

  /** Draws what is seen now, the moving parts above the picture, onto another canvas. */
  copyTo(pen, left, top) {
    for (const canvas of [this.#canvas, this.#over]) if (canvas.width && canvas.height) pen.drawImage(canvas, left, top);
  }

  get canvas() {
    return this.#canvas;
  }

  #drawWith(pen) {
    const { curves, backdrop } = this.#picture, frame = this.frame, style = this.#style(), map = this.#map;
    axes(pen, frame, map, this.#picture, style);
    inside(pen, frame, () => {
      backdrop?.(pen, map, style.colour, frame);
      const top = curves.filter(({ exact }) => exact), faint = this.#time !== null;
      for (const curve of [...curves.filter(({ exact }) => !exact).toReversed(), ...top]) {
        trace(pen, map, curve, style.colour, { width: style.width, faint: faint && !curve.exact });
      }
    });
    for (const curve of curves) if (!curve.exact) clippings(pen, frame, map, curve, style.colour);
  }

  #drawOver() {
    const pen = this.#pen(this.#over);
    if (!pen || !this.#map) return;
    const frame = this.frame, map = this.#map, style = this.#style();
    inside(pen, frame, () => {
      for (const curve of this.#time === null ? [] : this.#picture.curves) {
        const at = curve.exact ? null : head(pen, map, curve, this.#time, style.colour, style);
        if (at && this.#told && !this.#hair) this.#say(pen, frame, at, map.at(at.left, at.top), style);
      }
      if (this.#hair) this.#drawHair(pen, frame, map, style);
    });
  }

  #drawHair(pen, frame, map, style) {
    const { left, top } = this.#hair;
    pen.strokeStyle = style.colour("--soft-ink");
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(left + 0.5, frame.top);
    pen.lineTo(left + 0.5, frame.top + frame.height);
    pen.moveTo(frame.left, top + 0.5);
    pen.lineTo(frame.left + frame.width, top + 0.5);
    pen.stroke();
    this.#say(pen, frame, this.#hair, map.at(left, top), style);
  }

  /** The values of a place, beside it. */
  #say(pen, frame, { left, top }, place, { colour, font, size }) {
    const { log = "", bare } = this.#picture;
    if (bare) return; // a place in space has no two values
    const shown = (axis) => format(log.includes(axis) ? 10 ** place[axis] : place[axis], 4);
    const text = `(${listed([shown("x"), shown("y")])})`;
    pen.font = `${size}px ${font}`;
    const width = pen.measureText(text).width + 10, right = left + width + 8 < frame.left + frame.width;
    const x = right ? left + 8 : left - width - 8, y = Math.max(top - size - 14, frame.top + 2);
    pen.fillStyle = colour("--paper");
    pen.fillRect(x, y, width, size + 8);
    pen.fillStyle = colour("--ink");
    pen.textAlign = "left";
    pen.textBaseline = "middle";
    pen.fillText(text, x + 5, y + size / 2 + 4);
  }

  #size() {
    return Math.round(parseFloat(getComputedStyle(this.#canvas).fontSize) * 0.82);
  }

  #style() {
    const style = getComputedStyle(this.#canvas), size = this.#size();
    const colour = (name) => (name.startsWith("--") ? style.getPropertyValue(name).trim() : name);
    return { colour, font: style.fontFamily, size, width: 1.6 * Math.max(1, size / 13) };
  }

  /** An empty canvas in the display's resolution, or null while it has no size. */
  #pen(canvas) {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (!width || !height) return null;
    const sharp = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * sharp);
    canvas.height = Math.round(height * sharp);
    const pen = canvas.getContext("2d");
    pen.scale(sharp, sharp);
    return pen;
  }
}
