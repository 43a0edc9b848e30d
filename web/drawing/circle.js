// Multipliers of a closed orbit in the complex plane with the unit circle: deviations with a multiplier on it stay small,
// those with one outside grow with every round. The distance from zero is drawn as 2 √r / (1 + √r), which is 1 on the circle
// and below 2 for any multiplier; a number and its inverse have the same distance from the circle.
import { spelled } from "../language/texts.js";

const drawn = (r) => (2 * Math.sqrt(r)) / (1 + Math.sqrt(r));
const ring = (r) => Array.from({ length: 181 }, (_, i) => [drawn(r) * Math.cos((i * Math.PI) / 90), drawn(r) * Math.sin((i * Math.PI) / 90)]);

/** Rings at powers of ten, with what they stand for. */
function rings(pen, map, colour) {
  pen.font = "12px sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "bottom";
  for (const power of [-2, -1, 0, 1, 2, 3]) {
    pen.beginPath();
    ring(10 ** power).forEach(([x, y], i) => (i ? pen.lineTo(map.x(x), map.y(y)) : pen.moveTo(map.x(x), map.y(y))));
    pen.strokeStyle = colour(power === 0 ? "--ink" : "--grid");
    pen.lineWidth = power === 0 ? 1.5 : 1;
    pen.stroke();
    pen.fillStyle = colour("--soft-ink");
    if (power > -2 && power < 3) pen.fillText(spelled(10 ** power), map.x(0), map.y(drawn(10 ** power)));
  }
}

/** The picture of `multipliers`, `[{re, im}]`, each of a `colour`, under `labels`. */
export function circlePicture(multipliers, colour, labels) {
  const curves = multipliers.map(({ re, im, title = "" }) => {
    const r = Math.hypot(re, im), by = r ? drawn(r) / r : 0;
    return { x: [re * by], y: [im * by], colour, title };
  });
  return { curves, view: { x: [-2, 2], y: [-2, 2], free: false }, labels, bare: true, backdrop: rings };
}
