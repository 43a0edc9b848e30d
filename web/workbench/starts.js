// The starts of a portrait: further starts beside that of the scene, set by clicks into its picture, each run with every scheme
// shown. A list of them lets keys add, move and remove them.
import { text, typed as read } from "../language/texts.js";
import { simulate } from "../service/api.js";
import { Live } from "../service/live.js";
import { rounded } from "../service/work.js";
import { element } from "../forms/forms.js";

const find = (selector) => document.querySelector(selector);
const most = 40, atOnce = 2; // starts; requests under way

export class Starts {
  #axes = null; // the variables on the axes, null where a picture takes no starts
  #of = ""; // the variables of those that there are
  #list = []; // [[x, y]]
  #changed; // (done) of the list
  #came;
  #outcomes = new Map(); // by request, as text
  #asked = new Map(); // by the name of a run, the requests of its starts
  #last = new Map(); // by the name of a run and the number of a start: what is seen of one that moves
  #live = new Live((requests, signal) => this.#run(requests, signal), () => (find("#starts").ariaBusy = String(this.#live.waiting)));

  /** `changed(done)`: a start was added, moved (by a hand that is not `done`) or removed; `came()`: a run of one. */
  constructor(changed, came) {
    this.#changed = changed;
    this.#came = came;
    find("#add-start").addEventListener("click", () => this.add(this.#free()));
    find("#no-starts").addEventListener("click", () => this.#set([]));
  }

  /** From and to the form in a link, `{of: "q,p", at: "1,0,2,0.5"}`. */
  load({ of = "", at = "" } = {}) {
    const numbers = at.split(",").map(Number), pairs = numbers.slice(0, 2 * most).flatMap((x, i) => (i % 2 ? [] : [[x, numbers[i + 1]]]));
    this.#of = of;
    this.#list = of ? pairs.filter((pair) => pair.every(Number.isFinite)) : [];
    this.#outcomes.clear();
    this.#last.clear();
  }
  get linked() {
    return this.#list.length ? { of: this.#of, at: this.#list.flat().join(",") } : {};
  }

  /** Shows the list for pictures over these variables; hides it for null, because those pictures take no starts. */
  offer(axes) {
    this.#axes = axes;
    find("#starts").hidden = !axes;
    this.#spell();
  }

  /** The starts on the axes that are shown. */
  get #shown() {
    return this.#axes && this.#of === String(this.#axes) ? this.#list : [];
  }

  add([x, y]) {
    if (this.#axes && this.#shown.length < most) this.#set([...this.#shown, [rounded(x, 4), rounded(y, 4)]]);
  }

  /** Removes the newest start: a double click sets none. */
  takeBack() {
    this.#set(this.#shown.slice(0, -1));
  }

  move(i, [x, y], done) {
    this.#list[i] = [rounded(x, 4), rounded(y, 4)];
    if (done) this.#spell();
    this.#changed(done);
  }

  #set(list) {
    this.#of = String(this.#axes);
    this.#list = list;
    this.#last.clear();
    this.#spell();
    this.#changed(true);
  }

  /** A place for a start added by the button: beside the last one. */
  #free() {
    const values = this.#axes.map((name) => Number(find(`#initial [data-name="${CSS.escape(name)}"]`)?.value) || 0);
    const [x, y] = this.#shown.at(-1) ?? values;
    return [x, y + 0.25];
  }

  /** Writes the list as fields, which are made anew only if their number or names change, so that a field keeps the focus. */
  #spell() {
    const list = find("#start-list"), starts = this.#shown, names = this.#axes ?? [];
    if (list.children.length !== starts.length || list.dataset.of !== String(names)) {
      const field = (i, k) => element("label", {}, names[k], element("input", { type: "text", inputMode: "decimal", ariaLabel: text("starts.field_of", { name: names[k], i: i + 1 }) }));
      const rows = starts.map((_, i) => element("li", {}, field(i, 0), field(i, 1),
        element("button", { type: "button", textContent: "×", title: text("starts.remove"), ariaLabel: text("starts.remove_one", { i: i + 1 }) })));
      list.replaceChildren(...rows);
      list.dataset.of = String(names);
      rows.forEach((row, i) => {
        row.querySelector("button").addEventListener("click", () => {
          this.#set(this.#shown.filter((_, k) => k !== i));
          (list.children[Math.min(i, list.children.length - 1)]?.querySelector("button") ?? find("#add-start")).focus();
        });
        row.addEventListener("change", (event) => {
          event.stopPropagation();
          const typed = [...row.querySelectorAll("input")].map(({ value }) => (value.trim() === "" ? NaN : read(value)));
          if (typed.every(Number.isFinite)) this.move(i, typed, true);
          else this.#spell();
        });
      });
    }
    [...list.children].forEach((row, i) => row.querySelectorAll("input").forEach((input, k) => (input.value = String(starts[i][k]))));
    find("#no-starts").hidden = starts.length === 0;
  }

  /** Asks for the starts of runs `[[name, request]]`; if `follow`, after the request in flight. */
  ask(runs, follow) {
    const [x, y] = this.#axes ?? [];
    this.#asked = new Map(runs.flatMap(([name, request]) => this.#shown.map(([a, b], i) => (
      [`${name}${i}`, JSON.stringify({ ...request, initial: { ...request.initial, [x]: a, [y]: b } })]))));
    const wanted = new Set(this.#asked.values());
    for (const key of this.#outcomes.keys()) if (!wanted.has(key)) this.#outcomes.delete(key);
    const left = [...this.#asked].filter(([, key]) => !this.#outcomes.has(key));
    find("#starts").ariaBusy = String(left.length > 0);
    if (left.length || !follow) this.#live.ask(left, !follow);
  }

  stop() {
    this.#live.stop();
  }

  #run(requests, signal) {
    const left = [...requests];
    const one = async () => {
      while (left.length) {
        const [start, key] = left.shift(), { outcome = null } = await simulate(JSON.parse(key), signal);
        if ([...this.#asked.values()].includes(key)) this.#outcomes.set(key, outcome);
        this.#last.set(start, outcome?.trajectory);
        this.#came();
      }
    };
    return Promise.all(Array.from({ length: atOnce }, one));
  }

  /** The starts of a run, `[{at: [x, y], trajectory}]`: the previous trajectory until the new one comes, none if it was refused. */
  of(name) {
    return this.#shown.map((at, i) => {
      const start = `${name}${i}`, key = this.#asked.get(start);
      return { at, trajectory: this.#outcomes.has(key) ? this.#outcomes.get(key)?.trajectory : this.#last.get(start) };
    });
  }
}
