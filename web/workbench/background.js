// What lies behind a portrait where that is chosen: level curves of H and where the motion rests. One step of Euler's method,
// which leads along the velocity itself, from every place of a grid tells both.
import { ensemble } from "../service/api.js";
import { Live } from "../service/live.js";
import { energyKind, isAutonomous, motion } from "../catalogue/card.js";
import { fieldPicture } from "../drawing/field.js";

const side = 121, step = 1e-6;
const box = document.querySelector("#field");

/** Whether the plane of two variables tells all of a motion. */
const isPlanar = (problem, axes) => Boolean(axes) && isAutonomous(problem) && motion(problem).length === 2 &&
  problem.schemes.includes("explicit_euler");

export class Background {
  #key = "";
  #field = null;
  #live = new Live((asked, signal) => this.#answer(asked, signal), (field) => {
    this.#field = field;
    this.#came();
  });
  #came;

  /** `came()`: there is another picture. */
  constructor(came) {
    this.#came = came;
  }

  get chosen() {
    return box.checked;
  }
  set chosen(on) {
    box.checked = on;
  }

  /** The picture, and where the motion rests, `[{at, saddle}]`; null where there is none. */
  get field() {
    return this.#field;
  }

  /** Asks for what lies behind the plane of `axes` between `low` and `high`, `{x, y}`; without a `plane` for nothing. */
  ask(problem, scene, axes, plane) {
    box.parentElement.hidden = !isPlanar(problem, axes);
    const wanted = box.checked && plane && isPlanar(problem, axes), { low, high } = plane ?? {};
    const key = wanted ? JSON.stringify([scene, axes, low, high]) : "";
    if (key === this.#key) return;
    this.#key = key;
    this.#live.stop();
    if (!wanted) {
      this.#field = null;
      return this.#came();
    }
    const grid = (axis) => ({ grid: [low[axis], high[axis], side] }), energy = energyKind(problem) === "error" ? ["energy"] : [];
    this.#live.ask({ axes, low, high, request: { ...scene, scheme: { id: "explicit_euler", step }, until: { steps: 1 },
      columns: [...axes, ...energy], keep: ["final"], members: { vary: { [`/initial/${axes[0]}`]: grid("x"), [`/initial/${axes[1]}`]: grid("y") } } } }, true);
  }

  async #answer({ axes, low, high, request }, signal) {
    const columns = request.columns.map(() => Array(side * side).fill(NaN));
    const { faults } = await ensemble(request, signal, ({ kind, final }) => {
      if (kind === "block") final.index.forEach((member, k) => request.columns.forEach((name, c) => (columns[c][member] = final[name][k] ?? NaN)));
    });
    if (faults) return null;
    const [x, y, level] = columns, at = (axis, k) => low[axis] + ((high[axis] - low[axis]) * k) / (side - 1);
    const u = x.map((v, member) => v - at("x", Math.floor(member / side))), v = y.map((w, member) => w - at("y", member % side));
    return fieldPicture({ x: [low.x, high.x], y: [low.y, high.y], n: side, level, u, v });
  }
}
