// Error over cost of many schemes, both on logarithmic axes, with points added as they come. uPlot is the global of
// uPlot.iife.min.js.
import { text } from "../language/texts.js";
import { words } from "../forms/forms.js";
import { decadeLabels, decades, format } from "../forms/numbers.js";

// The palette of Okabe and Ito, then the same with dashes. Black is the front's.
const colours = ["--run-a", "--run-b", "--curve-c", "--curve-d", "--curve-e", "--curve-f", "--curve-g"];
const dashes = [[], [8, 4], [2, 3], [12, 3, 2, 3]], borders = ["solid", "dashed", "dotted", "double"]; // in the legend

const reach = 30; // pixels from which a point is pointed at

/** The points `[cost, error]` whose error is below that of every cheaper point, in the order of cost. */
export function front(points) {
  const best = [];
  for (const point of points.toSorted(([a, e], [b, f]) => a - b || e - f)) {
    if (!(point[1] >= best.at(-1)?.[1])) best.push(point);
  }
  return best;
}

/** The plot in `container`: `start` with the schemes, then `add` points. */
export class PrecisionPlot {
  #container;
  #tip = document.createElement("p");
  #plot = null;
  #titles = [];
  #curves = [];
  #floor = null;
  #cost = "force_evaluations";
  #due = 0;

  constructor(container) {
    this.#container = container;
    Object.assign(this.#tip, { className: "tip", hidden: true });
    new ResizeObserver(() => this.#plot?.setSize(this.#size())).observe(container);
  }

  /** Forgets all and awaits points of these schemes; errors below `floor` mean nothing. */
  start(titles, floor = null) {
    this.#titles = titles;
    this.#curves = titles.map(() => []);
    this.#floor = floor;
    this.draw();
  }

  /** A point `{error, force_evaluations, seconds, …}` of the i-th scheme. A failed or exact one has no place. */
  add(i, point) {
    if (!(point.error > 0) || !(point.seconds > 0) || !(point.force_evaluations > 0)) return;
    this.#curves[i].push(point);
    if (!this.#plot) return this.draw();
    this.#due ||= requestAnimationFrame(() => this.#refresh());
  }

  /** What is on the horizontal axis: "force_evaluations" or "seconds". */
  over(cost) {
    this.#cost = cost;
    this.draw();
  }

  /** Draws anew, also for new colours. */
  draw() {
    this.#plot?.destroy();
    this.#plot = null;
    this.#container.hidden = this.#curves.every((curve) => !curve.length);
    if (!this.#container.hidden) this.#plot = new uPlot(this.#options(), this.#data(), this.#container);
    this.#plot?.over.append(this.#tip);
    this.#plot?.setSize(this.#size()); // now that the legend's height is known
  }

  #refresh() {
    this.#due = 0;
    this.#plot?.setData(this.#data());
  }

  #data() {
    const column = (points) => [points.map(([cost]) => cost), points.map(([, error]) => error)];
    const pairs = this.#curves.map((curve) => curve.map((point) => [point[this.#cost], point.error]));
    const sorted = pairs.map((points) => column(points.toSorted(([a], [b]) => a - b)));
    return uPlot.join([column(front(pairs.flat())), ...sorted]);
  }

  #size() {
    const legend = this.#container.querySelector(".u-legend")?.offsetHeight ?? 0;
    return { width: this.#container.clientWidth, height: Math.max(240, this.#container.clientHeight - legend) };
  }

  #options() {
    const style = getComputedStyle(this.#container), size = Math.round(0.82 * parseFloat(style.fontSize));
    const ink = (name) => () => style.getPropertyValue(name).trim();
    const axis = { stroke: ink("--soft-ink"), grid: { stroke: ink("--grid"), width: 1 }, font: `${size}px ${style.fontFamily}`,
                   ticks: { stroke: ink("--grid"), width: 1 }, splits: (_, __, low, high) => decades(low, high),
                   filter: (_, marks) => marks, values: (_, marks) => decadeLabels(marks), labelSize: 1.7 * size,
                   labelFont: `${size + 1}px ${style.fontFamily}` };
    const round = (i) => Math.floor(i / colours.length) % dashes.length;
    const series = (label, i) => {
      const stroke = ink(colours[i % colours.length]);
      return { label, stroke, dash: dashes[round(i)], width: 0.11 * size, spanGaps: true,
               points: { show: true, size: 0.46 * size, fill: stroke } };
    };
    const best = { label: text("precision.front"), stroke: ink("--line"), width: 9, spanGaps: true, points: { show: false } };
    return {
      ...this.#size(),
      scales: { x: { time: false, distr: 3 }, y: { distr: 3 } },
      axes: [{ ...axis, size: 2.6 * size, label: words(this.#cost) }, { ...axis, size: 4.5 * size, label: text("precision.axis") }],
      series: [{ label: text("precision.cost") }, best, ...this.#titles.map(series)],
      cursor: { points: { show: false }, drag: { setScale: false } },
      legend: { live: false, markers: { width: 3, dash: (_, i) => borders[i < 2 ? 0 : round(i - 2)] } },
      hooks: { setCursor: [() => this.#point()], draw: [() => this.#drawFloor(ink("--fault")())] },
    };
  }

  /** Tells of the point nearest to the cursor. */
  #point() {
    const { left, top } = this.#plot?.cursor ?? { left: -1 };
    let nearest = reach, at = null;
    this.#curves.forEach((curve, i) => {
      if (left < 0 || !this.#plot.series[i + 2].show) return;
      for (const point of curve) {
        const x = this.#plot.valToPos(point[this.#cost], "x"), y = this.#plot.valToPos(point.error, "y");
        const distance = Math.hypot(x - left, y - top);
        if (distance < nearest) [nearest, at] = [distance, { point, i, x, y }];
      }
    });
    this.#tip.hidden = !at;
    if (!at) return;
    const { point, i, x, y } = at;
    this.#tip.textContent = text("precision.point", {
      title: this.#titles[i], setting: words(point.setting), value: format(point.value), error: format(point.error),
      forces: point.force_evaluations, seconds: format(point.seconds) });
    const { clientWidth: width, clientHeight: height } = this.#plot.over;
    this.#tip.style.translate = `${Math.min(x + 12, width - this.#tip.offsetWidth)}px ` +
                                `${y > height / 2 ? y - this.#tip.offsetHeight - 10 : y + 10}px`;
  }

  #drawFloor(colour) {
    const { scales, bbox, ctx: pen } = this.#plot ?? {};
    if (!pen || !(this.#floor > scales.y.min)) return;
    const y = Math.round(this.#plot.valToPos(this.#floor, "y", true));
    pen.save();
    pen.strokeStyle = colour;
    pen.lineWidth = 2;
    pen.setLineDash([4, 4]);
    pen.beginPath();
    pen.moveTo(bbox.left, y);
    pen.lineTo(bbox.left + bbox.width, y);
    pen.stroke();
    pen.restore();
  }
}
