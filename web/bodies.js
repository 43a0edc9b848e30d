// Scenes that people know by sight, as bodies: what a state looks like. One canvas holds those of all runs.
import { valueAt } from "./scale.js";

const bob = (pen, x, y, r) => {
  pen.beginPath();
  pen.arc(x, y, r, 0, 2 * Math.PI);
  pen.fill();
};
const rod = (pen, ...points) => {
  pen.beginPath();
  points.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.stroke();
};

/** Each draws a state in a square from −1 to 1, y up; `i` of `n` runs. */
const drawings = {
  pendulum(pen, { q }) {
    const [x, y] = [0.85 * Math.sin(q), -0.85 * Math.cos(q)];
    rod(pen, [0, 0], [x, y]);
    bob(pen, x, y, 0.09);
  },
  double_pendulum(pen, { theta1, theta2 }) {
    const [x, y] = [0.45 * Math.sin(theta1), -0.45 * Math.cos(theta1)];
    const [u, v] = [x + 0.45 * Math.sin(theta2), y - 0.45 * Math.cos(theta2)];
    rod(pen, [0, 0], [x, y], [u, v]);
    bob(pen, x, y, 0.06);
    bob(pen, u, v, 0.08);
  },
  spring(pen, { q }, i, n) {
    const y = 0.7 - (1.4 * (i + 0.5)) / n, end = Math.max(-0.8, Math.min(0.85, 0.35 * q));
    const coils = 12, points = Array.from({ length: coils + 1 }, (_, k) => {
      const bend = k === 0 || k === coils ? 0 : k % 2 ? 0.07 : -0.07;
      return [-0.98 + ((end + 0.98 - 0.08) * k) / coils, y + bend];
    });
    rod(pen, ...points);
    pen.fillRect(end - 0.08, y - 0.1, 0.16, 0.2);
  },
  moon(pen, { q }, i, n, t) {
    const size = 0.8 / n, place = n === 1 ? 0 : -0.65 + (1.3 * i) / (n - 1);
    pen.save();
    pen.translate(place, 0);
    pen.rotate(q - t); // as seen by the planet, which the moon goes round once in 2π
    pen.beginPath();
    pen.ellipse(0, 0, size, 0.65 * size, 0, 0, 2 * Math.PI);
    pen.fill();
    rod(pen, [0, 0], [1.35 * size, 0]);
    pen.restore();
  },
};

/** Which drawing a problem has. */
export const bodyOf = (problem) => ({
  pendulum: "pendulum", damped_pendulum: "pendulum", double_pendulum: "double_pendulum", harmonic_oscillator: "spring",
  damped_oscillator: "spring", driven_oscillator: "spring", modulated_oscillator: "spring", generic_oscillator: "spring",
  spin_orbit: "moon",
})[problem];

/** The bodies on a `canvas`: `show(body, runs)`, then `at(t)`. */
export class Bodies {
  #canvas;
  #body = null;
  #runs = [];
  #time = null;

  constructor(canvas) {
    this.#canvas = canvas;
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** `runs`: `[{colour, trajectory}]`. */
  show(body, runs) {
    this.#body = body;
    this.#runs = runs;
    this.draw();
  }

  at(t) {
    this.#time = t;
    this.draw();
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (!width || !height || !this.#body) return;
    const sharp = window.devicePixelRatio || 1, style = getComputedStyle(this.#canvas), size = Math.min(width, height) / 2.1;
    this.#canvas.width = Math.round(width * sharp);
    this.#canvas.height = Math.round(height * sharp);
    const pen = this.#canvas.getContext("2d");
    pen.setTransform(size * sharp, 0, 0, -size * sharp, (width / 2) * sharp, (height / 2) * sharp);
    pen.lineWidth = 0.03;
    pen.lineJoin = "round";
    pen.strokeStyle = pen.fillStyle = style.getPropertyValue("--soft-ink");
    if (this.#body.includes("pendulum")) bob(pen, 0, 0, 0.03);
    this.#runs.forEach(({ colour, trajectory }, i) => {
      const t = Math.min(this.#time ?? Infinity, trajectory.t.at(-1));
      const state = Object.fromEntries(Object.keys(trajectory).map((name) => [name, valueAt(trajectory.t, trajectory[name], t)]));
      if (Object.values(state).includes(undefined)) return;
      pen.strokeStyle = pen.fillStyle = style.getPropertyValue(colour);
      pen.globalAlpha = 0.85;
      drawings[this.#body](pen, state, i, this.#runs.length, t);
    });
  }
}
