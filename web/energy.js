// The energy error of the runs over time, on a logarithmic axis. uPlot is the global of uPlot.iife.min.js.
import { format, multiples, powerOfTen } from "./numbers.js";

/** |H − H₀| of a run, divided by |H₀| where `relative`; exact zeros, which have no logarithm, are left out. */
function errors({ t, energy }, relative) {
  const start = energy[0], scale = relative ? Math.abs(start) : 1;
  const kept = [[], []];
  for (let i = 0; i < t.length; i++) {
    const error = Math.abs(energy[i] - start) / scale;
    if (error > 0 && Number.isFinite(error)) {
      kept[0].push(t[i]);
      kept[1].push(error);
    }
  }
  return kept;
}

/** The plot in `container`; `show(runs)` with `[{title, colour: name of a CSS variable, trajectory}]`. */
export class EnergyPlot {
  #container;
  #plot = null;
  #resized = new ResizeObserver(() => this.#plot?.setSize(this.#size()));

  constructor(container) {
    this.#container = container;
    this.#resized.observe(container);
  }

  /** Draws again, for new colours. */
  draw() {
    this.#plot?.redraw(false, true);
  }

  /** Says what it shows: `{what, note}`. */
  show(runs) {
    if (this.#plot) this.#resized.unobserve(this.#plot.root.querySelector(".u-legend"));
    this.#plot?.destroy();
    this.#plot = null;
    const relative = runs.length > 0 && runs.every((run) => run.trajectory.energy[0] !== 0);
    const what = relative ? "|H − H₀| / |H₀|" : "|H − H₀|";
    const tables = runs.map((run) => errors(run.trajectory, relative));
    if (tables.every(([t]) => !t.length)) return { what, note: runs.length ? "No error at all: H is exactly H₀." : "" };
    const data = tables.length > 1 ? uPlot.join(tables) : tables[0];
    this.#plot = new uPlot(this.#options(runs, what), data, this.#container);
    this.#resized.observe(this.#plot.root.querySelector(".u-legend"));
    const exact = runs.filter((_, i) => tables[i][0].length === 0).map((run) => run.title);
    return { what, note: exact.length ? `${exact.join(" and ")}: exactly H₀ throughout.` : "" };
  }

  #size() {
    const legend = this.#container.querySelector(".u-legend")?.offsetHeight ?? 0;
    return { width: this.#container.clientWidth, height: this.#container.clientHeight - legend };
  }

  #options(runs, what) {
    const style = getComputedStyle(this.#container);
    const ink = (name) => () => style.getPropertyValue(name).trim();
    const font = `13px ${style.fontFamily}`;
    const axis = { stroke: ink("--soft-ink"), grid: { stroke: ink("--grid"), width: 1 }, font,
                   ticks: { stroke: ink("--grid"), width: 1 } };
    const value = (_, v) => format(v);
    return {
      ...this.#size(),
      scales: { x: { time: false }, y: { distr: 3 } },
      axes: [
        { ...axis, label: "t", labelFont: `italic 16px ${style.fontFamily}`, labelSize: 22, size: 34 },
        { ...axis, size: 58, splits: (_, __, low, high) => decades(low, high), filter: (_, marks) => marks,
          values: (_, marks) => marks.map((v) => powerOfTen(Math.round(Math.log10(v)))) },
      ],
      series: [
        { label: "t", value: (_, v) => format(v, 5) },
        ...runs.map((run) => ({ label: run.title, stroke: ink(run.colour), width: 1.4, points: { show: false }, value })),
      ],
      cursor: { points: { size: 7 }, drag: { x: true, y: false } },
      legend: { live: true, markers: { width: 3 } },
    };
  }
}

/** Powers of ten in [low, high], at most about eight of them. */
function decades(low, high) {
  const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
  return multiples(first, last, Math.max(1, Math.ceil((last - first) / 8))).map((n) => 10 ** n);
}
