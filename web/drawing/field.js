// The background of a portrait: the level curves of a function, and the equilibria of the motion. Both are computed from values
// on a grid of n × n places, the member at column i and row j being i·n + j, as an ensemble over two grids answers.
import { text } from "../language/texts.js";

/** Pieces `[[x, y], [x, y]]` of the curve on which `values` are `level`, in units of the grid. */
export function levelCurve(values, n, level) {
  const pieces = [];
  const crossing = ([i, j], [k, l]) => {
    const a = values[i * n + j] - level, b = values[k * n + l] - level;
    return a < 0 === b < 0 ? null : [i + ((k - i) * a) / (a - b), j + ((l - j) * a) / (a - b)];
  };
  for (let i = 0; i + 1 < n; i++) {
    for (let j = 0; j + 1 < n; j++) {
      const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
      if (!corners.every(([k, l]) => Number.isFinite(values[k * n + l]))) continue;
      const met = corners.map((corner, k) => crossing(corner, corners[(k + 1) % 4])).filter(Boolean);
      for (let k = 0; k + 1 < met.length; k += 2) pieces.push([met[k], met[k + 1]]);
    }
  }
  return pieces;
}

/** The levels that a picture shows, with equally many grid points between one and the next. */
export function levelsOf(values, count) {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  return sorted.length ? Array.from({ length: count }, (_, k) => sorted[Math.floor(((k + 0.5) / count) * sorted.length)]) : [];
}

/** The kind of an equilibrium by `trace` and `determinant` of its linearization; where a level is `kept` it is no spiral. */
function kindOf(trace, determinant, kept) {
  if (determinant < 0) return "saddle";
  const turn = trace / (2 * Math.sqrt(determinant)); // within −1 and 1 it goes round
  if (kept || Math.abs(turn) < 0.003) return "centre";
  return `${Math.abs(turn) < 1 ? "focus" : "node"}_${turn < 0 ? "in" : "out"}`;
}

/**
 * The zeros of the velocity (`u`, `v`), `[{x, y, kind}]` in units of the grid, whose cells are `across` wide and `up` high: within a
 * cell the velocity is interpolated bilinearly.
 */
export function restsOf(u, v, n, { across = 1, up = 1, kept = false } = {}) {
  const found = [];
  for (let i = 0; i + 1 < n; i++) {
    for (let j = 0; j + 1 < n; j++) {
      const corners = [i * n + j, (i + 1) * n + j, i * n + j + 1, (i + 1) * n + j + 1], cell = [u, v].map((w) => corners.map((k) => w[k]));
      if (cell.some((values) => !(Math.min(...values) <= 0 && Math.max(...values) >= 0))) continue;
      const [[a, b, c, d], [e, f, g, h]] = cell;
      let [x, y, slope, trace] = [0.5, 0.5, 0, 0];
      for (let k = 0; k < 12; k++) { // Newton's method
        const [p, q] = [[a, b, c, d], [e, f, g, h]].map(([o, r, s, t]) => o + (r - o) * x + (s - o) * y + (o - r - s + t) * x * y);
        const [px, qx] = [b - a + (a - b - c + d) * y, f - e + (e - f - g + h) * y], [py, qy] = [c - a + (a - b - c + d) * x, g - e + (e - f - g + h) * x];
        slope = px * qy - py * qx;
        trace = px / across + qy / up;
        [x, y] = [x - (p * qy - q * py) / slope, y - (q * px - p * qx) / slope];
      }
      if (!(Math.abs(x - 0.5) < 0.51 && Math.abs(y - 0.5) < 0.51)) continue;
      if (!found.some((other) => Math.hypot(other.x - i - x, other.y - j - y) < 0.5)) found.push({ x: i + x, y: j + y, kind: kindOf(trace, slope / (across * up), kept) });
    }
  }
  return found;
}

/** The backdrop of level curves of a function, over all that is seen. */
export function levelPicture(of) {
  const n = 101;
  return (pen, { low, high, x, y }, colour) => {
    const at = (axis, k) => low[axis] + ((high[axis] - low[axis]) * k) / (n - 1);
    const values = Array.from({ length: n * n }, (_, m) => of(at("x", Math.floor(m / n)), at("y", m % n)));
    pen.strokeStyle = colour("--axis");
    pen.lineWidth = 0.7;
    for (const level of levelsOf(values, 16)) {
      pen.beginPath();
      for (const [[a, b], [c, d]] of levelCurve(values, n, level)) {
        pen.moveTo(x(at("x", a)), y(at("y", b)));
        pen.lineTo(x(at("x", c)), y(at("y", d)));
      }
      pen.stroke();
    }
  };
}

/** The level of a function at a place between those of the grid. */
function levelAt(values, n, { x, y }) {
  const i = Math.min(n - 2, Math.floor(x)), j = Math.min(n - 2, Math.floor(y)), [a, b] = [x - i, y - j];
  const at = (k, l) => values[(i + k) * n + j + l];
  return (1 - a) * ((1 - b) * at(0, 0) + b * at(0, 1)) + a * ((1 - b) * at(1, 0) + b * at(1, 1));
}

/** Arrows of the velocity on every eighth place of the grid, all of one length: where to, not how fast. */
function drawArrows(pen, map, n, u, v, at) {
  const every = 8, long = 7, barb = 0.45;
  pen.beginPath();
  for (let i = every / 2; i < n; i += every) {
    for (let j = every / 2; j < n; j += every) {
      const [x, y] = at(i, j), [to, rise] = [u[i * n + j], v[i * n + j]], left = map.x(x), top = map.y(y);
      const [a, b] = [(map.x(x + 1) - left) * to, (map.y(y + 1) - top) * rise], size = Math.hypot(a, b);
      if (!(size > 0)) continue;
      const [c, d] = [(long * a) / size, (long * b) / size];
      pen.moveTo(left - c, top - d);
      pen.lineTo(left + c, top + d);
      for (const side of [-1, 1]) {
        pen.moveTo(left + c, top + d);
        pen.lineTo(left + c - barb * (c + side * d), top + d - barb * (d - side * c));
      }
    }
  }
  pen.stroke();
}

/** The mark of an equilibrium: a cross for a saddle, a disc if it attracts, a ring if it repels, a ring with a dot for a centre. */
function markRest(pen, [left, top], kind) {
  pen.beginPath();
  if (kind === "saddle") for (const side of [-1, 1]) {
    pen.moveTo(left - 5, top - 5 * side);
    pen.lineTo(left + 5, top + 5 * side);
  }
  else pen.arc(left, top, kind.endsWith("_in") ? 4 : 5, 0, 2 * Math.PI);
  if (kind.endsWith("_in")) pen.fill();
  else pen.stroke();
  if (kind !== "centre") return;
  pen.beginPath();
  pen.arc(left, top, 1.5, 0, 2 * Math.PI);
  pen.fill();
}

const few = 9; // rests whose names have room

/**
 * The backdrop of a field `{x: [low, high], y: [low, high], n, level?, u, v, arrows, kept, parts}`: curves of the `level`, where
 * it `parts` motions those through saddles broad, the velocities as `arrows`, and every equilibrium with its mark and kind.
 */
export function fieldPicture({ x: [left, right], y: [low, high], n, level, u, v, arrows, kept, parts }) {
  const across = (i) => left + ((right - left) * i) / (n - 1), up = (j) => low + ((high - low) * j) / (n - 1);
  const cell = { across: (right - left) / (n - 1), up: (high - low) / (n - 1), kept };
  const whole = (value, size) => (Math.abs(value) < 1e-4 * size ? 0 : value); // of round-off
  const rests = restsOf(u, v, n, cell).map((rest) => ({ ...rest, at: [whole(across(rest.x), cell.across), whole(up(rest.y), cell.up)] }));
  const usual = level ? levelsOf(level, 14).map((value) => levelCurve(level, n, value)) : [];
  const separating = level && parts ? rests.filter(({ kind }) => kind === "saddle").map((rest) => levelCurve(level, n, levelAt(level, n, rest))) : [];
  const draw = (pen, map, colour) => {
    const line = (pieces, width) => {
      pen.beginPath();
      for (const [[a, b], [c, d]] of pieces) {
        pen.moveTo(map.x(across(a)), map.y(up(b)));
        pen.lineTo(map.x(across(c)), map.y(up(d)));
      }
      pen.strokeStyle = colour("--axis");
      pen.lineWidth = width;
      pen.stroke();
    };
    usual.forEach((pieces) => line(pieces, 0.7));
    separating.forEach((pieces) => line(pieces, 2));
    pen.strokeStyle = colour("--soft-ink");
    pen.lineWidth = 1;
    if (arrows) drawArrows(pen, map, n, u, v, (i, j) => [across(i), up(j)]);
    pen.strokeStyle = pen.fillStyle = colour("--ink");
    pen.lineWidth = 2;
    pen.textAlign = "left";
    pen.textBaseline = "bottom";
    for (const { at: [a, b], kind } of rests) {
      const place = [map.x(a), map.y(b)];
      markRest(pen, place, kind);
      if (rests.length <= few) pen.fillText(text(`rest.${kind}`), place[0] + 7, place[1] - 4);
    }
  };
  return { rests: rests.map(({ at, kind }) => ({ at, kind })), draw };
}
