// Runs of the workbench while they go on, what happens on the way, and curves in space.
import assert from "node:assert/strict";
import { becomes, drawn, frames, pageTest, pane, plane, settled, statuses } from "./browser.mjs";
import { enter, fieldAt } from "./made.mjs";

const look = (page, selector) => page.locator(selector).evaluate((canvas) => canvas.toDataURL());

/** Runs go on for up to a minute: on a machine that is busy otherwise, ten seconds are over before all has been looked at. */
const enduring = (context) => context.route("**/v1/simulate", (route) =>
  route.continue({ postData: { ...route.request().postDataJSON(), limits: { seconds: 60, steps: 1e10 } } }));
const long = { hash: "#problem=kepler&until.t=9000&axes.x=t&axes.y=x&A=variational_midpoint&A.step=0.00001&B=leapfrog&B.step=0.01", ready: "#stop:not([hidden])", prepare: enduring };
pageTest("a long run is seen while it goes on, is stopped, and goes on from there", long, async (page) => {
  await page.waitForSelector("#progress:not([hidden])");
  const part = () => page.locator("#progress").evaluate(({ value }) => value);
  await becomes(part, (value) => value > 0.5); // B is done, A has begun
  await becomes(async () => (await drawn(page, plane("A"), "A")).count, (count) => count > 50);
  const first = await look(page, plane("A"));
  await becomes(() => look(page, plane("A")), (now) => now !== first);
  assert.equal(await page.getAttribute("#results", "aria-busy"), "true");
  await page.click("#stop");
  assert.deepEqual([await page.isVisible("#stop"), await page.isVisible("#progress")], [false, false]);
  assert.match(await pane(page, "A").locator(".messages .stop").textContent(), /cancelled.*t = \d.*stopped by hand/);
  assert.deepEqual(await statuses(page), ["stopped", "completed"]);
  assert.ok((await drawn(page, plane("A"), "A")).count > 50, "what came stays");
  await page.fill("[data-pointer='/scheme/step'] >> nth=0", "0.01");
  await page.click("#continue");
  await settled(page);
  const from = Number(await fieldAt(page, "/initial/t").inputValue());
  assert.ok(from > 0 && from < 9000 && (await fieldAt(page, "/until/t").inputValue()) === String(from + 9000), `${from}`);
  assert.notEqual(await fieldAt(page, "/initial/y").inputValue(), "-4");
  await page.keyboard.press("Control+z");
  await becomes(() => fieldAt(page, "/initial/y").inputValue(), (y) => y === "-4");
});

pageTest("undo goes back as far as this page went", { hash: "#problem=kepler&until.t=9" }, async (page) => {
  assert.ok(await page.isDisabled("#undo"));
  await enter(page, "/until/t", "8");
  await page.click("#undo");
  await becomes(() => fieldAt(page, "/until/t").inputValue(), (t) => t === "9");
  assert.ok(await page.isDisabled("#undo"));
});

const apsides = { hash: "#problem=kepler&until.t=95&events.more=apsis=x*px%2By*py&A=leapfrog&B=leapfrog", expected: /status of 422/ };
pageTest("events of one's own are marked in the picture, counted, and in the link", apsides, async (page) => {
  assert.match(await pane(page, "A").locator(".messages .events").textContent(), /^10 apsis/);
  assert.ok(await pane(page, "A").locator(".happened").isVisible());
  const marked = await look(page, plane("A"));
  assert.match(page.url(), /events\.more=apsis=x\*px/);
  await enter(page, "/events/more", "");
  assert.ok(!(await pane(page, "A").locator(".happened").isVisible()));
  assert.notEqual(await look(page, plane("A")), marked);
  await enter(page, "/events/more", "apsis = zz");
  assert.equal(await fieldAt(page, "/events/more").getAttribute("aria-invalid"), "true");
  assert.match(await page.locator("#events .fault").textContent(), /zz/);
});

pageTest("curves in space are turned by hand and by keys", { hash: "#problem=lorenz&until.t=30&axes.z=z", reducedMotion: "reduce" }, async (page) => {
  assert.equal(await page.inputValue("#axes [name=z]"), "z");
  const before = await look(page, plane("A")), box = await page.locator(plane("A")).boundingBox(), run = await drawn(page, plane("A"), "A");
  assert.ok(run.count > 500 && run.bottom - run.top > 0.4 * box.height, "the picture is filled");
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(...middle);
  await page.mouse.down();
  await page.mouse.move(middle[0] + 60, middle[1] + 20);
  await page.mouse.up();
  await page.mouse.move(2, 2);
  await frames(page);
  const turned = await look(page, plane("A"));
  assert.notEqual(turned, before);
  await pane(page, "B").locator(".lens button").first().focus();
  await page.keyboard.press("ArrowRight");
  await frames(page);
  assert.notEqual(await look(page, plane("A")), turned, "all are seen from one side");
  await page.locator("#motion .time input").fill("500");
  assert.ok((await drawn(page, ".pane[data-run=A] canvas.over", "A")).count > 20, "a head runs along");
  await page.selectOption("#axes [name=z]", "");
  assert.match(await page.getAttribute(plane("A"), "aria-label"), /^y over x of run A/);
});

pageTest("the cross-hair of one picture tells its time and values in all", { hash: "#problem=pendulum&until.t=9", reducedMotion: "reduce" }, async (page) => {
  const { x, y } = await page.locator(plane("A")).boundingBox(), run = await drawn(page, plane("A"), "A"), over = ".pane[data-run=B] canvas.over";
  assert.equal((await drawn(page, over, "--ink")).count, 0);
  await page.mouse.move(x + run.left + 2, y + (run.top + run.bottom) / 2);
  assert.ok((await drawn(page, over, "B")).count > 20, "where B is then");
  assert.ok((await drawn(page, over, "--ink")).count > 20, "and in numbers");
  await page.mouse.move(2, 2);
  assert.equal((await drawn(page, over, "--ink")).count, 0);
});
