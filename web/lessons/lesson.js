// One lesson on the screen: its words, its runs, one control to move, and the way to the next.
import { simulate } from "../service/api.js";
import { named, text } from "../language/texts.js";
import { benchLink } from "../service/link.js";
import { Live } from "../service/live.js";
import { equalWork, rounded, workSetting } from "../service/work.js";
import { element, faultText, prose } from "../forms/forms.js";
import { Player } from "../forms/player.js";
import { slider } from "../forms/sliders.js";
import { colourOf, title } from "../catalogue/card.js";
import { Figures } from "./figures.js";
import { fill } from "./legend.js";
import { lessons } from "./lessons.js";
import { Portrait } from "./portrait.js";
import { answersTo, coarse, controlled, measureOf, remembering, requestOf } from "./requests.js";
import { Study } from "./study.js";
import { paceOf } from "./views.js";

const find = (selector) => document.querySelector(`#lesson ${selector}`);
export class Lesson {
  #catalogue;
  #go; // (id, state, kept) of another lesson, or of this one with another state
  #lesson = null;
  #state = {};
  #runs = [];
  #control = null;
  #study = null;
  #moves = false; // whether what was measured last was asked for by a hand on the control
  #simulate = remembering(simulate);
  #live = new Live((asked, signal) => answersTo(asked.lesson, asked.requests, this.#simulate, signal, (answers) => this.#grow(answers, asked, signal)),
                   (answers, asked) => this.#show(answers, asked));
  #measuring = new Live(({ study, asked, moves }, signal) => study.run(asked, signal, () => this.#seen(), moves), () => this.#shown());
  #figures = new Figures(find("#figures"), (t) => this.#player.playing || this.#figures.at(t ?? this.#player.time, t !== null));
  #player = new Player(find(".player"), (t) => this.#figures.at(t));

  constructor(catalogue, go) {
    this.#catalogue = catalogue;
    this.#go = go;
    for (const [i, { id, group }] of lessons.entries()) {
      const claim = text(`lesson.${id}.title`);
      if (group) {
        find("#which").append(element("optgroup", { label: text(`group.${group}`) }));
        find("#gallery").append(element("section", {}, element("h3", { textContent: text(`group.${group}`) }), element("ol", { start: i + 1 })));
      }
      find("#which").lastChild.append(element("option", { value: id, textContent: `${i + 1}. ${claim}` }));
      find("#gallery").lastChild.lastChild.append(element("li", {}, element("a", { href: `#lesson=${id}`, textContent: claim })));
    }
    addEventListener("resize", () => this.#fit());
    find("#which").addEventListener("change", (event) => go(event.target.value));
    find("#previous").addEventListener("click", () => this.turn(-1));
    find("#next").addEventListener("click", () => this.turn(1));
    find("#equal-work").addEventListener("click", () => this.#even(equalWork(this.#runs)));
    find("#equal-step").addEventListener("click", () =>
      this.#even(this.#lesson.runs.map(() => this.#runs[0].scheme[workSetting(this.#runs[0].scheme)])));
  }

  /** Shows the lesson `id`, the control as `state` says: `{set, steps}`. */
  open(id, state = {}) {
    const again = this.#lesson?.id === id;
    this.#lesson = lessons.find((lesson) => lesson.id === id) ?? lessons[0];
    this.#state = state;
    this.#busy(true);
    if (!again) this.#build();
    else this.#control?.set(this.#setting());
    this.#ask(true);
    return this.#lesson.id === id;
  }

  close() {
    this.#live.stop();
    this.#measuring.stop();
    this.#player.rest();
  }

  turn(by) {
    const at = lessons.indexOf(this.#lesson) + by;
    if (lessons[at]) this.#go(lessons[at].id);
  }

  /** Keys of a lecture: arrows turn, space plays. */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input, select, textarea")) return;
    const acts = { ArrowRight: () => this.turn(1), ArrowLeft: () => this.turn(-1), PageDown: () => this.turn(1),
                   PageUp: () => this.turn(-1) };
    if (!event.target.closest("button, a, summary")) acts[" "] = () => this.#player.toggle();
    if (!acts[event.key]) return;
    event.preventDefault();
    acts[event.key]();
  }

  draw() {
    this.#fit();
    this.#figures.draw();
    this.#study?.draw();
  }

  /**
   * Makes the pictures smaller by the lines beyond the first of each text above them. In a presentation the words beside the
   * picture are made as large as there is room for all of them.
   */
  #fit() {
    const beyond = (node) => node.offsetHeight - parseFloat(getComputedStyle(node).lineHeight);
    find("#figures").style.setProperty("--more-words", `${Math.max(0, beyond(find("#claim"))) + Math.max(0, beyond(find("#look")))}px`);
    const beside = find(".beside"), present = document.documentElement.classList.contains("present");
    beside.style.zoom = "";
    const cut = () => beside.scrollHeight > beside.clientHeight + 1;
    for (let size = 0.97; present && cut() && size > 0.6; size -= 0.03) beside.style.zoom = String(size);
  }

  // ---- what there is

  get #problem() {
    return this.#catalogue.problems.find(({ id }) => id === (this.#lesson.scene ?? measureOf(this.#lesson, {})).problem.id);
  }

  #build() {
    const { id, views = [], runs = [], control, study, portrait } = this.#lesson, at = lessons.indexOf(this.#lesson);
    find("#which").value = this.#lesson.id;
    find("#previous").disabled = at === 0;
    find("#next").disabled = at === lessons.length - 1;
    find("#claim").textContent = text(`lesson.${id}.title`);
    find("#look").replaceChildren(...prose(text(`lesson.${id}.look`)));
    find("#see").replaceChildren(...prose(text(`lesson.${id}.see`)));
    find("#legend").replaceChildren();
    this.#fit();
    this.#runs = [];
    this.#player.rest();
    this.#measuring.stop();
    this.#figures.build(this.#lesson, runs.map((_, i) => this.#titleOf(i)));
    const figures = find("#figures");
    this.#study = study ? new Study(figures, this.#catalogue.schemes)
      : portrait ? new Portrait(figures, this.#lesson, portrait.keep.includes("final")) : null;
    find(".player").hidden = views.every(({ bins }) => bins);
    this.#control = control ? slider(named("term", control.label), control, this.#setting(), (value, done) => this.#move(value, done)) : null;
    find("#control").replaceChildren(...(this.#control ? [this.#control.node] : []));
    const schemes = runs.map(({ scheme = {} }) => scheme), differ = new Set(schemes.map(({ id }) => id)).size > 1;
    const comparable = runs.length > 1 && (control.sets === "steps" || differ) && schemes.every(workSetting);
    find("#equal-work").hidden = find("#equal-step").hidden = !comparable;
  }

  #titleOf(i) {
    const { name, scheme } = this.#lesson.runs[i], request = requestOf(this.#lesson, i, this.#state);
    return name ? named("term", name) : title(this.#catalogue.schemes.find(({ id }) => id === scheme.id), request.scheme);
  }

  /** Where the control stands. */
  #setting() {
    return controlled(this.#lesson, this.#state, this.#problem);
  }

  #move(value, done) {
    if (this.#lesson.control.sets === "steps") {
      const own = this.#lesson.runs.map(({ scheme }) => scheme[workSetting(scheme)]), now = this.#state.steps ?? own;
      this.#state = { steps: now.map((step) => rounded((step / now[0]) * value, 4)) };
    } else {
      this.#state = { ...this.#state, set: value };
    }
    if (done) this.#go(this.#lesson.id, this.#state, true);
    this.#ask(false, done ? undefined : coarse);
  }

  #even(steps) {
    if (!this.#runs.length || steps.includes(null)) return;
    this.#state = { ...this.#state, steps };
    if (this.#lesson.control.sets === "steps") this.#control.set(steps[0]);
    this.#go(this.#lesson.id, this.#state, true);
    this.#ask(true);
  }

  // ---- what is run

  #busy(busy) {
    document.querySelector("#lesson").setAttribute("aria-busy", String(busy));
  }

  #ask(urgent, samples) {
    this.#busy(true);
    const study = this.#study;
    if (study) {
      const asked = measureOf(this.#lesson, this.#state);
      find("#to-bench").href = benchLink(study.requests(asked));
      const moves = samples === coarse, follows = moves && this.#moves;
      this.#moves = moves;
      return this.#measuring.ask({ study, asked, moves }, !follows);
    }
    const requests = this.#lesson.runs.map((_, i) => requestOf(this.#lesson, i, this.#state, samples));
    const brief = samples === coarse && this.#lesson.brief;
    this.#live.ask({ requests, first: !this.#runs.length, lesson: this.#lesson, brief }, urgent);
  }

  /** Draws the runs that come first, if there is no picture yet. */
  #grow(answers, asked, signal) {
    if (signal.aborted || asked.lesson !== this.#lesson || this.#runs.length || answers.some(({ faults }) => faults)) return;
    this.#draw(answers, asked);
    this.#seen();
  }

  #draw(answers, { requests, lesson, brief }) {
    const runs = answers.map(({ outcome }, i) => ({
      title: this.#titleOf(i), colour: colourOf(i), outcome, trajectory: outcome.trajectory, scheme: outcome.scheme,
      parameters: outcome.problem, request: requests[i],
    }));
    const symbol = (name) => this.#problem?.variables.find((card) => card.name === name)?.symbol || name;
    this.#figures.show(lesson, runs, symbol);
    fill(find("#legend"), runs, lesson);
    const times = runs.flatMap(({ outcome, trajectory: { t } }) => [t[0], t.at(-1)].map((v) => v / paceOf(outcome, lesson.pace)));
    if (!brief && !lesson.views.every(({ bins }) => bins)) this.#player.span(Math.min(...times), Math.max(...times), lesson.pace && text("player.periods"));
    return runs;
  }

  #show(answers, asked) {
    const { requests, first, lesson } = asked;
    if (lesson !== this.#lesson) return;
    const refused = answers.flatMap(({ faults = [] }) => faults);
    find(".wrong").textContent = refused.map(faultText)[0] ?? "";
    if (refused.length) {
      if (refused.some(({ lost }) => lost)) setTimeout(() => lesson === this.#lesson && this.#ask(true), 2000);
      return this.#busy(false); // the last good picture stays
    }
    this.#runs = this.#draw(answers, asked);
    if (first) this.#player.begin();
    const [{ x, y }] = lesson.views, forth = requests.filter((_, i) => lesson.runs[i].back === undefined);
    find("#to-bench").href = benchLink(forth, x?.endsWith("_wrapped") ? { x, y } : {}, forth.length < requests.length);
    this.#shown();
  }

  /** Dispatches "seen": the lesson has a picture, to which a lesson that measures adds more. */
  #seen() {
    document.dispatchEvent(new CustomEvent("seen", { detail: { lesson: this.#lesson.id } }));
  }

  #shown() {
    this.#seen();
    this.#busy(this.#live.waiting || this.#measuring.waiting);
    this.#fit();
    document.dispatchEvent(new CustomEvent("shown", { detail: { lesson: this.#lesson.id, runs: this.#runs.map(({ outcome }) => outcome),
                                                                study: this.#study?.outcome } }));
  }
}
