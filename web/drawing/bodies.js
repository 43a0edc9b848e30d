// Drawings of well-known scenes as bodies in a given state. One canvas shows the bodies of all runs.
import { bars, energyOf } from "./bars.js";
import { extent, valueAt } from "./mapping.js";
import { drawStated, fitting } from "./stated.js";

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

/** Draws the sun, at the origin, in a picture of the plane of a planet. */
export function sun(pen, map, colour) {
  pen.fillStyle = colour("--sun");
  bob(pen, map.x(0), map.y(0), 5);
}

/** Each draws a state in a square from −1 to 1, y up: `i` of `n` runs, `place` of a planet, `wide` half the width there is. */
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
  spring(pen, { q }, { i, n, wide }) {
    const y = 0.9 - (1.8 * (i + 0.5)) / n, wall = -0.98 * wide, end = wide * Math.max(-0.8, Math.min(0.85, 0.35 * q));
    const coils = 12, points = Array.from({ length: coils + 1 }, (_, k) => {
      const bend = k === 0 || k === coils ? 0 : k % 2 ? 0.1 : -0.1;
      return [wall + ((end - wall - 0.12) * k) / coils, y + bend];
    });
    rod(pen, [wall, y - 0.2], [wall, y + 0.2]);
    rod(pen, ...points);
    pen.fillRect(end - 0.12, y - 0.15, 0.24, 0.3);
  },
  planet(pen, { x, y }, { place }) {
    bob(pen, ...place(x, y), 0.09);
  },
  moon(pen, { q }, { i, n, t, wide }) {
    const size = Math.min(0.6, (0.8 * wide) / n), place = n === 1 ? 0 : wide * (-0.65 + (1.3 * i) / (n - 1));
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

/** Which drawing a problem has: texts state their bodies. */
export const bodyOf = ({ id }) => ({
  pendulum: "pendulum", damped_pendulum: "pendulum", double_pendulum: "double_pendulum", harmonic_oscillator: "spring",
  damped_oscillator: "spring", driven_oscillator: "spring", modulated_oscillator: "spring", generic_oscillator: "spring",
  spin_orbit: "moon", kepler: "planet", kepler_3d: "planet", damped_kepler: "planet", perturbed_kepler: "planet",
}[id]);

/** The map of positions of planets and their sun into the square. An escaping run is cut at twice the smallest extent of a run. */
function placing(runs) {
  const withSun = ([low, high]) => [Math.min(0, low), Math.max(0, high)];
  const ends = ["x", "y"].map((name) => runs.map(({ trajectory }) => withSun(extent(trajectory[name]))));
  const size = (i) => Math.max(...ends.map((axis) => axis[i][1] - axis[i][0])), least = Math.min(...runs.map((_, i) => size(i)));
  const axes = ends.map((axis) => {
    const [low, high] = axis.reduce((a, b, i) => (size(i) > 2 * least ? a : [Math.min(a[0], b[0]), Math.max(a[1], b[1])]), [0, 0]);
    return { middle: (low + high) / 2, size: high - low };
  });
  const scale = 1.7 / Math.max(...axes.map((axis) => axis.size));
  return (x, y) => [(x - axes[0].middle) * scale, (y - axes[1].middle) * scale];
}

/** The bodies on a `canvas`: `show(body, runs)`, then `at(t)`. */
export class Bodies {
  #canvas;
  #body = null;
  #runs = [];
  #place = null;
  #time = null;

  constructor(canvas) {
    this.#canvas = canvas;
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** `body`: a drawing by its name, or the bodies that the scene states; `runs`: `[{colour, trajectory, parameters}]`. */
  show(body, runs) {
    this.#body = body;
    this.#runs = runs;
    this.#place = Array.isArray(body) && runs.length ? fitting(body, runs) : body === "planet" && runs.length ? placing(runs) : null;
    this.draw();
  }

  at(t) {
    this.#time = t;
    this.draw();
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (!width || !height || !this.#body) return;
    const sharp = window.devicePixelRatio || 1, style = getComputedStyle(this.#canvas);
    const states = this.#runs.map((run) => this.#stateOf(run)), measured = this.#energies(states);
    const beside = measured.length ? Math.min(0.4 * width, 17 * parseFloat(style.fontSize)) : 0; // for the bars
    const whole = width - beside, size = Math.min(whole, height) / 2.1;
    this.#canvas.width = Math.round(width * sharp);
    this.#canvas.height = Math.round(height * sharp);
    const pen = this.#canvas.getContext("2d");
    pen.setTransform(size * sharp, 0, 0, -size * sharp, (whole / 2) * sharp, (height / 2) * sharp);
    pen.lineWidth = 0.03;
    pen.lineJoin = "round";
    pen.strokeStyle = pen.fillStyle = style.getPropertyValue("--soft-ink");
    if (this.#body.includes("pendulum")) bob(pen, 0, 0, 0.03);
    const stated = Array.isArray(this.#body);
    if (this.#place && !stated) {
      pen.fillStyle = style.getPropertyValue("--sun");
      bob(pen, ...this.#place(0, 0), 0.12);
    }
    this.#runs.forEach(({ colour }, i) => {
      if (!states[i]) return;
      pen.strokeStyle = pen.fillStyle = style.getPropertyValue(colour);
      pen.globalAlpha = 0.85;
      if (stated) drawStated(pen, this.#body, states[i], this.#place, style.getPropertyValue("--sun"));
      else drawings[this.#body](pen, states[i], { i, n: this.#runs.length, t: states[i].t, wide: whole / 2 / size, place: this.#place });
    });
    if (!measured.length) return;
    pen.globalAlpha = 1;
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    const most = Math.max(...measured.map(({ values }) => values.reduce((a, b) => a + b)));
    bars(pen, { left: whole, top: 0.1 * height, width: beside - 6, height: 0.85 * height },
         measured.map(({ colour, values }) => ({ ink: style.getPropertyValue(colour), values })), most || 1,
         { ink: style.getPropertyValue("--ink"), size: Math.round(0.82 * parseFloat(style.fontSize)), font: style.fontFamily });
  }

  /** The state of a run at the present time, or null if it is unknown. */
  #stateOf({ trajectory }) {
    const t = this.#time ?? trajectory.t.at(-1);
    const state = Object.fromEntries(Object.keys(trajectory).map((name) => [name, valueAt(trajectory.t, trajectory[name], t)]));
    return Object.values(state).includes(undefined) ? null : state;
  }

  /** The energies of the runs; none if that of any run is unknown. */
  #energies(states) {
    const all = this.#runs.map(({ colour, trajectory, parameters = {} }, i) => {
      const start = Object.fromEntries(Object.entries(trajectory).map(([name, values]) => [name, values[0]]));
      return { colour, values: states[i] && energyOf(this.#body, states[i], parameters, start) };
    });
    return all.every(({ values }) => values) ? all : [];
  }
}
