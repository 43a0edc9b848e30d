// The panes of the workbench: up to six runs, each with a name, which stays, and a scheme.
import { names } from "../service/link.js";
import { custom } from "../service/text.js";
import { equalWork } from "../service/work.js";
import { Pane } from "./pane.js";

const find = (selector) => document.querySelector(selector);

export class Panes {
  #schemes;
  #hovered;
  #changed;
  #problem = null;
  #list = [];

  /** `hovered(t)`: a hand points at a time of a run; `changed()`: there is one more or one less. */
  constructor(schemes, hovered, changed) {
    this.#schemes = schemes;
    this.#hovered = hovered;
    this.#changed = changed;
    find("#add").addEventListener("click", () => this.#add());
  }

  /** How many there are at least. */
  get #least() {
    return this.#problem.id === custom ? 1 : 2;
  }

  get list() {
    return this.#list;
  }

  /** Loads the panes that an experiment names, with the schemes that fit the problem: at least two, or one for a scene as text. */
  load(problem, experiment) {
    this.#problem = problem;
    const wanted = names.filter((name, i) => i < this.#least || experiment[name]);
    this.#list = wanted.map((name) => this.#list.find((pane) => pane.name === name) ?? this.#made(name));
    for (const pane of this.#list) pane.offer(problem, this.#schemes, experiment[pane.name]);
    this.#place();
  }

  /** The schemes by the names of the runs, of `changed` parameters only what has not its default. */
  chosen(changed = false) {
    return Object.fromEntries(this.#list.map((pane) => [pane.name, pane.chosen(changed)]));
  }

  /** Sets steps with which all runs do as much work as the first. */
  even(outcomes) {
    const settings = equalWork(this.#list.map(({ name }) => ({ outcome: outcomes?.[name], scheme: outcomes?.[name]?.scheme ?? {} })));
    this.#list.forEach((pane, i) => settings[i] && pane.refineTo(settings[i]));
  }

  #made(name) {
    const pane = new Pane(name, name === "B" ? 2 : 1, this.#hovered);
    pane.node.querySelector(".remove").addEventListener("click", () => {
      this.#list = this.#list.filter((other) => other !== pane);
      this.#place();
      this.#changed();
    });
    return pane;
  }

  #add() {
    const name = names.find((free) => !this.#list.some((pane) => pane.name === free)), like = this.#list.at(-1).chosen();
    this.#list = [...this.#list, this.#made(name)].sort((a, b) => (a.name < b.name ? -1 : 1));
    this.#list.find((pane) => pane.name === name).offer(this.#problem, this.#schemes, like);
    this.#place();
    this.#changed();
  }

  #place() {
    find("#panes").replaceChildren(...this.#list.map(({ node }) => node));
    find("#add").disabled = this.#list.length === names.length;
    for (const { node } of this.#list) node.querySelector(".remove").hidden = this.#list.length <= this.#least;
  }
}
