// The energy of the runs over time: its error on a logarithmic axis where the scene keeps it, else H itself on a plain
// one. uPlot is the global of uPlot.iife.min.js.
import { text } from "../language/texts.js";
import { decadeLabels, decades, format, multiples, roundStep, tickLabel } from "../forms/numbers.js";

const known = (x) => x !== null;
const startOf = ({ trajectory }) => trajectory.energy.find(known);

/** |H − H₀|, divided by |H₀| if `relative` and that is not zero; null where it is zero or H is unknown. */
export function errorOfEnergy({ energy }, relative = true) {
  const start = energy.find((v) => v !== null), scale = relative && start ? Math.abs(start) : 1;
  return energy.map((v) => (v === null || v === start ? null : Math.abs(v - start) / scale));
}

/** |H − H₀| of a run, divided by |H₀| where `relative`; exact zeros, which have no logarithm, are left out. */
function errors(run, relative) {
  const { t, energy } = run.trajectory, start = startOf(run), scale = relative ? Math.abs(start) : 1;
  const kept = [[], []];
  for (let i = 0; i < t.length; i++) {
    const error = known(energy[i]) ? Math.abs(energy[i] - start) / scale : null; // null is a gap
    if (error === null || (error > 0 && Number.isFinite(error))) {
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
  #shape = ""; // of what it can show without being made anew
  #again = () => {};
  #resized = new ResizeObserver(() => this.#plot?.setSize(this.#size()));

  constructor(container) {
    this.#container = container;
    this.#resized.observe(container);
  }

  /** Draws again, for new colours or letters of another size. */
  draw() {
    if (this.#plot && this.#letters !== this.#plot.letters) this.#again();
    else this.#plot?.redraw(false, true);
  }

  /** The height of the letters. */
  get #letters() {
    return Math.round(0.82 * parseFloat(getComputedStyle(this.#container).fontSize));
  }

  /** Shows the "error" of the energy, its "value", or that there is "none"; returns the words about that, `{title, what, note}`. */
  show(kind, runs) {
    this.#again = () => this.show(kind, runs);
    this.#container.hidden = kind === "none";
    if (kind === "none") {
      this.#clear();
      return { title: text("energy"), what: "", note: text("energy.none") };
    }
    const seen = runs.filter((run) => run.trajectory.energy.some(known));
    if (kind === "value") return { title: text("energy.value"), what: text("energy.changes"), note: this.#showValues(seen) };
    const relative = seen.length > 0 && seen.every((run) => startOf(run) !== 0);
    return { title: text("energy.error"), what: relative ? "|H − H₀| / |H₀|" : "|H − H₀|", note: this.#showErrors(seen, relative) };
  }

  #showValues(runs) {
    this.#plotTables(runs, runs.map(({ trajectory }) => [trajectory.t, trajectory.energy]), plain);
    return "";
  }

  #showErrors(runs, relative) {
    const tables = runs.map((run) => errors(run, relative));
    const exact = runs.filter((_, i) => !tables[i][1].some(known));
    if (exact.length === runs.length) {
      this.#clear();
      return runs.length ? text("energy.exact") : "";
    }
    this.#plotTables(runs, tables, logarithmic);
    return exact.length ? text("energy.exact.of", { runs: exact.map((run) => run.title).join(text("and")) }) : "";
  }

  #clear() {
    if (this.#plot) this.#resized.unobserve(this.#plot.root.querySelector(".u-legend"));
    this.#plot?.destroy();
    this.#plot = null;
  }

  #plotTables(runs, tables, scale) {
    if (!runs.length) return this.#clear();
    const ascending = tables.map((table) => (table[0].at(-1) < table[0][0] ? table.map((column) => column.toReversed()) : table));
    const data = ascending.length > 1 ? uPlot.join(ascending) : ascending[0];
    const shape = JSON.stringify([scale.distr, this.#letters, runs.map(({ title, colour }) => [title, colour])]);
    if (this.#plot && shape === this.#shape) return this.#plot.setData(data);
    this.#clear();
    this.#shape = shape;
    this.#plot = Object.assign(new uPlot(this.#options(runs, scale), data, this.#container), { letters: this.#letters });
    this.#resized.observe(this.#plot.root.querySelector(".u-legend"));
  }

  #size() {
    const legend = this.#container.querySelector(".u-legend")?.offsetHeight ?? 0;
    return { width: this.#container.clientWidth, height: this.#container.clientHeight - legend };
  }

  #options(runs, { distr, splits, values, widths }) {
    const style = getComputedStyle(this.#container);
    const ink = (name) => () => style.getPropertyValue(name).trim();
    const letters = this.#letters, font = `${letters}px ${style.fontFamily}`;
    const axis = { stroke: ink("--soft-ink"), grid: { stroke: ink("--grid"), width: 1 }, font,
                   ticks: { stroke: ink("--grid"), width: 1 } };
    const value = (_, v) => format(v);
    return {
      ...this.#size(),
      scales: { x: { time: false }, y: { distr } },
      axes: [
        { ...axis, values: (_, marks) => marks.map((v) => tickLabel(v, marks[1] - marks[0])), label: "t", labelFont: `italic ${letters + 3}px ${style.fontFamily}`, labelSize: 1.7 * letters, size: 2.5 * letters },
        { ...axis, size: 4.5 * letters, splits: ({ height }, _, low, high) => splits(low, high, Math.max(2, Math.min(8, Math.floor(height / letters / 2) - 2))), filter: (_, marks) => marks,
          values: (_, marks) => values(marks) },
      ],
      series: [
        { label: "t", value: (_, v) => format(v, 5) },
        ...runs.map((run, i) => ({ label: run.title, stroke: ink(run.colour), width: widths[i] ?? widths.at(-1), points: { show: false },
                                   value })),
      ],
      cursor: { points: { size: 7 }, drag: { x: true, y: false } },
      legend: { live: true, markers: { width: 3 } },
    };
  }
}

// The axes of the energy, with the widths of the runs' lines. Two good runs of H itself are one line to the eye: the
// first is drawn broad, to be seen beneath the second.
const logarithmic = { distr: 3, splits: decades, widths: [1.4, 1.4], values: decadeLabels };
const plain = { distr: 1, splits: (low, high, many) => multiples(low, high, roundStep(low, high, many)), widths: [6, 2],
                values: (marks) => marks.map((v) => tickLabel(v, marks[1] - marks[0])) };
