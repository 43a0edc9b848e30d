// The workbench: one scene, up to six runs of it. Any change makes new requests; while a hand moves a slider one set of them
// is in flight, and the newest follows.
import { columns, diagnostics } from "./card.js";
import { choose } from "./forms.js";
import { names, toHash } from "./link.js";
import { Live } from "./live.js";
import { Own } from "./own.js";
import { Pane } from "./pane.js";
import { recordOf } from "./record.js";
import { samples, Scene } from "./scene.js";
import { Sight } from "./sight.js";
import { Studies } from "./studies.js";
import { Takeaway } from "./takeaway.js";
import { custom, definitionOf, linked, unlinked } from "./text.js";
import { equalWork } from "./work.js";

const find = (selector) => document.querySelector(selector);
const coarse = 800; // points of a run while a hand moves a slider

export class Bench {
  #catalogue;
  #went; // (hash) of a change
  #scene = new Scene();
  #own = new Own({ typed: (card, definition) => this.#typed(card, definition), stirred: () => this.#pending || this.#dim(true),
                   picked: (example) => example && this.#pick(example) });
  #pending = null; // an experiment whose text is not read yet
  #typing = false; // the last change was one of the text
  #panes = [];
  #sight = new Sight();
  #studies;
  #outcomes = null; // those in sight by the names of the runs, null while there are none of this problem
  #visited = new Map(); // what was set for each problem
  #scheduled = 0;
  #again = 0;
  #live = new Live((asked, signal) => this.#answer(asked, signal), (answers, asked) => this.#show(answers, asked));

  constructor(catalogue, went) {
    this.#catalogue = catalogue;
    this.#went = went;
    this.#studies = new Studies(catalogue.schemes, () => this.#studied());
    new Takeaway(() => ({ planes: this.#sight.planes(this.#panes), problem: this.#scene.problem.id,
                          runs: this.#runs.filter(({ outcome }) => outcome) }));
    this.#listen();
  }

  get #problem() {
    return this.#scene.problem;
  }

  /** Sets everything to an experiment as a link holds it, `quietly` where the address says it already. */
  load(experiment, quietly = true) {
    const { problems } = this.#catalogue;
    if (experiment.problem?.id === custom) return this.#open(experiment, quietly);
    this.#own.close();
    this.#wait(null);
    return this.#begin(problems.find(({ id }) => id === experiment.problem?.id) ?? problems[0], experiment, quietly);
  }

  #begin(problem, experiment, quietly, definition = null) {
    const { problems, schemes } = this.#catalogue;
    this.#outcomes = null;
    this.#sight.rest();
    choose(find("#problem"), [{ id: custom, title: "Your own scene" }, ...problems], problem.id);
    this.#scene.load(problem, experiment, definition);
    const wanted = names.filter((name, i) => i < 2 || experiment[name]);
    this.#panes = wanted.map((name) => this.#panes.find((pane) => pane.name === name) ?? this.#newPane(name));
    for (const pane of this.#panes) pane.offer(problem, schemes, experiment[pane.name]);
    this.#studies.choices = experiment.study ?? {};
    find("#together").checked = experiment.view?.together === "true";
    this.#place();
    this.request(quietly);
  }

  /** Opens a scene as text; without one, the first of the examples. */
  async #open(experiment, quietly) {
    const texts = unlinked(experiment.problem);
    choose(find("#problem"), [{ id: custom, title: "Your own scene" }, ...this.#catalogue.problems], custom);
    this.#live.stop();
    this.#wait(experiment);
    if (!texts) {
      const [first = { problem: { variables: ["q"], lagrangian: "(v^2 - q^2)/2" } }] = await this.#own.examples();
      return this.#pending === experiment && this.#pick(first, quietly);
    }
    const { problem } = definitionOf(texts), card = await this.#own.open(problem);
    if (this.#pending !== experiment) return;
    if (!card) return void (find("#status").textContent = "This text cannot be read: see the marked place.");
    const initial = await this.#own.startOf(card, problem, experiment.initial);
    if (this.#pending !== experiment) return;
    this.#wait(null);
    this.#begin(card, { ...experiment, initial }, quietly, problem);
  }

  /** Waits for the text of an experiment: until it is read there is nothing to show. */
  #wait(experiment) {
    this.#pending = experiment;
    for (const part of ["#results", "#scene"]) find(part).hidden = Boolean(experiment);
    if (experiment) find("#status").textContent = "Reading the scene…";
  }

  /** A text was read: all that was set stays, as far as the new scene has it. */
  #typed(card, definition) {
    if (!card) return this.#dim(false);
    const now = this.#pending ?? this.#experiment(true), { definition: before } = this.#scene;
    const same = Object.entries(definition.parameters ?? {}).filter(([name, value]) => before?.parameters?.[name] === value);
    const set = same.filter(([name]) => name in now.problem).map(([name]) => [name, now.problem[name]]);
    const quietly = this.#typing;
    this.#wait(null);
    this.#begin(card, { ...now, problem: { ...linked(definition), ...Object.fromEntries(set) } }, quietly, definition);
    this.#typing = true;
  }

  /** Begins with an example. */
  #pick({ problem, initial = {}, until = {}, scheme, axes = {} }, quietly = false) {
    const run = typeof scheme === "string" ? { id: scheme } : scheme;
    this.load({ problem: linked({ ...problem, id: custom }), initial, until, axes, ...(run ? { A: run, B: { id: run.id } } : {}) }, quietly);
  }

  close() {
    clearTimeout(this.#again);
    this.#own.close();
    this.#wait(null);
    this.#live.stop();
    this.#sight.rest();
  }

  draw() {
    this.#sight.draw();
    this.#studies.draw();
  }

  key(event) {
    if (event.key !== " " || event.target.closest("input, select, textarea, button, a, summary")) return;
    event.preventDefault();
    this.#sight.toggle();
  }

  #newPane(name) {
    const pane = new Pane(name, name === "B" ? 2 : 1, (t) => this.#sight.point(t));
    pane.node.querySelector(".remove").addEventListener("click", () => this.#remove(pane));
    return pane;
  }

  /** Puts the panes and what goes with their number in place. */
  #place() {
    find("#panes").replaceChildren(...this.#panes.map(({ node }) => node));
    find("#add").disabled = this.#panes.length === names.length;
    for (const { node } of this.#panes) node.querySelector(".remove").hidden = this.#panes.length <= 2;
    find("#overlay").hidden = !find("#results").classList.toggle("together", find("#together").checked);
  }

  #add() {
    const name = names.find((free) => !this.#panes.some((pane) => pane.name === free)), like = this.#panes.at(-1).chosen();
    this.#panes = [...this.#panes, this.#newPane(name)].sort((a, b) => (a.name < b.name ? -1 : 1));
    this.#panes.find((pane) => pane.name === name).offer(this.#problem, this.#catalogue.schemes, like);
    this.#place();
    this.request();
  }

  #remove(gone) {
    this.#panes = this.#panes.filter((pane) => pane !== gone);
    this.#place();
    this.request();
  }

  /** The experiment as the forms stand; `changed`: without what has its default. */
  #experiment(changed = false) {
    const together = find("#together").checked ? { together: true } : {};
    return { ...this.#scene.values(changed), view: together, study: this.#studies.choices,
             ...Object.fromEntries(this.#panes.map((pane) => [pane.name, pane.chosen(changed)])) };
  }

  /** The scene as it stands in a request. */
  #sceneOf({ problem, preset, initial, until }) {
    return { problem: this.#scene.asked(problem, preset), initial, until };
  }

  /** What the studies ask for. */
  #studied() {
    const now = this.#experiment(), schemes = this.#panes.map(({ name }) => now[name]);
    return { scene: this.#sceneOf(now), schemes: schemes.filter(({ id }) => id !== "auto") };
  }

  /** The request for one run, with `most` points. */
  #requestFor(now, scheme, most) {
    const { problem, initial, until } = this.#sceneOf(now), card = this.#catalogue.schemes.find(({ id }) => id === scheme.id);
    const span = (until.t ?? this.#scene.start + this.#problem.until.t) - this.#scene.start;
    return { problem, initial, scheme, until, record: recordOf(this.#scene, card, scheme, span, most),
             columns: columns(this.#problem, card, this.#scene.axes, this.#scene.columns), diagnostics: diagnostics(this.#problem) };
  }

  get #runs() {
    return this.#panes.map(({ name, title, colour }) => {
      const outcome = this.#outcomes?.[name];
      return { name, title: `${name}: ${title}`, colour, outcome, trajectory: outcome?.trajectory };
    });
  }

  /** Asks for runs soon; several changes at once make one. `quietly`: the address does not change by a hand. */
  request(quietly = false) {
    if (this.#pending) return;
    this.#typing = false;
    this.#busy(true);
    clearTimeout(this.#scheduled);
    clearTimeout(this.#again);
    this.#scheduled = setTimeout(() => this.#run(quietly), 0);
  }

  #run(quietly) {
    this.#visited.set(this.#problem.id, this.#experiment(true));
    this.#went(toHash(this.#experiment(true)), quietly);
    this.#studies.follow();
    find("#status").textContent = "Running…";
    this.#live.ask({ now: this.#experiment() }, true);
  }

  /** Follows a hand, with fewer points. */
  #follow() {
    this.#busy(true);
    this.#live.ask({ now: this.#experiment(), most: coarse });
  }

  #dim(busy) {
    find("#results").setAttribute("aria-busy", String(busy));
  }

  #busy(busy) {
    this.#dim(busy);
    find("#stop").hidden = !busy;
  }

  #answer({ now, most = now.record.samples ?? samples.default }, signal) {
    this.#scene.clearFaults();
    return Promise.all(this.#panes.map((pane) => {
      pane.clearFaults();
      return pane.run(this.#requestFor(now, now[pane.name], most), this.#scene.fields, signal);
    }));
  }

  #show(answers) {
    const kept = this.#outcomes ?? {};
    this.#outcomes = Object.fromEntries(this.#panes.map(({ name }, i) => [name, answers[i].outcome ?? kept[name] ?? null]));
    this.#panes.forEach((pane, i) => pane.node.classList.toggle("stale", !answers[i].outcome));
    this.#showPlanes();
    this.#sight.tell(this.#problem, this.#runs.filter((_, i) => answers[i].outcome));
    const lost = answers.some((answer) => answer.lost);
    find("#status").textContent = lost ? "The service does not answer; asked again every two seconds." : this.#panes.map(({ name }, i) =>
      `${name} ${answers[i].outcome?.status ?? "refused: see the marked fields"}`).join(", ");
    if (lost) this.#again = setTimeout(() => this.request(true), 2000);
    this.#busy(this.#live.waiting);
  }

  #showPlanes() {
    this.#sight.show(this.#scene, this.#panes, this.#runs, (at, done) => this.#grab(at, done));
  }

  /** The start is dragged in a picture. */
  #grab(at, done) {
    this.#scene.begin(Object.fromEntries(Object.entries(at).map(([name, value]) => [name, Number(value.toPrecision(4))])));
    if (done) this.request();
    else this.#follow();
  }

  #continue() {
    const ended = this.#runs.find(({ outcome }) => outcome?.final);
    if (ended) this.#scene.goOn(ended.outcome.final);
    this.request();
  }

  #even() {
    const settings = equalWork(this.#runs.map(({ outcome }) => ({ outcome, scheme: outcome?.scheme ?? {} })));
    this.#panes.forEach((pane, i) => settings[i] && pane.refineTo(settings[i]));
    this.request();
  }

  #listen() {
    find("#experiment").addEventListener("submit", (event) => {
      event.preventDefault();
      this.request();
    });
    find("#problem").addEventListener("change", ({ target: { value } }) => {
      const kept = value === custom ? {}
        : Object.fromEntries(this.#panes.map((pane) => [pane.name, { id: pane.chosen().id }]));
      this.load({ problem: { id: value }, ...(this.#visited.get(value) ?? kept) }, false);
    });
    find("#preset").addEventListener("change", ({ target: { value } }) => {
      const { initial: _, ...kept } = this.#experiment();
      this.load({ ...kept, problem: { id: this.#problem.id }, preset: { id: value }, until: this.#scene.ownEnd }, false);
    });
    find("#initial").addEventListener("change", ({ target }) => target.dataset.name === "t" && this.#scene.moveEnd());
    find("#columns").addEventListener("change", () => this.#scene.offerAxes());
    find("#axes").addEventListener("change", () => {
      this.#place();
      this.#went(toHash(this.#experiment(true)), false);
      const there = (name) => this.#runs.every(({ trajectory: t }) => !t || t[name] || (name === "error_of_energy" && t.energy));
      if (this.#outcomes && this.#scene.axes.every(there)) this.#showPlanes();
      else this.request();
    });
    find("#experiment").addEventListener("slide", () => this.#follow());
    find("#experiment").addEventListener("change", ({ target }) => {
      if (target.closest("#studies")) this.#went(toHash(this.#experiment(true)), true);
      else if (!target.closest("#problem, #preset, #axes, #motion, .curl, #own")) this.request();
    });
    find("#add").addEventListener("click", () => this.#add());
    find("#even").addEventListener("click", () => this.#even());
    find("#continue").addEventListener("click", () => this.#continue());
    find("#stop").addEventListener("click", () => {
      this.#live.stop();
      this.#busy(false);
      find("#status").textContent = "Stopped.";
    });
  }
}
