// The closed orbit near a run: drawn over the pictures of the runs, with its period, its multipliers about the unit circle and,
// where that is asked for, what leaves it and what comes to it, and the family of closed orbits that it belongs to, as a curve.
import { text } from "../language/texts.js";
import * as api from "../service/api.js";
import { element, words } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { isAutonomous } from "../catalogue/card.js";
import { statedColumns } from "../catalogue/stated.js";
import { circlePicture } from "../drawing/circle.js";
import { commonView, extent } from "../drawing/mapping.js";
import { Plane } from "../drawing/plane.js";
import { Study, tableOf } from "./part.js";
import { numbersOf, pointerTo, startsOf } from "./pointers.js";
import { periodOf } from "./section.js";

const none = "none", along = 2000; // states along a run, in which a return is looked for
const away = 0.3, near = 0.1; // parts of its extent: a run that has been away comes back where it is near again
const places = 8; // along an orbit, from which two trajectories leave it and two come to it
const magnified = 2e6; // they begin 1e-6 of its extent away from it

function cardsOf(problem) {
  const moving = startsOf(problem), ways = [none, "period", "energy", ...numbersOf(problem), ...moving];
  const named = { [none]: text("closed.none"), period: text("closed.period"), energy: text("closed.energy") };
  return [
    { name: "period", label: text("closed.guess"), default: null, nullable: true, word: text("tangent.usual"), doc: text("closed.guess.doc") },
    { name: "fixed", label: text("closed.fixed"), type: "choice", choices: [none, ...moving], words: named, default: none, doc: text("closed.fixed.doc") },
    { name: "symmetric", label: text("closed.symmetric"), type: "flag", default: false, doc: text("closed.symmetric.doc") },
    { name: "manifolds", label: text("closed.manifolds"), type: "flag", default: false, doc: text("closed.manifolds.doc") },
    { name: "by", label: text("closed.by"), type: "choice", choices: ways, words: named, default: none, doc: text("closed.by.doc") },
    { name: "to", label: text("closed.to"), default: null, nullable: true, word: "–" },
    { name: "count", label: text("closed.count"), default: 30 },
  ];
}

/**
 * The guess of a closed orbit, `{at, period}`: the state to which a run comes back, and after what time. It is the start, if the run
 * comes back there; else, as on an attractor, the state to which the run comes back most closely; null: it never comes back.
 * Distances are relative to the extent of each variable.
 */
function returnOf({ t, ...columns }, names) {
  const sizes = names.map((name) => extent(columns[name]).reduce((low, high) => high - low) || 1);
  const apart = (i, j) => Math.max(...names.map((name, k) => Math.abs(columns[name][i] - columns[name][j]) / sizes[k]));
  const first = (i) => { // the first time that it has been away and is near again, at its nearest
    let left = false, best = null;
    for (let j = i + 1; j < t.length; j++) {
      const d = apart(i, j);
      if (!left) left = d > away;
      else if (best ? d < best.d : d < near) best = { i, j, d };
      else if (best) break;
    }
    return best;
  };
  const found = first(0);
  if (found?.j < t.length / 2) return { at: 0, period: Math.abs(t[found.j] - t[0]) };
  const some = t.map((_, i) => i).filter((i) => i % 10 === 0), all = some.map(first).filter(Boolean);
  if (!all.length) return null;
  const { i, j } = all.reduce((a, b) => (b.d < a.d ? b : a));
  return { at: i, period: Math.abs(t[j] - t[i]) };
}

/** The time until trajectories that leave an orbit are seen apart from it, or else, backward, those that approach it; null: never. */
function reachOf({ period, multipliers }) {
  const rates = multipliers.filter(({ kind }) => /hyperbolic$/.test(kind)).map(({ modulus }) => Math.log(modulus));
  const rate = Math.max(...rates) > 0 ? Math.max(...rates) : -Math.min(...rates);
  return rates.length ? (period * Math.log(magnified)) / rate : null;
}

export class Closed extends Study {
  #family = new Plane(this.find("figure canvas"));
  #circle = new Plane(this.find("#multipliers + figure canvas"));
  #begin = element("button", { type: "button", textContent: text("closed.start"), hidden: true });
  #picked; // ({name: value}, section)
  #drawn; // ([{trajectory, colour, dash}]): what is to be drawn over the runs
  #orbit = null;
  #members = [];

  /** `picked` as of the other studies; `drawn([{trajectory, colour, dash}])`: what is to be drawn over the runs. */
  constructor(picked, drawn) {
    super("closed", cardsOf, element("div", { id: "multipliers" }),
          element("figure", { hidden: true }, element("canvas", { className: "plane", role: "img", ariaLabel: text("closed.circle") })));
    this.#picked = picked;
    this.#drawn = drawn;
    this.find(".choices").append(this.#begin);
    this.#begin.addEventListener("click", () => this.#run(this.#orbit));
  }

  clear() {
    this.#orbit = null;
    this.#members = [];
    this.#begin.hidden = true;
    this.find("#multipliers").replaceChildren();
    this.find("#multipliers + figure").hidden = true;
    this.#circle.show(null);
    this.#show();
    this.#drawn([]);
  }

  draw() {
    this.#circle.draw();
    this.#family.draw();
  }

  /** Closes the orbit that a `scene` begins near, under the first of `schemes`: `{faults}` or `{said}`. */
  async measure({ scene, schemes: [scheme] }, _, signal, told) {
    const { period, fixed, symmetric, manifolds, by, to, count } = this.chosen(), { until: __, ...start } = scene;
    this.clear();
    told(text("closed.running"));
    const guess = Number.isFinite(period) ? { period } : await this.#guess(scene, scheme, signal);
    if (guess.faults) return guess;
    const way = ["period", "energy"].includes(by) ? by : pointerTo(this.problem, by);
    if (guess.initial) start.initial = { ...start.initial, ...guess.initial };
    const request = { ...start, period: guess.period, ...(fixed === none ? {} : { fixed: [fixed] }), ...(symmetric ? { symmetric } : {}),
                      ...(by === none ? {} : { family: { by: way, to, count } }) };
    let end = null;
    const { faults } = await api.periodic(request, signal, (line) => {
      if (line.kind === "end") end = line;
      if (line.kind !== "member") return;
      this.#members.push(line);
      told(text("closed.so_far", { n: this.#members.length }));
    });
    if (faults) return { faults };
    if (!end) return { faults: [{ detail: text("study.broken") }] };
    this.#orbit = end;
    this.#tabulate(end);
    this.#show(by);
    const notes = end.status === "closed" ? await this.#draw(start, end, manifolds, signal, told) : [];
    return { said: [this.#told(end), ...notes, ...this.#kin(end, by)].join(" ") };
  }

  /** The guess of the period: that of a drive, else the time after which the run comes back, with the place if not its start. */
  async #guess(scene, scheme, signal) {
    if (!isAutonomous(this.problem)) return { period: periodOf(this.problem, scene.problem) };
    const names = startsOf(this.problem).filter((name) => name !== "s");
    const { outcome, faults } = await api.simulate({ ...scene, scheme, record: { samples: along }, columns: ["t", ...names], diagnostics: [] }, signal);
    if (faults) return { faults };
    const found = returnOf(outcome.trajectory, names);
    if (!found) return { faults: [{ detail: text("closed.away") }] };
    return { period: found.period, ...(found.at ? { initial: Object.fromEntries(names.map((name) => [name, outcome.trajectory[name][found.at]])) } : {}) };
  }

  /** Draws one round, and if `wanted` the unstable and the stable manifold; returns notes about them. */
  async #draw(start, { initial, period, multipliers }, wanted, signal, told) {
    const own = this.problem.columns.filter((name) => name.endsWith("_wrapped")), over = [];
    const columns = ["t", ...startsOf(this.problem), ...own, ...statedColumns(this.problem)];
    const draw = async (runs, curve, look) => { // the orbit, which comes first, above all
      const answers = await Promise.all(runs.map(([from, t]) => (
        api.simulate({ ...start, initial: from, scheme: "taylor", until: { t }, record: { curve }, columns, diagnostics: [] }, signal))));
      over.unshift(...answers.flatMap(({ outcome }) => (outcome ? [{ trajectory: outcome.trajectory, ...look }] : [])));
      this.#drawn([...over]);
    };
    await draw([[initial, (initial.t ?? 0) + period]], along, { colour: "--ink", dash: [9, 4] });
    if (!wanted) return [];
    told(text("closed.leaving"));
    const until = reachOf({ period, multipliers });
    if (until === null) return [text("closed.elliptic")];
    let found = null;
    const { faults } = await api.periodic({ ...start, initial, period, manifolds: { count: places, until } }, signal, (line) => (found = line.manifolds ?? found));
    if (faults || !found) return [faults?.[0].detail ?? text("study.broken")];
    const notes = [];
    for (const [kind, colour] of [["unstable", "--run-d"], ["stable", "--run-c"]]) {
      const { trajectories, reason } = found[kind];
      const first = (states) => Object.fromEntries(Object.entries(states).map(([name, values]) => [name, values[0]]));
      await draw(trajectories.map(({ side: _, ...states }) => [first(states), states.t.at(-1)]), along / 4, { colour, thin: true });
      notes.push(trajectories.length ? text(`closed.${kind}_one`) : text(`closed.no_${kind}_one`, { why: reason ?? "" }));
    }
    return notes;
  }

  #tabulate({ status, multipliers }) {
    this.#begin.hidden = status !== "closed";
    this.find("#multipliers").replaceChildren(...(multipliers.length ? [tableOf(text("closed.multipliers"),
      [text("closed.multipliers"), text("closed.modulus"), "Re", "Im"],
      multipliers.map(({ kind, modulus, re, im }) => [kind ? words(kind) : "–", ...[modulus, re, im].map((v) => format(v, 5))]))] : []));
    this.find("#multipliers + figure").hidden = !multipliers.length;
    this.#circle.show(multipliers.length ? circlePicture(multipliers, "--run-b", [text("closed.circle"), ""]) : null);
  }

  #told({ status, reason, period, closure, stable, trivial, stop }) {
    const given = { period: format(period, 8), closure: closure === null ? "–" : format(closure, 2), why: reason ?? "" };
    if (status !== "closed") return text("closed.not", { ...given, why: stop ? `${given.why} (${words(stop.reason)})` : given.why });
    const held = stable === null ? "" : ` ${text(stable ? "closed.stable" : "closed.unstable")}`;
    return text("closed.done", given) + held + (trivial ? ` ${text("closed.trivial", { n: trivial })}` : "");
  }

  /** The words about the family. */
  #kin({ family_end: end }, by) {
    if (!this.#members.length) return [];
    const turns = this.#members.filter(({ bifurcation }) => bifurcation)
      .map(({ bifurcation, value }) => text("closed.bifurcation", { what: words(bifurcation), name: by, value: format(value, 6) }));
    return [text("closed.family", { n: this.#members.length }), ...turns, ...(end ? [text("closed.family_end", { why: end })] : [])];
  }

  /** Draws the period of the members over the quantity `by` that varies, or the energy if that is the period. */
  #show(by = none) {
    const members = this.#members, figure = this.find("figure");
    figure.hidden = members.length < 2;
    if (figure.hidden) return this.#family.show(null);
    const up = by === "period" ? "energy" : "period", x = members.map(({ value }) => value), y = members.map((one) => one[up]);
    const part = (wanted, colour) => { // with one of the others on each side, for the curve to have no gaps
      const seen = members.map((one, i) => [one, members[i - 1]].some((each) => each && (each.stable !== false) === wanted));
      return { x: x.map((v, i) => (seen[i] && y[i] !== null ? v : null)), y: y.map((v, i) => (seen[i] ? v : null)), colour, title: "", unmarked: true };
    };
    const curves = [part(true, "--run-b"), part(false, "--run-a")].filter((curve) => curve.x.some((v) => v !== null));
    const marks = members.flatMap(({ bifurcation }, i) => (bifurcation && y[i] !== null ? [{ x: [x[i]], y: [y[i]], colour: "--ink", title: "", endless: true }] : []));
    this.find("figcaption").textContent = text("closed.legend");
    this.#family.show({ curves: [...curves, ...marks], view: commonView(curves, ["x", "y"], true),
                        labels: [by === "period" || by === "energy" ? text(`closed.${by}`) : by, text(`closed.${up}`)], pick: (left, top) => this.#pick(left, top, by, up) });
  }

  /** Runs the member nearest to a place. */
  #pick(left, top, by, up) {
    const { map } = this.#family, apart = (one) => Math.hypot(map.x(one.value) - left, map.y(one[up]) - top);
    const nearest = this.#members.reduce((a, b) => (apart(b) < apart(a) ? b : a));
    if (numbersOf(this.problem).includes(by)) this.#picked({ [by]: nearest.value }, "problem");
    this.#run(nearest);
  }

  #run({ initial, period }) {
    this.#picked({ t: (initial.t ?? 0) + period }, "until");
    this.#picked(initial);
  }
}
