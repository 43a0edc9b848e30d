// The bodies that a scene states, `[{at: columns or numbers, linked: [numbers or "pivot"], kind}]`, in a square from −1 to 1.
import { extent } from "./mapping.js";
import { projection } from "./space.js";

const sizes = { bob: 0.07, planet: 0.05, sun: 0.1 };
const seen = projection({ around: -0.65, up: 0.35 });

/** The place of a point in the picture: itself in the plane, its projection in space. */
const flat = (point) => (point.length > 2 ? seen(...point) : point);

/** The map of places into the square, such that all runs fit, and the pivot if a body is linked to it. */
export function fitting(bodies, runs) {
  const axes = bodies[0].at.map((_, k) => {
    const pivot = bodies.some(({ linked = [] }) => linked.includes("pivot")) ? [0] : [];
    const ends = runs.flatMap(({ trajectory }) => bodies.flatMap(({ at }) => extent(trajectory[at[k]] ?? [Number(at[k])])));
    const all = [...ends.filter(Number.isFinite), ...pivot];
    return { low: Math.min(...all), high: Math.max(...all) };
  });
  const middle = axes.map(({ low, high }) => (low + high) / 2), half = Math.max(...axes.map(({ low, high }) => (high - low) / 2)) || 1;
  const far = axes.length > 2 ? 1.25 : 1; // a corner of the box is farther away than its faces
  return (point) => flat(point.map((v, k) => ((v - middle[k]) / half / far) * 0.88));
}

/** Draws the bodies of one run in a state. */
export function drawStated(pen, bodies, state, place, sun) {
  const places = bodies.map(({ at }) => place(at.map((name) => state[name] ?? Number(name))));
  const pivot = place(bodies[0].at.map(() => 0)), own = pen.fillStyle;
  const dot = (at, r) => {
    pen.beginPath();
    pen.arc(...at, r, 0, 2 * Math.PI);
    pen.fill();
  };
  pen.lineWidth = 0.02;
  if (bodies.some(({ linked = [] }) => linked.includes("pivot"))) dot(pivot, 0.03);
  bodies.forEach(({ linked = [] }, i) => linked.forEach((other) => {
    pen.beginPath();
    pen.moveTo(...(other === "pivot" ? pivot : places[other]));
    pen.lineTo(...places[i]);
    pen.stroke();
  }));
  bodies.forEach(({ kind = "bob" }, i) => {
    pen.fillStyle = kind === "sun" ? sun : own;
    dot(places[i], bodies.length > 12 ? sizes[kind] / 2 : sizes[kind]);
  });
}
