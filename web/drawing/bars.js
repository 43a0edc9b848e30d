// The energy of bodies as bars in the colour of each run: kinetic, potential, and lost since the start.
import { text } from "../language/texts.js";

const square = (v) => v * v;
/** The kinetic and the potential energy of a state; the latter is zero at the equilibrium. */
const energies = {
  pendulum: ({ q, p }, { gravity = 1, length = 1 }) => [square(p) / 2, (gravity / length) * (1 - Math.cos(q))],
  spring: ({ q, p }, { mass = 1, stiffness = 1 }) => [square(p) / 2 / mass, (stiffness * square(q)) / 2],
  double_pendulum: ({ theta1, theta2, energy }, { m1, m2, l1, l2, gravity }) => {
    const [first, second] = [(m1 + m2) * gravity * l1, m2 * gravity * l2];
    const potential = first * (1 - Math.cos(theta1)) + second * (1 - Math.cos(theta2));
    return [energy + first + second - potential, potential];
  },
};
const names = ["kinetic", "potential", "lost"];

/** `[kinetic, potential, lost]` energy of a body in a state, `null` if it is unknown. */
export function energyOf(body, state, parameters, start = state) {
  const of = (at) => energies[body]?.(at, parameters), now = of(state), before = of(start);
  if (![now, before].every((values) => values?.every(Number.isFinite))) return null;
  return [...now, before[0] + before[1] - now[0] - now[1]];
}

/** Draws the bars of `[{ink, values}]` in a box of pixels, whose full height is the value `most`. */
export function bars(pen, { left, top, width, height }, all, most, { ink, size, font }) {
  const group = width / 3, bar = Math.min(18, (0.8 * group) / all.length), room = height - 1.6 * size;
  pen.font = `${Math.min(size, group / 5)}px ${font}`; // of the longest name
  pen.textAlign = "center";
  pen.textBaseline = "alphabetic";
  names.forEach((name, k) => {
    const middle = left + group * (k + 0.5), first = middle - (bar * all.length) / 2;
    all.forEach(({ ink: own, values }, i) => {
      const high = room * Math.max(0, Math.min(1, values[k] / most));
      pen.fillStyle = own;
      pen.fillRect(first + i * bar, top + room - high, bar - 1, high);
    });
    pen.fillStyle = ink;
    pen.fillRect(middle - 0.45 * group, top + room, 0.9 * group, 1);
    pen.fillText(text(`energy.${name}`), middle, top + height - 0.3 * size);
  });
}
