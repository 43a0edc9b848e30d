// The lessons: each runs, and what it claims is true of the data that the page shows.
import assert from "node:assert/strict";
import { test } from "node:test";
import { mkdirSync, readFileSync } from "node:fs";
import { all, becomes, drawn, frames, origin, pageTest } from "./browser.mjs";
import { claims } from "./claims.mjs";
import { lessons } from "../../web/lessons/lessons.js";
import { remembering } from "../../web/lessons/requests.js";

const en = JSON.parse(readFileSync(new URL("../../web/language/en.json", import.meta.url)));
const ready = "#lesson[aria-busy=false]";
const calm = { ready, reducedMotion: "reduce" };

const said = async (page) => JSON.parse(await page.evaluate(() => JSON.stringify(window.said)));
const times = async (page) => Number(await page.getAttribute("html", "data-times"));
const opened = (page, id) => page.waitForSelector(`html[data-shown=${id}]`);

/** Work-precision has time for the points of a quiet machine, whatever else this one does. */
const patient = (context) => context.route("**/v1/work-precision", (route) =>
  route.continue({ postData: { ...route.request().postDataJSON(), budget_seconds: 8 } }));

pageTest("every lesson runs, its claim is true, and its picture is in sight on every screen", { ...calm, viewport: { width: 1280, height: 720 }, prepare: patient }, async (page) => {
  for (const [i, lesson] of lessons.entries()) {
    if (i > 0) await page.keyboard.press("ArrowRight");
    await opened(page, lesson.id);
    const { runs, study } = await said(page);
    claims[lesson.id](study ?? runs);
    assert.equal(await page.textContent("#claim"), en[`lesson.${lesson.id}.title`]);
    assert.equal(await page.textContent("#lesson .wrong"), "");
    assert.equal(await page.locator("#legend tbody").count(), lesson.runs?.length ?? 0);
    const forces = (await all(page, "#legend td:nth-of-type(1) data", "value")).map(Number);
    assert.deepEqual(forces, runs.map(({ cost }) => cost.force_evaluations), "the work stands beside each run");
    for (const colour of ["a", "b"]) {
      if (!study) assert.ok(await seen(page, `--run-${colour}`), `${lesson.id}: run ${colour} is drawn`);
    }
    await assertInSight(page, lesson.id, "#figures :is(canvas.plane, .precision)");
    const high = await page.evaluate(() => document.documentElement.scrollHeight); // at 1280 × 720
    assert.ok(high <= 720 || high > 760, `${lesson.id} scrolls by ${high - 720} pixels, for nothing`);
    if (folder) await presented(page, lesson.id);
  }
  assert.equal(lessons.length, Object.keys(claims).length);
  assert.ok(await page.isDisabled("#next"));
});

/** Whether some picture has a colour. */
async function seen(page, colour) {
  const pictures = await page.locator("#figures figure").count();
  for (let i = 1; i <= pictures; i++) {
    if ((await drawn(page, `#figures figure:nth-child(${i}) canvas:not(.over)`, colour)).count > 40) return true;
  }
  return false;
}

// 640 × 360 is 1280 × 720 at twice the size.
const screens = [[1280, 720], [1024, 768], [360, 740], [640, 360]];
const folder = process.env.LEAST_SCREENSHOTS;
if (folder) mkdirSync(folder, { recursive: true });

async function presented(page, name) {
  await page.click("#present");
  await frames(page);
  await page.screenshot({ path: `${folder}/${name}-present.png` });
  await page.keyboard.press("Escape");
}

/** On every screen the first picture, at `selector`, is in sight and nothing is cut off. */
async function assertInSight(page, name, selector) {
  for (const [width, height] of screens) {
    await page.setViewportSize({ width, height });
    const { y, height: high, width: wide } = await page.locator(selector).first().boundingBox();
    const shown = Math.min(y + high, height) - y;
    const beside = name === "paper" ? 2 : 1; // four beside each other
    assert.ok(y >= 0 && shown > Math.min(0.75 * high, 0.35 * height) && wide * beside > 0.25 * width,
              `${name} at ${width} × ${height}: ${shown} of ${high} at ${y}`);
    await becomes(() => page.evaluate(() => document.documentElement.scrollWidth), (wide) => wide <= width); // nothing is cut off, once it is laid out
    for (const colorScheme of folder ? ["light", "dark"] : []) {
      await page.emulateMedia({ colorScheme });
      await frames(page);
      await page.screenshot({ path: `${folder}/${name}-${width}x${height}-${colorScheme}.png` });
    }
  }
  const [[width, height]] = screens;
  await page.setViewportSize({ width, height });
}

pageTest("the workbench shows a picture on the first screen, whatever its size", { hash: "#problem=kepler&until.t=95", reducedMotion: "reduce" },
  (page) => assertInSight(page, "workbench", ".pane canvas.plane"));

pageTest("equal work and equal steps, by a button each", { ...calm, hash: "#lesson=pendulum" }, async (page) => {
  const forces = async () => (await said(page)).runs.map(({ cost }) => cost.force_evaluations);
  const click = async (button) => {
    const before = await times(page);
    await page.click(button);
    await page.waitForSelector(`html[data-times="${before + 1}"]`);
  };
  await click("#equal-step");
  assert.deepEqual((await said(page)).runs.map(({ scheme }) => scheme.step), [0.2, 0.2]);
  const [one, four] = await forces();
  assert.ok(four > 3.9 * one, "Runge–Kutta is nearly perfect at four times the work, and the page says so");
  assert.match(page.url(), /lesson=pendulum&steps=0.2,0.2/);
  await click("#equal-work");
  const [a, b] = await forces();
  assert.ok(Math.abs(a / b - 1) < 0.01, `${a}, ${b}`);
  await page.goBack();
});

pageTest("the control answers while it is dragged, with fewer points, one request at a time", { ...calm, hash: "#lesson=damped" },
  async (page) => {
    let flying = 0, most = 0, release;
    const moved = new Promise((resolve) => (release = resolve)); // answers wait until the mouse has made all its moves
    const sizes = [];
    await page.route("**/v1/simulate", async (route) => {
      most = Math.max(most, ++flying);
      sizes.push(route.request().postDataJSON().record.samples);
      await moved;
      await route.continue().catch(() => {});
      flying--;
    });
    const before = await times(page);
    const track = page.locator("#control input[type=range]"), { x, y, width, height } = await track.boundingBox();
    await page.mouse.move(x + width / 3, y + height / 2);
    await page.mouse.down();
    for (let i = 1; i <= 20; i++) await page.mouse.move(x + width / 3 + (i * width) / 40, y + height / 2);
    await page.mouse.up();
    release();
    await page.waitForSelector(ready);
    const shown = (await times(page)) - before;
    assert.equal(most, 2, "the two runs of one question");
    assert.ok(shown >= 2 && sizes.length <= 6, `${shown} pictures, ${sizes.length} requests for twenty moves`);
    assert.ok(sizes[0] < 1000 && sizes.at(-1) >= 4000, `${sizes}`);
    const value = Number(await page.inputValue("#control input[type=text]"));
    assert.equal((await said(page)).runs[0].problem.damping, value, "the newest wins");
  });

test("answers of the runs that stay are kept however long another is moved", async () => {
  let asked = 0;
  const ask = remembering(async () => ({ outcome: {}, asked: ++asked }));
  for (let k = 0; k < 30; k++) {
    for (let still = 0; still < 5; still++) await ask({ still, record: { samples: 10 } });
    await ask({ moved: k, record: { samples: 10 } });
  }
  assert.equal(asked, 5 + 30);
});

pageTest("while one run is moved the others are not run again", { ...calm, hash: "#lesson=relaxation" }, async (page) => {
  const asked = [];
  page.on("request", (request) => request.url().endsWith("/v1/simulate") && asked.push(request.postDataJSON()));
  const before = await times(page);
  await page.locator("#control input[type=range]").evaluate((track) => {
    track.value = String(Number(track.value) + 50);
    track.dispatchEvent(new Event("input", { bubbles: true }));
  });
  await becomes(() => times(page), (now) => now > before);
  await page.locator("#control input[type=range]").evaluate((track) => track.dispatchEvent(new Event("change", { bubbles: true })));
  const samples = async () => (await said(page)).runs.map(({ trajectory: { t } }) => t.length);
  await becomes(samples, (counts) => counts.every((count) => count === 4000)); // in the end all have all their samples
  const moved = Number(await page.inputValue("#control input[type=text]"));
  assert.ok(asked.length >= 1 && asked.every(({ problem }) => problem.epsilon === moved), JSON.stringify(asked.map(({ problem }) => problem)));
  const { runs } = await said(page);
  assert.deepEqual(runs.map(({ problem }) => problem.epsilon), [moved, 10, 100, 1000]);
});

pageTest("a lesson plays, pauses and is wound by hand; the bodies move", { ready, hash: "#lesson=pendulum" }, async (page) => {
  const body = () => page.locator("#figures canvas.body").evaluate((canvas) => canvas.toDataURL());
  const time = async () => Number((await page.textContent("#lesson .player output")).replace("t = ", ""));
  assert.match(await page.textContent("#lesson .play"), /Pause/, "it plays by itself");
  const first = await body(), early = await time();
  await becomes(body, (now) => now !== first);
  await becomes(time, (now) => now > early);
  await page.locator("#claim").focus();
  await page.keyboard.press("Space");
  const stopped = await time();
  await page.waitForTimeout(150);
  assert.equal(await time(), stopped, "space stops it");
  await page.locator("#lesson .time input").fill("500");
  assert.equal(await time(), 600);
});

pageTest("a planet goes round its sun, and each run plays at its own pace", { ...calm, hash: "#lesson=relaxation" }, async (page) => {
  await page.locator("#lesson .time input").fill("500");
  assert.match(await page.textContent("#lesson .player output"), /^t = 1\.0\d+ periods$/);
  for (const [i, run] of ["A", "B", "C", "D"].entries()) { // half way, all of them
    const canvas = `#figures figure:nth-child(${i + 1}) canvas.over`, { left, right } = await drawn(page, canvas, run);
    const { clientWidth } = await page.locator(canvas).evaluate((over) => ({ clientWidth: over.clientWidth }));
    assert.ok(left > 0.4 * clientWidth && right < 0.65 * clientWidth, `${run}: ${left} to ${right} of ${clientWidth}`);
  }
  await page.evaluate(() => (location.hash = "#lesson=orbit"));
  await opened(page, "orbit");
  assert.ok((await drawn(page, "#figures figure:nth-child(2) canvas.plane", "--sun")).count > 40);
});

pageTest("on a telephone no part of a lesson covers another", { ...calm, hash: "#lesson=stars", viewport: { width: 360, height: 740 } }, async (page) => {
  for (const part of ["#look", "#control input", "#legend", "#see", "#to-bench"]) {
    await page.locator(part).first().click({ trial: true, timeout: 5000 });
  }
});

pageTest("the numbers beside the pendulums of a clock are its period and what that depends on", { ...calm, hash: "#lesson=clock" }, async (page) => {
  const rows = await page.locator("#legend tbody").evaluateAll((bodies) => bodies.map((body) => [...body.querySelectorAll("data")].map(({ value }) => Number(value))));
  const { runs } = await said(page);
  rows.forEach(([, period, byAngle, byLength, perDay], i) => {
    const { t: [slope] } = runs[i].sensitivities.events[0];
    assert.ok(Math.abs(byLength / (period / 2 / 0.994) - 1) < 1e-9 && byAngle === slope, `${rows[i]}`);
    assert.ok(Math.abs(perDay / ((86400 * slope * Math.PI) / 180 / period) - 1) < 1e-9, `${perDay}`);
  });
});

pageTest("who wishes for less motion sees all at once", { ...calm, hash: "#lesson=pendulum" }, async (page) => {
  assert.match(await page.textContent("#lesson .play"), /Play/);
  assert.equal(await page.textContent("#lesson .player output"), "t = 1200");
});

pageTest("a link to no lesson is said", { ...calm, hash: "#lesson=nothing" }, async (page) => {
  assert.match(await page.textContent("#notice"), /no lesson “nothing”/);
  assert.equal(await page.textContent("#claim"), en[`lesson.${lessons[0].id}.title`]);
});

pageTest("a view in space is turned by hand", { ...calm, hash: "#lesson=cosmos" }, async (page) => {
  const look = () => page.locator("#figures canvas.plane").first().evaluate((canvas) => canvas.toDataURL());
  const before = await look(), { x, y, width, height } = await page.locator("#figures canvas.plane").first().boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 + 80, y + height / 2 + 20);
  await page.mouse.up();
  await page.mouse.move(2, 2); // no cross-hair, which shows a time of its own
  assert.notEqual(await look(), before);
});

pageTest("the gallery stands in groups, its numbers beside the words", { ...calm, viewport: { width: 1024, height: 768 } }, async (page) => {
  await page.click(".all summary");
  const groups = await page.locator("#gallery section").evaluateAll((found) => found.map((section) => ({
    title: section.querySelector("h3").textContent, from: section.querySelector("ol").start, links: section.querySelectorAll("a").length,
    room: section.querySelector("a").getBoundingClientRect().left - section.getBoundingClientRect().left })));
  assert.deepEqual(groups.map(({ title }) => title), lessons.flatMap(({ group }) => (group ? [en[`group.${group}`]] : [])));
  let next = 1;
  for (const { from, links, room } of groups) {
    assert.equal(from, next);
    assert.ok(links > 0 && room > 30, `${room} pixels for the number`);
    next += links;
  }
  assert.equal(next, lessons.length + 1);
  assert.deepEqual(await all(page, "#which optgroup", "label"), groups.map(({ title }) => title));
});

pageTest("the ellipses of the paper are large, and the stretch in a coordinate is marked and named", { ...calm, hash: "#lesson=paper", viewport: { width: 1280, height: 720 } }, async (page) => {
  for (const [i, run] of ["A", "B", "C", "D"].entries()) {
    const { top, bottom } = await drawn(page, `#figures figure:nth-child(${i + 1}) canvas.plane`, run);
    assert.ok(bottom - top > 250, `${run}: ${bottom - top} pixels high`);
  }
  assert.ok((await drawn(page, "#figures figure:nth-child(3) canvas.plane", "--stretch")).count > 200);
  assert.match(await page.textContent("#legend caption"), /Jacobi–Maupertuis/);
  await page.setViewportSize({ width: 360, height: 740 });
  const { width } = await page.locator("#figures figure").first().boundingBox();
  assert.ok(width > 140, "two beside each other on a telephone");
});

pageTest("level curves of the landscape lie behind the paths, and change with it", { ...calm, hash: "#lesson=downhill" }, async (page) => {
  const lines = () => drawn(page, "#figures figure:nth-child(1) canvas.plane", "--axis", [0.3, 0.5]);
  const before = await lines();
  await page.evaluate(() => (location.hash = "#lesson=downhill&set=-0.8"));
  await becomes(async () => (await said(page)).runs[0].problem.c, (c) => c === -0.8);
  assert.ok(before.count > 100 && (await lines()).count !== before.count, `${before.count}`);
});

pageTest("a key says what the colours of many runs mean", { ...calm, hash: "#lesson=islands" }, async (page) => {
  assert.match(await page.textContent("#figures .key"), /^spin at the start 0\.71\.7$/);
  assert.ok(await page.locator("#figures .hues").evaluate((node) => node.clientWidth > 80 && getComputedStyle(node).backgroundImage.includes("gradient")));
  await page.evaluate(() => (location.hash = "#lesson=basins"));
  await opened(page, "basins");
  const { study: { ends } } = await said(page), [, low, high] = /^velocity at the end (−?[\d.]+?)(\d\.\d+)$/.exec(await page.textContent("#figures .key"));
  const [least, most] = ends.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
  assert.ok(Math.abs(Number(low.replace("−", "-")) - least) < 0.01 && Math.abs(high - most) < 0.01, `${low} to ${high}`);
  assert.doesNotMatch(en["lesson.galaxy.look"], /energy is/, "what the control changes is not said to be so");
});

const late = async (opened) => opened.route("**/workbench/bench.js", async (route) => {
  await new Promise((resolve) => setTimeout(resolve, 400));
  return route.fallback();
});
pageTest("the workbench is fetched when it is asked for, and whoever has left meanwhile does not see it", { ...calm, prepare: late }, async (page) => {
  const fetched = () => page.evaluate(() => performance.getEntriesByType("resource").filter(({ name }) => /workbench\/.*js$/.test(name)).length);
  assert.equal(await fetched(), 0);
  await page.evaluate(() => (location.hash = "#problem=pendulum"));
  await page.waitForSelector("#experiment:not([hidden])");
  await page.evaluate(() => (location.hash = "#lesson=spiral"));
  await opened(page, "spiral");
  await page.waitForTimeout(600);
  assert.ok((await page.isVisible("#claim")) && !(await page.isVisible("#experiment")));
  assert.ok((await fetched()) > 5);
  await page.evaluate(() => (location.hash = "#problem=pendulum"));
  await page.waitForSelector("#results[aria-busy=false]");
  assert.equal(await page.inputValue("#problem"), "pendulum");
});

pageTest("the page is small: what a lesson needs, in one language, and the workbench behind it", calm, async (page) => {
  const { gzipSync } = await import("node:zlib");
  const texts = (language) => gzipSync(readFileSync(new URL(`../../web/language/${language}.json`, import.meta.url))).length;
  const size = { first: Math.max(texts("en"), texts("de")), later: texts("de.catalogue") };
  const files = [["", "first"]], seen = new Set();
  for (let i = 0; i < files.length; i++) {
    const [file, part] = files[i], source = await page.evaluate(async (path) => (await fetch(path)).text(), `/${file}`);
    size[part] += gzipSync(source).length;
    for (const [, how, path] of source.matchAll(/(from |href=|src=|import\()"([\w./-]+\.(?:js|css|svg))"/g)) {
      const name = new URL(path, `${origin}/${file}`).pathname.slice(1);
      if (!seen.has(name)) files.push([name, how === "import(" ? "later" : part]);
      seen.add(name);
    }
  }
  assert.ok(files.length > 45 && size.first < 150_000 && size.later < 100_000, `${JSON.stringify(size)} bytes in ${files.length} files`);
});
