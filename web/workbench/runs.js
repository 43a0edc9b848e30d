// The runs of the workbench: their requests, progress and outcomes. One request is in flight, and
// only the newest of those that came meanwhile follows.
import { text } from "../language/texts.js";
import { simulate } from "../service/api.js";
import { Live } from "../service/live.js";
import { words } from "../forms/forms.js";
import { columns, diagnostics, motion } from "../catalogue/card.js";
import { drawnOf, kindsOf } from "../catalogue/kinds.js";
import { recordOf } from "../catalogue/record.js";
import { statedColumns } from "../catalogue/stated.js";
import { samples } from "./scene.js";

const find = (selector) => document.querySelector(selector);
const values = 1e6; // of what is drawn of a run, at most: many bodies have fewer points each
const beside = 2000; // points of a start beside the scene's own
const coarse = 500; // points of a run while a hand moves a slider
const patience = 300; // ms after which a run is seen while it goes on

/** The outcome of a run that was stopped by the user. */
function cut(outcome) {
  const { trajectory, t, steps } = outcome, last = Object.entries(trajectory).map(([name, values]) => [name, values.at(-1)]);
  return { ...outcome, status: "stopped", stop: { reason: "cancelled", t, detail: text("run.by_hand") }, diagnostics: {}, cost: { steps },
           final: Object.fromEntries(last) };
}

export class Runs {
  #scene;
  #panes;
  #schemes;
  #starts;
  #shown; // ({answers, said, lost, waiting}), and () where a part of a run is to be seen
  #outcomes = null; // those in sight by the names of the runs, null while there are none of this problem
  #since = 0;
  #frame = 0;
  #live = new Live((asked, signal) => this.#answer(asked, signal), (answers, asked) => this.#show(answers, asked));

  constructor(scene, panes, starts, schemes, shown) {
    this.#scene = scene;
    this.#panes = panes;
    this.#starts = starts;
    this.#schemes = schemes;
    this.#shown = shown;
  }

  /** `{name: outcome}`, null while there are none. */
  get outcomes() {
    return this.#outcomes;
  }

  get list() {
    return this.#panes.list.map(({ name, title, colour }) => {
      const outcome = this.#outcomes?.[name];
      return { name, title: `${name}: ${title}`, colour, outcome, trajectory: outcome?.trajectory, parameters: outcome?.problem, starts: this.#starts.of(name) };
    });
  }

  /** Forgets all outcomes, and those still to come, because the scene is another one. */
  forget() {
    this.#live.stop();
    this.#starts.stop();
    this.#cut();
    this.#outcomes = null;
  }

  /** Runs an experiment; `follow`: while a control is dragged, with few points and after the request in flight. */
  ask(now, follow = false) {
    if (!follow) {
      this.#cut();
      this.#starts.stop();
    }
    this.#live.ask({ now, most: follow ? coarse : now.record.samples ?? samples.default }, !follow);
  }

  /** Runs the further starts of an experiment; with auto, each by the scheme that was chosen for the first. */
  askBeside(now, follow = false) {
    const schemes = Object.entries(this.#outcomes ?? {}).map(([name, outcome]) => [name, outcome?.choice ? outcome.scheme : now[name]]);
    this.#starts.ask(schemes.map(([name, scheme]) => [name, this.#requestFor(now, scheme, follow ? coarse : beside)]), follow);
  }

  /** Ends what is in flight; the samples received so far stay. */
  stop() {
    this.#live.stop();
    this.#starts.stop();
    for (const { name } of this.#cut()) this.#panes.list.find((pane) => pane.name === name).tell(this.#outcomes[name]);
  }

  /** Ends the runs under way with the outcomes so far, and returns them. */
  #cut() {
    find("#progress").hidden = true;
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    const under = this.list.filter(({ outcome }) => outcome?.status === "running");
    for (const { name, outcome } of under) this.#outcomes[name] = cut(outcome);
    return under;
  }

  /** The scene in the form of a request. */
  sceneOf({ problem, preset, initial, until: { back: _, ...until } }) {
    return { problem: this.#scene.asked(problem, preset), initial, until };
  }

  /** The request for one run, with `most` points. */
  #requestFor(now, scheme, most) {
    const { problem, initial, until } = this.sceneOf(now), card = this.#schemes.find(({ id }) => id === scheme.id);
    const own = this.#scene.problem, drawn = drawnOf(this.#scene.axes, kindsOf(own));
    const { start, events } = this.#scene, span = until.t === undefined ? this.#scene.span : until.t - start;
    return { problem, initial, scheme, until, record: recordOf(this.#scene, card, scheme, Math.abs(span), Math.min(most, Math.ceil(values / (drawn.length || 1)))),
             columns: columns(own, card, drawn, [...this.#scene.columns, ...statedColumns(own)]), diagnostics: diagnostics(own, span < 0),
             ...(events.length ? { events } : {}) };
  }

  #answer({ now, most }, signal) {
    this.#scene.clearFaults();
    this.#since = performance.now();
    const done = new Map(), from = this.#scene.start, span = now.until.t - from;
    return Promise.all(this.#panes.list.map(async (pane) => {
      pane.clearFaults();
      const request = this.#requestFor(now, now[pane.name], most);
      const answer = await pane.run(request, this.#scene.fields, signal, (outcome) => {
        if (signal.aborted) return;
        done.set(pane.name, (outcome.t - from) / span);
        this.#pass(pane.name, outcome, done);
      });
      done.set(pane.name, 1);
      if (answer.outcome) this.#outcomes = { ...this.#outcomes, [pane.name]: answer.outcome }; // which stays, if others are stopped
      if (now.until.back && answer.outcome) pane.tellBack(await this.#goBack(request, answer.outcome, signal));
      return { ...answer, name: pane.name };
    }));
  }

  /** Runs back from the end of a run to its start, and returns that answer, which stands beside the outcome. */
  async #goBack(request, outcome, signal) {
    const { initial, final, scheme } = outcome, answer = await simulate({ ...request, scheme, initial: final, until: { t: initial.t }, diagnostics: [] }, signal);
    if (!answer.outcome) return answer;
    const missed = Math.max(...motion(this.#scene.problem).map(({ name }) => Math.abs((answer.outcome.final[name] ?? 0) - (initial[name] ?? 0))));
    outcome.back = { ...answer.outcome, missed };
    return answer;
  }

  /** Shows the progress of a run. */
  #pass(name, outcome, done) {
    if (performance.now() - this.#since < patience) return;
    const parts = this.#panes.list.map((pane) => done.get(pane.name) ?? 0);
    find("#progress").hidden = false;
    find("#progress").value = parts.reduce((sum, part) => sum + part, 0) / parts.length;
    if (outcome.trajectory.t.length < 2) return;
    this.#outcomes = { ...this.#outcomes, [name]: outcome };
    this.#frame ||= requestAnimationFrame(() => { // and not put off by what comes faster than frames
      this.#frame = 0;
      this.#shown();
    });
  }

  #show(answers, { now, most }) {
    const kept = this.#outcomes ?? {}, { list } = this.#panes;
    if (list.length !== answers.length || list.some(({ name }, i) => name !== answers[i].name)) return; // another run came or went
    this.#cut();
    this.#outcomes = Object.fromEntries(list.map(({ name }, i) => [name, answers[i].outcome ?? kept[name] ?? null]));
    list.forEach((pane, i) => pane.node.classList.toggle("stale", !answers[i].outcome));
    const lost = answers.some((answer) => answer.lost), came = ({ outcome }) => (outcome ? words(outcome.status) : text("run.refused"));
    const said = lost ? text("run.lost")
      : list.map(({ name }, i) => `${name} ${came(answers[i])}`).join(", ");
    this.#shown({ answers, said, lost, waiting: this.#live.waiting });
    this.askBeside(now, most === coarse);
  }
}
