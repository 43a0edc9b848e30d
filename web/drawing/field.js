// What lies behind the curves of a portrait: the level curves of a function, and where a motion rests. Both are made of values
// on a grid of n × n places, the member at column i and row j being i·n + j, as an ensemble over two grids answers.

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

/** Levels that a picture shows: as many places lie between one and the next. */
export function levelsOf(values, count) {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  return sorted.length ? Array.from({ length: count }, (_, k) => sorted[Math.floor(((k + 0.5) / count) * sorted.length)]) : [];
}

/** Where the velocity (`u`, `v`) is zero, `[{x, y, saddle}]` in units of the grid: within a cell it is taken to be bilinear. */
export function restsOf(u, v, n) {
  const found = [];
  for (let i = 0; i + 1 < n; i++) {
    for (let j = 0; j + 1 < n; j++) {
      const corners = [i * n + j, (i + 1) * n + j, i * n + j + 1, (i + 1) * n + j + 1], cell = [u, v].map((w) => corners.map((k) => w[k]));
      if (cell.some((values) => !(Math.min(...values) <= 0 && Math.max(...values) >= 0))) continue;
      const [[a, b, c, d], [e, f, g, h]] = cell;
      let [x, y, slope] = [0.5, 0.5, 0];
      for (let k = 0; k < 12; k++) { // Newton's method
        const [p, q] = [[a, b, c, d], [e, f, g, h]].map(([o, r, s, t]) => o + (r - o) * x + (s - o) * y + (o - r - s + t) * x * y);
        const [px, qx] = [b - a + (a - b - c + d) * y, f - e + (e - f - g + h) * y], [py, qy] = [c - a + (a - b - c + d) * x, g - e + (e - f - g + h) * x];
        slope = px * qy - py * qx;
        [x, y] = [x - (p * qy - q * py) / slope, y - (q * px - p * qx) / slope];
      }
      if (!(Math.abs(x - 0.5) < 0.51 && Math.abs(y - 0.5) < 0.51)) continue;
      if (!found.some((other) => Math.hypot(other.x - i - x, other.y - j - y) < 0.5)) found.push({ x: i + x, y: j + y, saddle: slope < 0 });
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

/**
 * The backdrop of a field `{x: [low, high], y: [low, high], n, level?, u, v}`: curves of the `level`, those through saddles broad,
 * and a cross at each saddle, a disc at any other rest.
 */
export function fieldPicture({ x: [left, right], y: [low, high], n, level, u, v }) {
  const across = (i) => left + ((right - left) * i) / (n - 1), up = (j) => low + ((high - low) * j) / (n - 1);
  const rests = restsOf(u, v, n).map((rest) => ({ ...rest, at: [across(rest.x), up(rest.y)] }));
  const usual = level ? levelsOf(level, 14).map((value) => levelCurve(level, n, value)) : [];
  const separating = level ? rests.filter(({ saddle }) => saddle).map((rest) => levelCurve(level, n, levelAt(level, n, rest))) : [];
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
    for (const { at: [a, b], saddle } of rests) {
      const [c, d] = [map.x(a), map.y(b)];
      pen.beginPath();
      if (saddle) for (const side of [-1, 1]) {
        pen.moveTo(c - 5, d - 5 * side);
        pen.lineTo(c + 5, d + 5 * side);
      }
      else pen.arc(c, d, 3.5, 0, 2 * Math.PI);
      pen.strokeStyle = pen.fillStyle = colour("--ink");
      pen.lineWidth = 2;
      if (saddle) pen.stroke();
      else pen.fill();
    }
  };
  return { rests: rests.map(({ at, saddle }) => ({ at, saddle })), draw };
}
