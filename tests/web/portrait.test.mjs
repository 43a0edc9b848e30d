// Portraits: starts that a hand sets into a picture of two variables, what lies behind them, and which picture of many runs a
// scene begins with.
import assert from "node:assert/strict";
import { test } from "node:test";
import { all, becomes, drawn, frames, pageTest, pane, plane, seen, settled } from "./browser.mjs";
import { enter, fieldAt } from "./made.mjs";
import { levelCurve, levelsOf, restsOf } from "../../web/drawing/field.js";

// ---- what lies behind

const n = 41, on = (low, high, k) => low + ((high - low) * k) / (n - 1);
const grid = (of, [left, right] = [-4, 4], [low, high] = [-2, 2]) =>
  Array.from({ length: n * n }, (_, m) => of(on(left, right, Math.floor(m / n)), on(low, high, m % n)));

test("level curves lie where the function has the level", () => {
  const pieces = levelCurve(grid((x, y) => (x * x) / 4 + y * y), n, 1.44);
  assert.ok(pieces.length > 40);
  for (const [i, j] of pieces.flat()) assert.ok(Math.abs(Math.hypot(on(-4, 4, i) / 2, on(-2, 2, j)) - 1.2) < 0.01);
  assert.deepEqual(levelCurve(grid(() => NaN), n, 0), [], "none where nothing is known");
  const levels = levelsOf([5, NaN, 1, 2, 3, 4, 6, 7, 8], 4);
  assert.deepEqual(levels, [2, 4, 6, 8]);
});

test("a pendulum rests below, and on top as a saddle", () => {
  const rests = restsOf(grid((_, p) => p), grid((q) => -Math.sin(q)), n).map(({ x, y, kind }) => [on(-4, 4, x), on(-2, 2, y), kind]);
  assert.equal(rests.length, 3);
  for (const [q, wanted] of [[-Math.PI, "saddle"], [0, "centre"], [Math.PI, "saddle"]]) {
    assert.ok(rests.some(([x, y, kind]) => Math.abs(x - q) < 0.01 && Math.abs(y) < 1e-9 && kind === wanted), `${q} among ${rests.join("; ")}`);
  }
});

test("what a rest is, is told by the velocity about it, whatever the sizes of the grid's cells", () => {
  const cell = { across: 8 / (n - 1), up: 4 / (n - 1) };
  const kind = (a, b, c, d) => restsOf(grid((x, y) => a * (x - 0.1) + b * (y - 0.03)), grid((x, y) => c * (x - 0.1) + d * (y - 0.03)), n, cell).map((rest) => rest.kind).join();
  assert.equal(kind(0, 1, -1, 0), "centre");
  assert.equal(kind(0, 1, 1, 0), "saddle");
  assert.equal(kind(0, 1, -1, -0.1), "focus_in");
  assert.equal(kind(0, 1, -1, 0.1), "focus_out");
  assert.equal(kind(0, 1, -1, -1.9), "focus_in", "nearly a node");
  assert.equal(kind(0, 1, -1, -2.1), "node_in");
  assert.equal(kind(0, 1, -1, 2.1), "node_out");
});

// ---- starts

const pendulum = { hash: "#problem=pendulum&until.t=12&A=leapfrog&B=runge_kutta_4", reducedMotion: "reduce" };
const starts = async (page) => {
  const values = (await page.locator("#start-list input").evaluateAll((found) => found.map(({ value }) => Number(value))));
  return values.flatMap((x, i) => (i % 2 ? [] : [[x, values[i + 1]]]));
};
/** Where (q, p) lies in the picture of A, whose run swings from −1.5 to 1.5, on the screen. */
async function mapOf(page) {
  const { x, y } = await page.locator(plane("A")).boundingBox(), { left, right, top, bottom } = await drawn(page, plane("A"), "A");
  const scale = (right - left - 12) / 3; // but for the ring
  return (q, p) => [x + (left + right) / 2 - 3 + scale * q, y + (top + bottom) / 2 - scale * p];
}
const known = (page) => page.waitForSelector("#starts[aria-busy=false]");

pageTest("a click into a picture adds a start, which each scheme runs, two at a time", pendulum, async (page, context) => {
  const asked = [];
  let flying = 0, most = 0;
  const slowly = async (route) => {
    asked.push(route.request().postDataJSON());
    most = Math.max(most, ++flying);
    await new Promise((resolve) => setTimeout(resolve, 50));
    await route.continue().catch(() => {});
    flying--;
  };
  await page.route("**/v1/simulate", slowly);
  const at = await mapOf(page), before = (await drawn(page, plane("A"), "A")).count;
  for (const [q, p] of [[0.5, 0], [0, 1], [-1, 0.4]]) {
    await page.mouse.click(...at(q, p));
    await known(page);
  }
  const found = await starts(page);
  assert.equal(found.length, 3);
  for (const [i, [q, p]] of [[0.5, 0], [0, 1], [-1, 0.4]].entries()) assert.ok(Math.hypot(found[i][0] - q, found[i][1] - p) < 0.1, `${found[i]}`);
  assert.deepEqual(asked.map(({ initial: { q, p }, scheme: { id } }) => [id, q, p]).sort(),
                   found.flatMap(([q, p]) => [["leapfrog", q, p], ["runge_kutta_4", q, p]]).sort(), "each once with each scheme");
  assert.ok((await drawn(page, plane("A"), "A")).count > 1.5 * before, "their curves are drawn");
  assert.equal(await fieldAt(page, "/initial/q").inputValue(), "1.5", "the scene's own start stays");
  const other = await context.newPage();
  await other.route("**/v1/simulate", slowly);
  await other.goto(page.url());
  await settled(other);
  await known(other);
  assert.equal(most, 2, "of six");
  assert.deepEqual(await starts(other), found, "the link holds the portrait");
  await page.goBack();
  await becomes(async () => (await starts(page)).length, (length) => length === 2);
});

pageTest("a start is dragged; a double click adds none", pendulum, async (page) => {
  const at = await mapOf(page);
  await page.mouse.click(...at(0.5, 0));
  await known(page);
  const [[q, p]] = await starts(page), asked = [];
  page.on("request", (request) => request.url().endsWith("simulate") && asked.push(request.postDataJSON()));
  await page.mouse.move(...at(q, p));
  await page.mouse.down();
  for (let i = 1; i <= 5; i++) await page.mouse.move(...at(q + 0.1 * i, p + 0.1 * i));
  await page.mouse.up();
  await known(page);
  const [[x, y]] = await starts(page);
  assert.ok(Math.abs(x - q - 0.5) < 0.1 && Math.abs(y - p - 0.5) < 0.1, `${x}, ${y}`);
  assert.ok(asked.every(({ initial }) => initial.q !== 1.5) && asked.at(-1).initial.q === x, "that start alone is run");
  assert.match(decodeURIComponent(page.url()), new RegExp(`starts.of=q,p&starts.at=${x},${y}`));
  await page.mouse.dblclick(...at(-0.8, 0.3));
  await known(page);
  assert.deepEqual(await starts(page), [[x, y]]);
});

pageTest("starts by keys: added, moved, refused and removed", { ...pendulum, expected: /status of 422/ }, async (page) => {
  await page.focus("#add-start");
  await page.keyboard.press("Enter");
  await known(page);
  assert.deepEqual(await starts(page), [[1.5, 0.25]]);
  const input = page.locator("#start-list input").nth(1), before = await drawn(page, plane("A"), "A");
  await input.fill("1.8");
  await input.press("Enter");
  await known(page);
  assert.deepEqual(await starts(page), [[1.5, 1.8]]);
  assert.notDeepEqual(await drawn(page, plane("A"), "A"), before);
  await input.fill("fast");
  await input.press("Enter");
  assert.deepEqual(await starts(page), [[1.5, 1.8]], "what is no number is not taken");
  await page.click("#add-start");
  await page.locator("#start-list button").first().focus();
  await page.keyboard.press("Enter");
  await known(page);
  assert.deepEqual(await starts(page), [[1.5, 2.05]]);
  assert.match(await page.evaluate(() => document.activeElement.ariaLabel), /Remove start 1/);
  await page.keyboard.press("Enter");
  assert.equal((await starts(page)).length, 0);
  assert.equal(await page.evaluate(() => document.activeElement.id), "add-start");
  assert.doesNotMatch(page.url(), /starts/);
  assert.ok((await all(page, "#start-list input", "ariaLabel")).every((label) => /start/.test(label)));
});

pageTest("another scene has no such starts, and pictures over time take none", pendulum, async (page) => {
  await page.click("#add-start");
  await page.selectOption("#axes [name=x]", "t");
  await settled(page);
  assert.ok(!(await page.isVisible("#starts")));
  await page.selectOption("#axes [name=x]", "q_wrapped");
  await settled(page);
  assert.equal((await starts(page)).length, 1, "an angle within one turn is the same variable");
  for (const other of ["harmonic_oscillator", "kepler"]) {
    await page.selectOption("#problem", other);
    await settled(page);
    assert.ok(await page.isVisible("#starts"));
    assert.equal((await starts(page)).length, 0, other);
  }
});

const touched = { ...pendulum, hasTouch: true, viewport: { width: 390, height: 844 } };
pageTest("a tap adds a start", touched, async (page) => {
  await page.locator(plane("A")).scrollIntoViewIfNeeded();
  const { x, y, width, height } = await page.locator(plane("A")).boundingBox();
  await page.touchscreen.tap(x + 0.6 * width, y + 0.5 * height);
  await becomes(async () => (await starts(page)).length, (length) => length === 1);
});

const rotation = { hash: "#problem=pendulum&axes.x=q_wrapped&initial.q=0&initial.p=2.5&until.t=40&A=leapfrog&B=leapfrog", reducedMotion: "reduce" };
pageTest("an angle that turns over does not cross the picture", rotation, async (page) => {
  const whole = await drawn(page, plane("B"), "B"), { width } = await page.locator(plane("B")).evaluate((canvas) => ({ width: canvas.width }));
  const middle = (whole.left + whole.right) / 2 / width, { top, bottom } = await drawn(page, plane("B"), "B", [middle + 0.03, middle + 0.06]);
  assert.ok(whole.right - whole.left > 200 && bottom - top < 12, `from ${top} to ${bottom}`);
});

const behind = { hash: "#problem=pendulum&axes.x=q_wrapped&initial.q=3&A=leapfrog&B=leapfrog", reducedMotion: "reduce" };
pageTest("behind a portrait lie level curves of H and where it rests, by choice", behind, async (page) => {
  const before = (await drawn(page, plane("A"), "--axis")).count, labels = await drawn(page, plane("A"), "--ink");
  const [question] = await Promise.all([page.waitForRequest("**/v1/ensemble"), page.selectOption("#field", "levels")]);
  const { scheme, columns, members: { vary } } = question.postDataJSON();
  assert.deepEqual([scheme.id, columns, Object.keys(vary)], ["explicit_euler", ["q", "p", "energy"], ["/initial/q", "/initial/p"]]);
  await becomes(async () => (await drawn(page, plane("A"), "--axis")).count, (count) => count > before + 150);
  assert.ok((await drawn(page, plane("A"), "--ink")).right > labels.right + 50, "the mark of the saddle on the right");
  assert.match(page.url(), /view\.field=levels/);
  assert.equal(await page.textContent("#rests"), "Equilibria: (−3.14; 0) saddle, (0; 0) centre, (3.14; 0) saddle.");
  await page.reload();
  await settled(page);
  assert.equal(await page.inputValue("#field"), "levels");
  await becomes(async () => (await drawn(page, plane("A"), "--axis")).count, (count) => count > before + 150);
  await page.selectOption("#field", "");
  await frames(page);
  await becomes(async () => (await drawn(page, plane("A"), "--axis")).count, (count) => count < before + 50);
  await page.selectOption("#problem", "driven_oscillator");
  await settled(page);
  assert.ok(!(await page.isVisible("#field")), "no plane tells all of what is driven");
});

const flow = { hash: "#problem=van_der_pol&until.t=20&axes.x=x&axes.y=v&view.field=true", reducedMotion: "reduce", expected: /status of 422/ };
pageTest("behind any flow in the plane lie its vector field and level curves of a formula, which is refused in words", flow, async (page) => {
  assert.equal(await page.inputValue("#field"), "levels", "what older links say");
  await becomes(() => page.textContent("#rests"), (said) => said === "Equilibria: (0; 0) unstable focus.");
  const inked = () => seen(page, plane("A"), (canvas) => { // how many pixels are not paper
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    return data.reduce((count, alpha, i) => count + (i % 4 === 3 && alpha > 40 ? 1 : 0), 0);
  });
  const none = await inked();
  await page.fill("#level", "x^2 + v^2");
  await page.press("#level", "Enter");
  await becomes(inked, (count) => count > none + 3000);
  const levels = await inked();
  assert.match(page.url(), /view\.field=levels&view\.level=x%5E2\+%2B\+v%5E2/);
  await page.selectOption("#field", "both");
  await becomes(inked, (count) => count > levels + 2000);
  const both = await inked();
  await page.reload();
  await settled(page);
  assert.deepEqual([await page.inputValue("#field"), await page.inputValue("#level")], ["both", "x^2 + v^2"]);
  await page.fill("#level", "x^2 + w");
  await page.press("#level", "Enter");
  await becomes(() => page.textContent("#level-fault"), (said) => /"?w"?/.test(said));
  assert.equal(await page.getAttribute("#level", "aria-invalid"), "true");
  await page.selectOption("#field", "arrows");
  await becomes(() => page.textContent("#level-fault"), (said) => said === "");
  assert.ok(!(await page.isVisible("#level")));
  await becomes(inked, (count) => count > none + 2000 && count < both - 2000);
});

const many = async (page, name) => page.inputValue(`#section [data-name=${name}]`);
pageTest("many runs begin as a portrait, as a strobe where a clock drives, as a section where there is more", pendulum, async (page) => {
  assert.deepEqual([await many(page, "where"), Number(await many(page, "period"))], ["", 0.075], "points close enough to be curves");
  await page.click("#measure-section");
  await becomes(() => page.textContent("#section-status"), (text) => /points of 40 runs/.test(text));
  await page.selectOption("#problem", "driven_oscillator");
  await settled(page);
  const frequency = Number(await fieldAt(page, "/problem/frequency").inputValue());
  assert.ok(Math.abs(Number(await many(page, "period")) - (2 * Math.PI) / frequency) < 1e-9);
  await page.selectOption("#problem", "henon_heiles");
  await settled(page);
  assert.deepEqual([await many(page, "where"), await many(page, "period")], ["x", ""]);
});

pageTest("a scene as text has portraits as well", { hash: "#problem=custom&problem.variables=x&problem.parameters=k=1&problem.potential=x^4/4-k*x^2/2&initial.x=1.2&until.t=20&A=leapfrog&B=leapfrog" }, async (page) => {
  await page.click("#add-start");
  await known(page);
  assert.deepEqual(await starts(page), [[1.2, 0.25]]);
  await frames(page);
  const look = () => page.locator(plane("A")).evaluate((canvas) => canvas.toDataURL()), before = await look();
  await page.selectOption("#field", "levels");
  await becomes(look, (now) => now !== before);
  await enter(page, "/problem/k", "0.5");
  await known(page);
  assert.deepEqual(await starts(page), [[1.2, 0.25]], "they stay when the scene is set otherwise");
});

pageTest("the pendulum's portrait opens in the workbench with its starts", { hash: "#lesson=portrait&set=2.2", ready: "#lesson[aria-busy=false]", reducedMotion: "reduce" }, async (page) => {
  const { runs } = JSON.parse(await page.evaluate(() => JSON.stringify(window.said)));
  assert.ok(runs[5].final.q > 2 * Math.PI, "beyond 2 the start at the bottom turns over");
  await page.click("#to-bench");
  await page.waitForSelector("#results[aria-busy=false]");
  await known(page);
  assert.deepEqual(await starts(page), [[2.4, 0], [0, 2.4], [0, -2.4], [0, 2], [0, 2.2]]);
  assert.equal(await page.inputValue("#axes [name=x]"), "q_wrapped");
  assert.equal(await pane(page, "A").locator(".scheme").inputValue(), "leapfrog");
});
