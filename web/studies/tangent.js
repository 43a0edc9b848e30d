// What the end of a run depends on: its derivatives by the starts and the parameters, as a table, and as a fan of neighbours,
// which are run, beside what the derivatives predict of them.
import { text } from "../language/texts.js";
import * as api from "../service/api.js";
import { rounded } from "../service/work.js";
import { element } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { motion, title } from "../catalogue/card.js";
import { commonView, curveOf, extent } from "../drawing/mapping.js";
import { Plane } from "../drawing/plane.js";
import { Study, tableOf } from "./part.js";
import { numbersOf, pointerTo, startsOf, valueOf, withValue } from "./pointers.js";

const most = 64; // numbers to differentiate by, and rows that are shown
const along = 400; // places along a run
const fan = 0.04; // how far the outermost neighbours end from the run, as a part of the picture, where nothing else is asked

/** The names to differentiate by: all starts and all parameters, of a crowd of variables the parameters. */
const namesOf = (problem) => [...(motion(problem).length > most ? [] : startsOf(problem)), ...numbersOf(problem)].slice(0, most);

function cardsOf(problem) {
  const names = namesOf(problem), moving = startsOf(problem);
  const [x, y] = moving.length > 3 ? moving : ["t", moving[0]];
  const ofs = { usual: text("tangent.usual"), motion: text("tangent.motion"), scheme: text("tangent.scheme") };
  return [
    { name: "vary", label: text("tangent.vary"), type: "choice", choices: names, default: names[0] },
    { name: "shift", label: text("tangent.shift"), default: null, nullable: true, word: ofs.usual, doc: text("tangent.shift.doc") },
    { name: "count", label: text("tangent.count"), default: 4 },
    { name: "x", label: text("section.x"), type: "choice", choices: ["t", ...moving], default: x },
    { name: "y", label: text("section.y"), type: "choice", choices: ["t", ...moving], default: y },
    { name: "of", label: text("tangent.of"), type: "choice", choices: Object.keys(ofs), words: ofs, default: "usual", doc: text("tangent.of.doc") },
  ];
}

/** So many neighbours on both sides, in steps of one: −2, −1, 1, 2. */
const sides = (n) => Array.from({ length: n }, (_, i) => i - Math.floor(n / 2)).map((k) => (k < 0 ? k : k + 1));

/** The step between neighbours for which the outermost end visibly, but not far, from the run. */
function shiftFor({ trajectory, sensitivities: { rows, samples } }, at, { x, y, count }) {
  const seen = [x, y].filter((name) => name !== "t"), size = Math.hypot(...seen.map((name) => extent(trajectory[name]).reduce((low, high) => high - low)));
  const moved = Math.max(...samples.map((one) => Math.hypot(...seen.map((name) => one[rows.indexOf(name)][at]))));
  return rounded((fan * (size || 1)) / (moved || 1) / Math.ceil(count / 2), 1);
}

const apart = (a, b, rows) => Math.hypot(...rows.map((name) => a[name] - b[name]));

export class Tangent extends Study {
  #plane = new Plane(this.find("canvas"));

  constructor() {
    super("tangent", cardsOf, element("div", { id: "derivatives" }));
  }

  clear() {
    this.#plane.show(null);
    this.find("figure").hidden = true;
    this.find("#derivatives").replaceChildren();
  }

  draw() {
    this.#plane.draw();
  }

  /** Differentiates the end of a `scene`, with its `events`, under the first of `schemes`: `{faults}` or `{said}`. */
  async measure({ scene, events, schemes: [scheme] }, cards, signal, told) {
    const asked = this.chosen(), names = namesOf(this.problem), card = cards.find(({ id }) => id === scheme.id);
    this.clear();
    told(text("tangent.running"));
    const own = card?.own_clock || asked.of === "motion", span = Math.abs((scene.until.t ?? 0) - (scene.initial.t ?? 0));
    const every = Math.max(1, Math.ceil(span / scheme.step / along)); // the map of a scheme is known at its steps alone
    const request = { ...scene, scheme, ...(events.length ? { events } : {}), diagnostics: [], columns: [...new Set(["t", asked.x, asked.y])],
                      record: own || !Number.isFinite(every) ? { samples: along } : { every } };
    const sensitivities = { by: names.map((name) => pointerTo(this.problem, name)), at: "samples", ...(asked.of === "usual" ? {} : { of: asked.of }) };
    const { outcome, faults } = await api.simulate({ ...request, sensitivities }, signal);
    if (faults) return { faults };
    const { of, uncertainty, final, samples, reason } = outcome.sensitivities;
    if (!samples.length) return { said: text("tangent.none", { reason }) };
    this.#tabulate(outcome, names);
    // Where the derivatives do not reach the end, those of the last sample that they reach are shown.
    const end = final ? outcome.stop?.t ?? outcome.final.t : outcome.trajectory.t[samples.length - 1];
    const said = text(`tangent.said.${of}`, { scheme: title(card, outcome.scheme), t: format(end, 5), known: format(uncertainty, 2) });
    const shift = Number.isFinite(asked.shift) ? asked.shift : shiftFor(outcome, names.indexOf(asked.vary), asked);
    const beside = await this.#neighbours(request, outcome, { ...asked, shift }, signal);
    if (beside.faults) return beside;
    return { said: said + this.#fan(outcome, names, asked, beside) };
  }

  /** Runs the neighbours: `[{by, outcome}]`, `by` being how far each begins from the run. */
  async #neighbours(request, outcome, { vary, shift, count }, signal) {
    const from = valueOf(this.problem, outcome, vary), found = [];
    for (const by of sides(Math.min(count, 12)).map((k) => k * shift)) {
      const { outcome: run, faults } = await api.simulate(withValue(this.problem, request, vary, from + by), signal);
      if (faults) return { faults };
      found.push({ by, outcome: run });
    }
    return found;
  }

  /** Draws the run, its neighbours and their predictions; returns the words about the predictions. */
  #fan({ trajectory, sensitivities, final, ...base }, names, { vary, x, y }, neighbours) {
    if (!neighbours.length) return "";
    const at = names.indexOf(vary), row = (name) => sensitivities.rows.indexOf(name);
    const moved = (name, by) => sensitivities.samples.map((sample, i) => trajectory[name][i] + (name === "t" ? 0 : by * sample[row(name)][at]));
    const predicted = (by) => ({ t: moved("t", by), [x]: moved(x, by), [y]: moved(y, by) });
    const drawn = (columns, more) => ({ ...curveOf(columns, x, y), series: x === "t", events: [], ...more });
    const hue = (by) => (by < 0 ? "--run-b" : "--run-c");
    const runs = [drawn(trajectory, { colour: "--run-a", title: "" }),
                  ...neighbours.map(({ by, outcome }) => drawn(outcome.trajectory, { colour: hue(by), title: "" }))];
    const told = neighbours.flatMap(({ by }) => {
      const curve = drawn(predicted(by), { colour: hue(by), dash: [6, 5], exact: true, title: "" });
      const end = { t: curve.t.slice(-1), x: curve.x.slice(-1), y: curve.y.slice(-1), colour: hue(by), title: "", endless: true }; // a ring
      return [curve, ...(end.x[0] === null ? [] : [end])];
    });
    const free = x === "t" || y === "t";
    this.find("figure").hidden = false;
    this.#plane.show({ curves: [...runs, ...told], view: commonView(runs, free ? ["x", "y"] : [], free), labels: [x, y] });
    const from = valueOf(this.problem, base, vary), ends = [neighbours[0].by, neighbours.at(-1).by].map((by) => format(from + by, 6));
    this.find("figcaption").textContent = text("tangent.legend", { name: vary, from: ends[0], to: ends[1] });
    if (neighbours.some(({ outcome }) => outcome.stop) || base.stop) return ` ${text("tangent.stopped")}`;
    const { rows, final: matrix } = sensitivities;
    if (!matrix) return ` ${text("tangent.none", { reason: sensitivities.reason })}`;
    const { by, outcome } = neighbours.reduce((far, one) => (Math.abs(one.by) > Math.abs(far.by) ? one : far));
    const where = Object.fromEntries(rows.map((name, i) => [name, final[name] + by * matrix[i][at]]));
    const [far, missed] = [final, where].map((place) => format(apart(outcome.final, place, rows), 3));
    return ` ${text("tangent.missed", { far, missed })}`;
  }

  #tabulate({ sensitivities: { rows, final, samples, events } }, names) {
    const used = names.map((_, j) => j).filter((j) => names[j] !== "s" || rows.includes("s")); // which is carried and moves nothing
    const cells = (derivatives) => used.map((j) => format(derivatives[j], 3));
    const times = events.slice(0, 12).map(({ name, t }, i) => (
      [text("tangent.event", { name, i: events.slice(0, i + 1).filter((other) => other.name === name).length }), ...cells(t)]));
    this.find("#derivatives").replaceChildren(tableOf(text("tangent.table"), [text("tangent.corner"), ...used.map((j) => names[j])],
      [...rows.slice(0, most).map((name, i) => [name, ...cells((final ?? samples.at(-1))[i])]), ...times]));
  }
}
