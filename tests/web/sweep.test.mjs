// One parameter over a range: resonance curves and bifurcation diagrams, against what is known of them.
import assert from "node:assert/strict";
import { becomes, pageTest, seen, settled } from "./browser.mjs";
import { fieldAt } from "./made.mjs";

const said = (page) => page.textContent("#sweep-status");
const sweep = async (page) => {
  const [question] = await Promise.all([page.waitForRequest("**/v1/ensemble"), page.click("#measure-sweep")]);
  await becomes(() => said(page), (text) => /points of|\//.test(text));
  return question.postDataJSON();
};
/** Where the picture is blue, as `[across, up]` in fractions of the canvas. */
const blue = (page) => seen(page, "#sweep canvas.plane", (canvas) => {
  const { width, height } = canvas, pen = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true }), found = [];
  pen.drawImage(canvas, 0, 0);
  const { data } = pen.getImageData(0, 0, width, height);
  for (let i = 0; i < data.length; i += 4) {
    if ([0, 114, 178].every((v, k) => Math.abs(data[i + k] - v) < 40)) found.push([((i / 4) % width) / width, 1 - Math.floor(i / 4 / width) / height]);
  }
  return found;
});

const resonance = "#problem=driven_oscillator&problem.damping=0.2&problem.amplitude=0.3&sweep.vary=frequency&sweep.from=0.5&sweep.to=1.5&sweep.count=101" +
  "&sweep.show=amplitude&sweep.until=200&sweep.after=150";
pageTest("a resonance curve: the amplitude over the frequency of the drive, and a click runs it", { hash: resonance }, async (page, context) => {
  const request = await sweep(page);
  assert.deepEqual([request.section, request.members, request.columns], [{ expression: "p", direction: "both" }, { vary: { "/problem/frequency": { grid: [0.5, 1.5, 101] } } }, ["q"]]);
  const [, most, at] = /amplitude of q, (\S+), at frequency = (\S+)\./.exec(await said(page));
  const height = (w) => 0.3 / Math.hypot(1 - w * w, 0.2 * w), top = Math.sqrt(1 - 0.02);
  assert.ok(Math.abs(most - height(top)) < 0.005 && Math.abs(at - top) <= 0.01, `${most} at ${at}, not ${height(top)} at ${top}`);
  const curve = await blue(page), [low, high] = [Math.min(...curve.map(([x]) => x)), Math.max(...curve.map(([x]) => x))];
  const [bottom, peak] = [Math.min(...curve.map(([, y]) => y)), Math.max(...curve.map(([, y]) => y))];
  const part = (height(1.3) - height(1.5)) / (height(top) - height(1.5)), there = curve.filter(([x]) => Math.abs(x - low - 0.8 * (high - low)) < 0.004);
  assert.ok(there.length && there.every(([, y]) => Math.abs((y - bottom) / (peak - bottom) - part) < 0.02), "its flank");
  await page.locator("#sweep canvas.plane").scrollIntoViewIfNeeded();
  const box = await page.locator("#sweep canvas.plane").boundingBox();
  await page.mouse.click(box.x + (low + 0.3 * (high - low)) * box.width, box.y + box.height / 2);
  await settled(page);
  const value = Number(await fieldAt(page, "/problem/frequency").inputValue());
  assert.ok(Math.abs(value - 0.8) < 0.011 && Math.abs(value * 100 - Math.round(value * 100)) < 1e-9, `the member there, ${value}`);
  assert.ok(await page.isVisible("#sweep canvas.plane"), "the curve stays beside the run");
  const other = await context.newPage();
  await other.goto(page.url());
  await settled(other);
  assert.equal(await fieldAt(other, "/sweep/show").inputValue(), "amplitude");
});

const duffing = "#problem=custom&problem.variables=x&problem.parameters=delta=0.25,gamma=0.3&problem.potential=-x%5E2/2%2Bx%5E4/4-gamma*x*cos(t)&problem.damping=delta" +
  "&sweep.vary=gamma&sweep.from=0.2&sweep.to=0.34&sweep.count=71&sweep.period=6.283185307179586&sweep.until=600&sweep.after=400";
pageTest("a bifurcation diagram: one point a turn, then many, then three", { hash: duffing }, async (page) => {
  const request = await sweep(page);
  assert.deepEqual([request.section, Object.keys(request.members.vary)], [{ period: 6.283185307179586, phase: 0 }, ["/problem/gamma"]]);
  assert.match(await said(page), /^2.272 points of 71 runs/, "32 turns after t = 400 of each run");
  const points = await blue(page), low = Math.min(...points.map(([x]) => x)), high = Math.max(...points.map(([x]) => x));
  const apart = (gamma) => { // how many heights there are about a value
    const at = low + ((gamma - 0.2) / 0.14) * (high - low), heights = points.filter(([x]) => Math.abs(x - at) < 0.008).map(([, y]) => y).sort((a, b) => a - b);
    return heights.filter((y, i) => i === 0 || y - heights[i - 1] > 0.03).length;
  };
  assert.equal(apart(0.21), 1);
  assert.equal(apart(0.328), 3);
  assert.ok(apart(0.3) > 6, `chaos at 0.3: ${apart(0.3)}`);
});

pageTest("the end over a parameter; what is refused is told", { hash: "#problem=harmonic_oscillator&initial.q=1&sweep.vary=stiffness&sweep.from=1&sweep.to=4&sweep.count=31&sweep.show=end&sweep.until=3",
  expected: /status of 422/ }, async (page) => {
  await sweep(page);
  const [, most, at] = /largest q, (\S+), at stiffness = (\S+)\./.exec(await said(page)), end = (k) => Math.cos(3 * Math.sqrt(k));
  const best = Array.from({ length: 31 }, (_, i) => 1 + i / 10).reduce((a, b) => (end(b) > end(a) ? b : a));
  assert.ok(Math.abs(at - best) < 1e-9 && Math.abs(most - end(best)) < 0.005, `${most} at ${at}, not ${end(best)} at ${best}`);
  await page.selectOption("#sweep [data-name=show]", "crossings");
  await fieldAt(page, "/sweep/where").fill("zz");
  await page.click("#measure-sweep");
  await becomes(() => said(page), (text) => /^\/section\/expression: .*zz/.test(text));
  assert.match(await page.getAttribute("#sweep-status", "class"), /fault/);
});
