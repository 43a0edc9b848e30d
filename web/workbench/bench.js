// The workbench: one scene, up to six runs of it. Any change makes new requests; while a hand moves a slider one set of them
// is in flight, and the newest follows.
import { text } from "../language/texts.js";
import { toHash } from "../service/link.js";
import { custom, definitionOf, kept, linked, unlinked } from "../service/text.js";
import { rounded } from "../service/work.js";
import { choose } from "../forms/forms.js";
import { examplesOf } from "../catalogue/examples.js";
import { drawnOf, kindsOf, startsOf } from "../catalogue/kinds.js";
import { Editor } from "../own/editor.js";
import { Studies } from "../studies/studies.js";
import { Background } from "./background.js";
import { FileButtons } from "./files.js";
import { Panes } from "./panes.js";
import { Results } from "./results.js";
import { Runs } from "./runs.js";
import { Scene } from "./scene.js";
import { Starts } from "./starts.js";

const find = (selector) => document.querySelector(selector);

export class Bench {
  #catalogue;
  #went; // (hash) of a change
  #scene = new Scene();
  #editor;
  #pending = null; // an experiment whose text is not read yet
  #typing = false; // the last change was one of the text
  #results = new Results();
  #starts = new Starts((done) => this.#portray(done), () => this.#redraw());
  #background = new Background(() => this.#redraw());
  #over = []; // what a study draws over the runs
  #frame = 0;
  #panes;
  #runs;
  #studies;
  #visited = new Map(); // what was set for each problem
  #scheduled = 0;
  #again = 0;

  constructor(catalogue, went) {
    const { problems, schemes } = catalogue;
    this.#editor = new Editor({ typed: (card, definition) => this.#typed(card, definition), stirred: () => this.#pending || this.#dim(true),
                                picked: (example) => example && this.#pick(example), start: () => this.#start, others: examplesOf(problems) });
    this.#catalogue = catalogue;
    this.#went = went;
    this.#panes = new Panes(schemes, (t) => this.#results.point(t), () => this.request());
    this.#runs = new Runs(this.#scene, this.#panes, this.#starts, schemes, (told) => this.#show(told));
    this.#studies = new Studies(schemes, () => this.#studied(), (values, section) => this.request(this.#scene.begin(values, section)), (over) => {
      if (!over.length && !this.#over.length) return;
      this.#over = over;
      this.#redraw();
    });
    new FileButtons(() => ({ planes: this.#results.planes(this.#panes.list), title: this.#scene.problem.title,
                             runs: this.#runs.list.filter(({ outcome }) => outcome) }), (seen) => this.#results.play(seen));
    this.#listen();
  }

  /** Sets everything to an experiment as a link holds it, `quietly` where the address says it already. */
  load(experiment, quietly = true) {
    const { problems } = this.#catalogue, id = experiment.problem?.id;
    if (id === custom) return this.#open(experiment, quietly);
    this.#editor.close();
    this.#wait(null);
    const called = (wanted) => problems.find((problem) => problem.id === wanted);
    return this.#begin(called(id) ?? called("kepler") ?? problems[0], experiment, quietly);
  }

  #choose(id) {
    choose(find("#problem"), [{ id: custom, title: text("own.title") }, ...this.#catalogue.problems], id);
  }

  #begin(problem, experiment, quietly, definition = null) {
    this.#runs.forget();
    this.#results.rest();
    this.#choose(problem.id);
    this.#scene.load(problem, experiment, definition);
    this.#panes.load({ ...problem, suggested: { ...problem.suggested, ...this.#scene.preset?.suggested } }, experiment);
    this.#studies.offer(problem, experiment);
    this.#together(experiment.view?.together === "true");
    this.#background.chosen = experiment.view ?? {};
    this.#starts.load(experiment.starts);
    this.#offerStarts();
    this.request(quietly);
  }

  /** Opens a scene as text; without one, the first of the examples. */
  async #open(experiment, quietly) {
    const texts = unlinked(experiment.problem);
    this.#choose(custom);
    this.#runs.stop();
    this.#wait(experiment);
    if (!texts) {
      const [first] = await this.#editor.examples();
      return this.#pending === experiment && this.#pick(first, quietly);
    }
    const { problem } = definitionOf(texts), card = await this.#editor.open(problem);
    if (this.#pending !== experiment) return;
    if (!card) return void (find("#status").textContent = text("own.unread"));
    const initial = await this.#editor.startOf(card, problem, experiment.initial);
    if (this.#pending !== experiment) return;
    this.#wait(null);
    this.#begin(card, { ...experiment, initial }, quietly, problem);
  }

  /** Hides results, scene and studies until the text of an `experiment` is read; null shows them again. */
  #wait(experiment) {
    this.#pending = experiment;
    for (const part of ["#results", "#scene", "#studies"]) find(part).hidden = Boolean(experiment);
    if (experiment) find("#status").textContent = text("own.reading");
  }

  /** Takes a text that was read: values set before stay, as far as the new scene has them. */
  #typed(card, definition) {
    if (!card) return this.#dim(false);
    const now = this.#pending ?? this.#experiment(true), set = kept(this.#scene.definition, definition, now.problem);
    this.#wait(null);
    this.#begin(card, { ...now, problem: { ...linked(definition), ...set } }, this.#typing, definition);
    this.#typing = true;
  }

  #pick({ problem, initial = {}, until = {}, scheme, axes = {} }, quietly = false) {
    const run = typeof scheme === "string" ? { id: scheme } : scheme;
    this.load({ problem: linked({ ...problem, id: custom }), initial, until, axes, ...(run ? { A: run } : {}) }, quietly);
  }

  close() {
    clearTimeout(this.#again);
    this.#editor.close();
    this.#wait(null);
    this.#runs.stop();
    this.#results.rest();
  }

  draw() {
    this.#results.draw();
    this.#studies.draw();
  }

  key(event) {
    if (event.key !== " " || event.target.closest("input, select, textarea, button, a, summary")) return;
    event.preventDefault();
    this.#results.toggle();
  }

  /** All runs in one picture, or each in its own. */
  #together(on) {
    find("#together").checked = on;
    find("#overlay").hidden = !find("#results").classList.toggle("together", on);
  }

  /** The experiment as the forms stand; `changed`: without what has its default. */
  #experiment(changed = false) {
    const view = { ...(find("#together").checked ? { together: true } : {}), ...this.#background.chosen };
    return { ...this.#scene.values(changed), view, starts: this.#starts.linked, ...this.#studies.chosen(changed), ...this.#panes.chosen(changed) };
  }

  /** The start in the forms, or in the link whose text is still to be read. */
  get #start() {
    return (this.#pending ?? this.#scene.values(true)).initial ?? {};
  }

  #studied() {
    const schemes = Object.values(this.#panes.chosen()).filter(({ id }) => id !== "auto");
    const { events } = this.#scene, acts = events.some(({ set }) => set); // which change the motion: no study may leave them out
    return { scene: { ...this.#runs.sceneOf(this.#experiment()), ...(acts ? { events } : {}) }, events, schemes };
  }

  /** Asks for runs once for all changes of this moment; `quietly`: the new address is no step to undo. */
  request(quietly = false) {
    if (this.#pending) return;
    this.#typing = false;
    this.#busy(true);
    [this.#scheduled, this.#again].forEach(clearTimeout);
    this.#scheduled = setTimeout(() => this.#run(quietly), 0);
  }

  #run(quietly) {
    const changed = this.#experiment(true);
    this.#visited.set(this.#scene.problem.id, changed);
    this.#went(toHash(changed), quietly);
    this.#studies.follow();
    find("#status").textContent = text("run.running");
    this.#runs.ask(this.#experiment());
  }

  /** Follows a hand, with fewer points. */
  #follow() {
    this.#busy(true);
    this.#runs.ask(this.#experiment(), true);
  }

  #dim(busy) {
    find("#results").setAttribute("aria-busy", String(busy));
  }

  #busy(busy) {
    this.#dim(busy);
    find("#stop").hidden = !busy;
  }

  /** Shows the answers to all runs; without `answers`, new parts of the runs under way. */
  #show({ answers, said, lost, waiting } = {}) {
    this.#showPlanes();
    if (!answers) return;
    this.#results.tell(this.#scene.problem, this.#runs.list.filter((_, i) => answers[i].outcome));
    find("#status").textContent = said;
    if (lost) this.#again = setTimeout(() => this.request(true), 2000);
    this.#busy(waiting);
  }

  #showPlanes() {
    const grab = (at, done) => { // the start is dragged in a picture
      this.#scene.begin(Object.fromEntries(Object.entries(at).map(([name, value]) => [name, rounded(value, 4)])));
      if (done) this.request();
      else this.#follow();
    };
    this.#results.show(this.#scene, this.#panes.list, this.#runs.list, {
      grab, move: (i, place, done) => this.#starts.move(i, place, done), backdrop: this.#background.field?.draw, over: this.#over,
      pick: (place) => this.#starts.add(place), unpick: () => this.#starts.takeBack() });
    this.#background.ask(this.#scene.problem, this.#runs.sceneOf(this.#experiment()), this.#startAxes, this.#results.extent);
  }

  /** The variables that a place in the pictures sets as a start, null if it sets none. */
  get #startAxes() {
    return startsOf(this.#scene.axes, this.#scene.log, this.#scene.problem);
  }

  #offerStarts() {
    this.#starts.offer(this.#startAxes);
  }

  /** Follows a change of the starts of the portrait. */
  #portray(done) {
    if (done) this.#went(toHash(this.#experiment(true)), false);
    this.#runs.askBeside(this.#experiment(), !done);
    this.#redraw();
  }

  /** Draws once in the next frame for all changes before it. */
  #redraw() {
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      if (this.#runs.outcomes) this.#showPlanes();
    });
  }

  #stop() {
    this.#runs.stop();
    this.#show({ answers: this.#runs.list, said: text("stopped"), waiting: false });
  }

  #listen() {
    find("#experiment").addEventListener("submit", (event) => {
      event.preventDefault();
      this.request();
    });
    find("#problem").addEventListener("change", ({ target: { value } }) => {
      const kept = value === custom ? {}
        : Object.fromEntries(Object.entries(this.#panes.chosen()).map(([name, { id }]) => [name, { id }]));
      this.load({ problem: { id: value }, ...(this.#visited.get(value) ?? kept) }, false);
    });
    find("#preset").addEventListener("change", ({ target: { value } }) => {
      const { initial: _, ...kept } = this.#experiment(true); // a preset may suggest steps and a span of its own
      this.load({ ...kept, problem: { id: this.#scene.problem.id }, preset: { id: value }, until: this.#scene.ownEnd }, false);
    });
    find("#initial").addEventListener("change", ({ target }) => {
      if (target.dataset.name === "t") this.#scene.moveEnd();
      this.#editor.again();
    });
    find("#columns").addEventListener("change", () => this.#scene.offerAxes());
    find("#axes").addEventListener("change", ({ target }) => {
      this.#scene.turn(target.name);
      this.#together(find("#together").checked);
      this.#offerStarts();
      this.#went(toHash(this.#experiment(true)), false);
      const there = (name) => this.#runs.list.every(({ trajectory: t }) => !t || t[name] || (name === "error_of_energy" && t.energy));
      if (this.#runs.outcomes && drawnOf(this.#scene.axes, kindsOf(this.#scene.problem)).every(there)) this.#showPlanes();
      else this.request();
    });
    for (const choice of ["#field", "#level"]) find(choice).addEventListener("change", () => {
      this.#went(toHash(this.#experiment(true)), false);
      this.#redraw();
    });
    find("#experiment").addEventListener("slide", () => this.#follow());
    find("#experiment").addEventListener("change", ({ target }) => {
      if (target.closest("#studies")) this.#went(toHash(this.#experiment(true)), true);
      else if (!target.closest("#problem, #preset, #axes, #motion, #starts, .curl, #own")) this.request();
    });
    find("#even").addEventListener("click", () => {
      this.#panes.even(this.#runs.outcomes);
      this.request();
    });
    find("#continue").addEventListener("click", () => {
      const ended = this.#runs.list.find(({ outcome }) => outcome?.final);
      if (ended) this.#scene.goOn(ended.outcome.final);
      this.request();
    });
    find("#stop").addEventListener("click", () => this.#stop());
  }
}
