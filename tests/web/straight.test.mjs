// Which corners of a curve are drawn: few, and no point is farther from the lines than an eye sees.
import assert from "node:assert/strict";
import { test } from "node:test";
import { stroke } from "../../web/drawing/strokes.js";

const map = { x: (v) => v, y: (v) => v };
/** The corners that a pen is led to, over all strokes. */
function cornersOf(x, y, more) {
  const corners = [], to = (a, b) => corners.push([a, b]);
  stroke({ beginPath() {}, stroke() {}, moveTo: to, lineTo: to }, map, { x, y }, "black", 1, more);
  return corners;
}
const apart = ([x, y], [a, b], [c, d]) => { // of a point from a line between two others
  const [u, v] = [c - a, d - b], along = Math.max(0, Math.min(1, ((x - a) * u + (y - b) * v) / (u * u + v * v || 1)));
  return Math.hypot(x - a - along * u, y - b - along * v);
};

test("a spiral of many points is drawn by few corners, all of it within a third of a pixel", () => {
  const turns = Array.from({ length: 20001 }, (_, i) => i / 500), x = turns.map((t) => (250 - 3 * t) * Math.cos(t)), y = turns.map((t) => (250 - 3 * t) * Math.sin(t));
  const corners = cornersOf(x, y);
  assert.ok(corners.length < 20001 / 20 && corners.length > 100, `${corners.length} corners`);
  assert.deepEqual([corners[0], corners.at(-1)], [[x[0], y[0]], [x.at(-1), y.at(-1)]], "both ends");
  let k = 1, worst = 0;
  for (let i = 0; i < x.length; i++) {
    const near = () => apart([x[i], y[i]], corners[k - 1], corners[k]);
    while (k + 1 < corners.length && apart([x[i], y[i]], corners[k], corners[k + 1]) < near()) k++;
    worst = Math.max(worst, near());
  }
  assert.ok(worst < 0.35, `${worst} pixels off`);
});

test("a way that turns back is drawn to where it turned, and what rests is a point", () => {
  const there = Array.from({ length: 101 }, (_, i) => i / 10), back = [...there, ...there.toReversed()], flat = back.map(() => 5);
  const corners = cornersOf(back, flat);
  assert.ok(corners.some(([a]) => Math.abs(a - 10) < 0.3) && corners.length < 8, JSON.stringify(corners));
  assert.ok(cornersOf(back.map(() => 3), flat).length <= 3);
  assert.deepEqual(cornersOf([0, 100, 100, 0], [0, 0, 100, 100]), [[0, 0], [100, 0], [100, 100], [0, 100]], "corners stay");
});

test("a gap stays a gap", () => {
  const corners = cornersOf([0, 50, null, 100, 150], [0, 0, null, 0, 0]);
  assert.deepEqual(corners, [[0, 0], [50, 0], [100, 0], [150, 0]]);
});
