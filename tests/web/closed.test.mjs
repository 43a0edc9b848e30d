// The closed orbit near a run: its period, its multipliers and its family are true, and it is drawn over the runs.
import assert from "node:assert/strict";
import { test } from "node:test";
import { periodOf } from "../../web/studies/section.js";
import { circlePicture } from "../../web/drawing/circle.js";
import { all, becomes, drawn, frames, origin, pageTest, plane, settled, statuses } from "./browser.mjs";
import { fieldAt } from "./made.mjs";

test("multipliers about the unit circle: a number and its inverse on both sides of it, none beyond 2", () => {
  const { curves } = circlePicture([1, 285, 1 / 285, -3, 1e12].map((re) => ({ re, im: 0 })).concat({ re: 0, im: -1 }), "--ink", ["", ""]);
  const [one, far, near, behind, most, below] = curves.map(({ x: [x], y: [y] }) => [x, y]);
  assert.deepEqual([one, below], [[1, 0], [0, -1]]);
  assert.ok(Math.abs(far[0] + near[0] - 2) < 1e-12 && far[0] > 1.8 && behind[0] < -1 && most[0] < 2 && most[0] > far[0]);
});

const said = (page) => page.textContent("#closed-status");
async function close(page, pattern) {
  const [question] = await Promise.all([page.waitForRequest("**/v1/periodic"), page.click("#close-orbit")]);
  await becomes(() => said(page), (text) => pattern.test(text));
  return question.postDataJSON();
}
const rows = (page) => page.locator("#multipliers tbody tr").evaluateAll((found) => found.map((row) => [...row.cells].map((cell) => cell.textContent)));
const mean = (a, b) => (Math.abs(a - b) < 1e-15 ? a : mean((a + b) / 2, Math.sqrt(a * b)));
const swing = (angle) => (2 * Math.PI) / mean(1, Math.cos(angle / 2)); // the period of a pendulum

test("the period of a drive is that of the frequency that is set, else that of the card", () => {
  const drive = (name) => ({ parameters: [{ name: "alpha", default: 3 }, { name, default: 2 }] });
  for (const name of ["w", "omega", "frequency"]) {
    assert.equal(periodOf(drive(name)), Math.PI);
    assert.equal(periodOf(drive(name), { [name]: 4 }), Math.PI / 2);
  }
  assert.equal(periodOf({ parameters: [] }), 2 * Math.PI);
});

const pendulum = "#problem=pendulum&initial.q=1&until.t=20&closed.by=q&closed.to=2.5&closed.fixed=p&closed.count=12";
pageTest("a pendulum's orbit: its period, its family, and a click that runs one of it", { hash: pendulum }, async (page, context) => {
  const before = (await drawn(page, plane("A"), "--ink")).count, asked = await close(page, /its family/);
  assert.deepEqual([asked.fixed, asked.family, asked.until], [["p"], { by: "/initial/q", to: 2.5, count: 12 }, undefined]);
  assert.ok(Math.abs(asked.period - swing(1)) < 0.1, "the guess is the time after which the run comes back");
  const [, period] = /period (\S+)\. It is stable\. 2 multipliers/.exec(await said(page));
  assert.ok(Math.abs(period - swing(1)) < 0.01, `${period}, near ${swing(1)}`); // the start moves a little
  assert.deepEqual(await rows(page), [["unit", "1", "1", "0"], ["unit", "1", "1", "0"]]);
  assert.ok((await drawn(page, plane("A"), "--ink")).count > before + 200, "it is drawn over the runs");
  const curve = await drawn(page, "#closed figure canvas.plane >> nth=0", "--run-b"), circle = await drawn(page, "#closed figure canvas.plane >> nth=1", "--ink");
  assert.ok(curve.right - curve.left > 300 && curve.bottom - curve.top > 200 && circle.count > 300, JSON.stringify([curve, circle]));
  await page.locator("#closed figure canvas.plane").first().scrollIntoViewIfNeeded();
  const box = await page.locator("#closed figure canvas.plane").first().boundingBox();
  await page.mouse.click(box.x + (curve.left + curve.right) / 2, box.y + (curve.top + 3 * curve.bottom) / 4);
  await settled(page);
  const [q, until] = await Promise.all(["/initial/q", "/until/t"].map(async (pointer) => Number(await fieldAt(page, pointer).inputValue())));
  assert.ok(q > 1.4 && q < 2.1 && Math.abs(until - swing(q)) < 1e-8, `from ${q} until ${until}, not ${swing(q)}`);
  assert.ok(await page.isVisible("#multipliers table"), "what was found stays");
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
  await fieldAt(page, "/initial/q").fill("1.2");
  await fieldAt(page, "/initial/q").press("Enter");
  await settled(page);
  await frames(page);
  assert.ok(!(await page.isVisible("#multipliers table")) && (await drawn(page, plane("A"), "--ink")).count < before + 100, "another start has another orbit");
  const other = await context.newPage();
  await other.goto(page.url());
  await settled(other);
  assert.equal(await fieldAt(other, "/closed/to").inputValue(), "2.5");
});

pageTest("a limit cycle attracts: a multiplier within the circle", { hash: "#problem=van_der_pol&initial.x=1.9&until.t=30" }, async (page) => {
  await close(page, /period/);
  assert.match(await said(page), /period 6\.6632869\. It is stable\. 1 multiplier is 1/);
  const [unit, inner] = await rows(page);
  assert.deepEqual([unit[0], inner[0]], ["unit", "hyperbolic"]);
  assert.ok(Math.abs(parseFloat(inner[1]) - 8.597) < 0.01 && /10⁻⁴/.test(inner[1]), inner[1]);
  const { left, right } = await drawn(page, "#closed figure canvas.plane >> nth=1", "--run-b"), { left: from, right: to } = await drawn(page, "#closed figure canvas.plane >> nth=1", "--ink");
  assert.ok(left > (from + to) / 2 - 8 && right > to - 12 && right - left > (to - from) / 3, "one near zero, one on the circle");
});

pageTest("on an attractor an orbit begins where the run comes back to", { hash: "#problem=lorenz&until.t=40" }, async (page) => {
  const { initial, period } = await close(page, /losed/);
  assert.ok(initial.x !== 1 && period < 5, JSON.stringify([initial, period]));
  assert.match(await said(page), /^Closed.*It is not stable/);
  await page.click("#closed button:text-is('Run it')");
  await settled(page);
  const start = Number(await fieldAt(page, "/initial/x").inputValue());
  assert.ok(Math.abs(start - initial.x) < 3 && (await page.isVisible("#multipliers table")));
});

const arenstorf = { hash: "#lesson=arenstorf", ready: "#lesson[aria-busy=false]", reducedMotion: "reduce" };
pageTest("Arenstorf's orbit of the lesson closes in the workbench, and no neighbour stays", arenstorf, async (page) => {
  await page.click("#to-bench");
  await settled(page);
  await close(page, /losed/);
  assert.match(await said(page), /period 17\.065217\. It is not stable\. 2 multipliers/);
  assert.deepEqual((await rows(page)).map(([kind, modulus]) => [kind, modulus]).toSorted(([, a], [, b]) => b - a)[0], ["hyperbolic", "285.4"]);
});

pageTest("what leaves a halo and what comes to it is drawn with it, over the pictures in space", { hash: "#problem=restricted_three_body&closed.manifolds=true&A=taylor&B=taylor" }, async (page) => {
  const asked = [], runs = [];
  page.on("request", (request) => {
    if (request.url().endsWith("periodic")) asked.push(request.postDataJSON());
    if (request.url().endsWith("simulate")) runs.push(request.postDataJSON());
  });
  const count = async (colour) => (await drawn(page, plane("A"), colour)).count, before = [await count("--run-d"), await count("--run-c")];
  await page.click("#close-orbit");
  await becomes(() => said(page), (text) => /not stable.*Violet: what leaves it\. Green: what comes to it\.$/.test(text));
  const { manifolds, period, initial } = asked[1], answer = await (await fetch(`${origin}/v1/periodic`, { method: "POST", body: JSON.stringify(asked[1]) })).json();
  const [, modulus] = /hyperbolic(\S+)/.exec(await page.textContent("#multipliers tbody")), grown = period * Math.log(2e6) / Math.log(Math.max(...answer.multipliers.map((one) => one.modulus)));
  assert.ok(modulus && Math.abs(manifolds.until - grown) < 1e-6 * grown, "as long as they take to be seen");
  const begun = (t) => runs.filter(({ scheme, until }) => scheme === "taylor" && Math.sign(until.t - (initial.t ?? 0)) === t).length;
  assert.deepEqual([manifolds.count, begun(1), begun(-1)], [8, 17, 16], "one round, and two from each place either way");
  const after = [await count("--run-d"), await count("--run-c")];
  assert.ok(after.every((n, i) => n > before[i] + 80), `both are seen: ${before} pixels, then ${after}`);
  assert.ok((await drawn(page, plane("A"), "--ink")).count > 100, "and the orbit");
});

pageTest("what no real multiplier leaves is said to have no manifolds", { hash: "#problem=pendulum&initial.q=1&until.t=20&closed.manifolds=true" }, async (page) => {
  await close(page, /Nothing leaves it and nothing comes to it/);
  assert.ok((await drawn(page, plane("A"), "--run-d")).count < 5);
});

pageTest("what does not close says why, what is refused is told at its pointer", { hash: "#problem=damped_oscillator&closed.period=6", expected: /status of 422/ }, async (page) => {
  await close(page, /losed/);
  assert.match(await said(page), /^Not closed: .*equilibrium\. It came as near as 0\.\d+ of its extent/);
  assert.ok(await page.isHidden("#closed button:text-is('Run it')"));
  await page.selectOption("#problem", "lane_emden");
  await settled(page);
  await close(page, /\//);
  assert.match(await said(page), /^\/period: the equations of motion do not repeat after it/);
  assert.deepEqual(await all(page, "#multipliers tr", "textContent"), []);
});
