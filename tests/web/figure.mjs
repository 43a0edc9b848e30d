// Draws hybrid.svg, the README's figure: the eccentric orbit of Nair, Ober-Blöbaum and Marsden under leapfrog at two steps
// and under the Jacobi–Maupertuis hybrid as they published it. Runs the program; `./dev figure` calls it.
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const program = process.env.LEAST_BINARY || fileURLToPath(new URL("../../build/release/leastaction", import.meta.url));
const picture = fileURLToPath(new URL("hybrid.svg", import.meta.url));

const end = 95; // five periods and a little
const runs = [
  { title: "leapfrog", setting: "h = 0.005", scheme: { id: "leapfrog", step: 0.005 } },
  { title: "leapfrog", setting: "h = 0.01", scheme: { id: "leapfrog", step: 0.01 } },
  { title: "Jacobi–Maupertuis hybrid", setting: "h = θ = 0.01, as published",
    scheme: { id: "jacobi_maupertuis", preset: "paper", step: 0.01, theta: 0.01 } },
];

function answer(scheme) {
  const request = { problem: "kepler", scheme, until: { t: end }, record: { every: 1 },
                    columns: ["t", "x", "y", "px", "py", "mode"], diagnostics: ["orbit"] };
  const text = execFileSync(program, ["run", "-"], { input: JSON.stringify(request), maxBuffer: 2 ** 28 });
  const { status, trajectory, diagnostics } = JSON.parse(text);
  if (status !== "completed") throw new Error(`the run of ${scheme.id} did not complete`);
  const { t, x, y, px, py, mode } = trajectory;
  const state = (time, i) =>
    ({ t: time, x: x[i], y: y[i], px: px[i], py: py[i], fast: mode[i] === "jacobi_maupertuis" });
  return { rotation: diagnostics.orbit.apsidal_rotation, states: t.map(state) };
}

// ---- the plane: x to the right, y up, one scale for both

const scale = 118, panel = 300, top = 98, height = 4.25 * scale, width = 3 * panel;
const left = -1.2, high = 0.1; // the plane's corner at the upper left of a panel, in units of length
const across = (x) => (x - left) * scale, down = (y) => (high - y) * scale;
const coordinate = (value) => String(Math.round(value * 10) / 10);
const point = (x, y) => `${coordinate(across(x))} ${coordinate(down(y))}`;

/** Indices of states between which the direction turns by no more than `most` radians and little way is left out. */
function thinned(states, most = 0.2, way = 30) {
  const kept = [0];
  for (let i = 1; i + 1 < states.length; i++) {
    const from = states[kept.at(-1)], to = states[i + 1];
    const turned = Math.abs(Math.atan2(from.px * to.py - from.py * to.px, from.px * to.px + from.py * to.py));
    const gone = Math.hypot(to.x - from.x, to.y - from.y) * scale;
    if (turned > most || gone > way || states[i].fast !== states[i + 1].fast) kept.push(i);
  }
  return [...kept, states.length - 1];
}

/** The curves of a run by mode: between two states the cubic that both its ends and their velocities fix. */
function curves(states) {
  const paths = { slow: "", fast: "" };
  let drawing = null;
  const kept = thinned(states);
  for (let k = 1; k < kept.length; k++) {
    const a = states[kept[k - 1]], b = states[kept[k]], third = (b.t - a.t) / 3, name = b.fast ? "fast" : "slow";
    if (name !== drawing) paths[name] += `M${point(a.x, a.y)}C`;
    else paths[name] += " ";
    drawing = name;
    const after = point(a.x + third * a.px, a.y + third * a.py), before = point(b.x - third * b.px, b.y - third * b.py);
    paths[name] += `${after} ${before} ${point(b.x, b.y)}`;
  }
  return paths;
}

/** The ellipse that the start lies on, μ = 1, as an SVG element: in the origin its one focus. */
function ellipse({ x, y, px, py }, style) {
  const r = Math.hypot(x, y), v2 = px * px + py * py, xv = x * px + y * py;
  const lenz = [(v2 - 1 / r) * x - xv * px, (v2 - 1 / r) * y - xv * py], e = Math.hypot(...lenz);
  const a = 1 / (2 / r - v2), b = a * Math.sqrt(1 - e * e);
  const turn = -Math.atan2(lenz[1], lenz[0]) * (180 / Math.PI);
  const place = `translate(${point(-a * lenz[0], -a * lenz[1])}) rotate(${turn.toFixed(3)})`;
  return `<ellipse rx="${coordinate(a * scale)}" ry="${coordinate(b * scale)}" transform="${place}" ${style}/>`;
}

// ---- the drawing

const ink = "#1f2328", soft = "#59636e", slow = "#0072b2", fast = "#d55e00", truth = "#c9ccd1";
const written = (x, y, text, more = "") => `<text x="${coordinate(x)}" y="${coordinate(y)}" ${more}>${text}</text>`;
const raised = (exponent) => [...String(exponent)].map((digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit] ?? "⁻").join("");

/** Three digits, small numbers as "7.31·10⁻⁵". */
function readable(number) {
  if (Math.abs(number) >= 1e-3) return number.toPrecision(3).replace("-", "−");
  const [digits, exponent] = number.toExponential(2).split("e");
  return `${digits.replace("-", "−")}·10${raised(exponent)}`;
}

function drawn({ title, setting, scheme }, index) {
  const { states, rotation } = answer(scheme), paths = curves(states), middle = panel / 2;
  const line = (d, colour) => (d ? `<path d="${d}" stroke="${colour}"/>` : "");
  return `<g transform="translate(${index * panel} 0)">
<g text-anchor="middle">
${written(middle, 34, title, 'class="title"')}
${written(middle, 56, setting)}
${written(middle, 78, `apsis turns ${readable(rotation)} rad per revolution`, 'class="soft"')}
</g>
<g transform="translate(0 ${top})" fill="none" stroke-linejoin="round">
${ellipse(states[0], `stroke="${truth}" stroke-width="3.5"`)}
<g stroke-width="1.1">${line(paths.slow, slow)}${line(paths.fast, fast)}</g>
<circle cx="${coordinate(across(0))}" cy="${coordinate(down(0))}" r="2.5" fill="${ink}"/>
</g>
</g>`;
}

const foot = top + height + 30, bottom = foot + 24, bar = width - 40 - scale;
const legend = [["Hamilton: steps of time", slow, 2, 32], ["Jacobi–Maupertuis: steps of a coordinate", fast, 2, 252],
                ["exact ellipse", truth, 3.5, 584]];
const entry = ([text, colour, thick, x]) =>
  `<path d="M${x} ${foot - 5}h28" stroke="${colour}" stroke-width="${thick}"/>${written(x + 38, foot, text)}`;

const font = "system-ui, -apple-system, 'Segoe UI', 'Liberation Sans', Arial, sans-serif";
const size = `viewBox="0 0 ${width} ${bottom}" width="${width}" height="${bottom}"`;
const svg = `<svg xmlns="http://www.w3.org/2000/svg" ${size} role="img" font-family="${font}" font-size="14" fill="${ink}">
<title>The eccentric Kepler orbit over five revolutions: under leapfrog the ellipse turns, under the hybrid it stays</title>
<style>.title{font-size:16px;font-weight:600}.soft{fill:${soft}}.legend{font-size:13px}</style>
<rect width="100%" height="100%" rx="6" fill="#fff"/>
${runs.map(drawn).join("\n")}
<g class="legend">
${legend.map(entry).join("\n")}
<path d="M${bar} ${foot - 9}v8m0 -4h${scale}m0 -4v8" stroke="${ink}" fill="none"/>
${written(bar + scale / 2, foot - 11, "length 1", 'text-anchor="middle"')}
</g>
</svg>
`;
writeFileSync(picture, svg);
console.log(`${picture}: ${svg.length} characters`);
