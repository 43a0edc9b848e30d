// The background of a portrait, if chosen: level curves of H or of a formula, the vector field, and the equilibria.
// All are computed from one step of Euler's method from every point of a grid, because that step is along the velocity.
import { text } from "../language/texts.js";
import { ensemble } from "../service/api.js";
import { Live } from "../service/live.js";
import { faultText } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { energyKind, isAutonomous, motion } from "../catalogue/card.js";
import { fieldPicture } from "../drawing/field.js";

const find = (selector) => document.querySelector(selector);
const side = 121, step = 1e-6;
const field = find("#field"), level = find("#level");
const height = "behind"; // the name of a formula's column

/** Whether the plane of two variables is the whole phase space. */
const isPlanar = (problem, axes) => Boolean(axes) && isAutonomous(problem) && motion(problem).length === 2 &&
  problem.schemes.includes("explicit_euler");

export class Background {
  #key = "";
  #field = null;
  #live = new Live((asked, signal) => this.#answer(asked, signal), (answer) => this.#take(answer));
  #came;

  /** `came()`: there is another picture. */
  constructor(came) {
    this.#came = came;
  }

  /** What stands in a link, `{field: "levels" | "arrows" | "both", level: a formula}`, and back. */
  get chosen() {
    return { ...(field.value ? { field: field.value } : {}), ...(this.#formula ? { level: this.#formula } : {}) };
  }
  set chosen({ field: asked = "", level: formula = "" }) {
    field.value = asked === "true" ? "levels" : asked; // as older links say it
    if (field.selectedIndex < 0) field.value = "";
    level.value = formula;
  }
  get #formula() {
    return level.value.trim();
  }

  /** The picture, with the equilibria `[{at, kind}]`; null where there is none. */
  get field() {
    return this.#field;
  }

  /** Asks for what lies behind the plane of `axes` between `low` and `high`, `{x, y}`; without a `plane` for nothing. */
  ask(problem, scene, axes, plane) {
    const kept = energyKind(problem) === "error", levels = ["levels", "both"].includes(field.value), arrows = ["arrows", "both"].includes(field.value);
    field.parentElement.hidden = !isPlanar(problem, axes);
    level.parentElement.hidden = !isPlanar(problem, axes) || !levels;
    level.placeholder = kept ? "H" : text("starts.level.formula");
    const wanted = field.value && plane && isPlanar(problem, axes), { low, high } = plane ?? {};
    const of = !levels ? [] : this.#formula ? [{ name: height, expression: this.#formula }] : kept ? ["energy"] : [];
    const key = wanted ? JSON.stringify([scene, axes, low, high, of, arrows]) : "";
    if (key === this.#key) return;
    this.#key = key;
    this.#live.stop();
    if (!wanted) return this.#take({ field: null });
    const grid = (axis) => ({ grid: [low[axis], high[axis], side] });
    this.#live.ask({ axes, low, high, arrows, kept, request: { ...scene, scheme: { id: "explicit_euler", step }, until: { steps: 1 },
      columns: [...axes, ...of], keep: ["final"], members: { vary: { [`/initial/${axes[0]}`]: grid("x"), [`/initial/${axes[1]}`]: grid("y") } } } }, true);
  }

  async #answer({ axes, low, high, arrows, kept, request }, signal) {
    const names = request.columns.map((column) => column.name ?? column), columns = names.map(() => Array(side * side).fill(NaN));
    const { faults } = await ensemble(request, signal, ({ kind, final }) => {
      if (kind === "block") final.index.forEach((member, k) => names.forEach((name, c) => (columns[c][member] = final[name][k] ?? NaN)));
    });
    if (faults) return { field: null, faults };
    const [x, y, heights] = columns, at = (axis, k) => low[axis] + ((high[axis] - low[axis]) * k) / (side - 1);
    const u = x.map((v, member) => v - at("x", Math.floor(member / side))), v = y.map((w, member) => w - at("y", member % side));
    return { axes, field: fieldPicture({ x: [low.x, high.x], y: [low.y, high.y], n: side, level: heights, u, v, arrows, kept, parts: names.includes("energy") }) };
  }

  /** Takes the picture of an answer, and shows the list of equilibria or the first fault. */
  #take({ field: made, faults = [] }) {
    this.#field = made;
    find("#level-fault").textContent = faults.map(faultText)[0] ?? "";
    find("#level-fault").classList.toggle("fault", faults.length > 0);
    level.setAttribute("aria-invalid", String(faults.length > 0));
    const places = (made?.rests ?? []).map(({ at, kind }) => `(${at.map((v) => format(v, 3)).join("; ")}) ${text(`rest.${kind}`)}`);
    find("#rests").textContent = places.length ? text("starts.rests", { places: places.join(", ") }) : "";
    this.#came();
  }
}
