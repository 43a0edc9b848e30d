// The lessons: each runs, and what it claims is true of the data that the page shows.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { all, becomes, drawn, frames, origin, pageTest } from "./browser.mjs";
import { lessons } from "../../web/lessons/lessons.js";

const ready = "#lesson[aria-busy=false]";
const calm = { ready, reducedMotion: "reduce" };

const said = async (page) => JSON.parse(await page.evaluate(() => JSON.stringify(window.said)));
const times = async (page) => Number(await page.getAttribute("html", "data-times"));
const opened = (page, id) => page.waitForSelector(`html[data-shown=${id}]`);

const end = (values) => values.findLast((v) => v !== null);
const largest = (values) => Math.max(...values.map(Math.abs));
const falls = (values) => values.every((v, i) => i === 0 || v <= values[i - 1] + 1e-6);
const share = (values, wanted) => values.filter(wanted).length / values.length;

/** What each lesson says, as a condition on its runs (of a study: on its curves). */
const claims = {
  orbit([good, bad]) {
    assert.ok(Math.abs(good.cost.force_evaluations / bad.cost.force_evaluations - 1) < 0.01, "equal work");
    assert.ok(Math.abs(good.diagnostics.orbit.semi_major_axis - 1) < 0.01 && bad.diagnostics.orbit.semi_major_axis < 0.8);
    assert.ok(largest(good.trajectory.energy.map((e) => e + 0.5)) < 0.002 && end(bad.trajectory.energy) < -0.6);
  },
  spiral([euler, midpoint, leapfrog]) {
    assert.ok(largest(euler.trajectory.q) > 1000 && end(midpoint.trajectory.energy) > 0.7);
    assert.ok(largest(leapfrog.trajectory.q) < 1.05);
  },
  pendulum([good, bad]) {
    const late = ({ trajectory: { q } }) => largest(q.slice(-400));
    assert.ok(Math.abs(good.cost.force_evaluations / bad.cost.force_evaluations - 1) < 0.01, "equal work");
    assert.ok(late(good) > 1.95 && late(bad) < 0.5);
  },
  portrait([little, far, over, back, between, own]) {
    const turns = ({ trajectory: { q } }) => largest(q) > Math.PI, returns = ({ trajectory: { q } }) => q.some((v, i) => i > 0 && v * q[i - 1] < 0);
    assert.ok([little, far, own].every((run) => !turns(run) && returns(run)) && turns(over) && turns(back));
    assert.ok(end(over.trajectory.q) > 4 * Math.PI && end(back.trajectory.q) < -4 * Math.PI);
    const { q, p } = between.trajectory;
    assert.ok(!turns(between) && end(q) > 3.14 && p.every((v, i) => Math.abs(v - 2 * Math.cos(q[i] / 2)) < 2e-3), "on the separatrix");
  },
  paper(runs) {
    const [long, short, hybrid, timed] = runs.map(({ diagnostics }) => Math.abs(diagnostics.orbit.apsidal_rotation));
    assert.ok(Math.abs(long / 0.0454 - 1) < 0.02 && Math.abs(long / short - 4) < 0.3 && hybrid < 1e-4 && timed < 1e-10);
    assert.ok(runs[2].trajectory.mode.includes("jacobi_maupertuis"));
  },
  damped([contact, other]) {
    const off = ({ trajectory: { mechanical_energy: e } }) => end(e) / (0.5 * Math.exp(-0.1 * 300));
    assert.ok(Math.abs(off(contact) - 1) < 0.2 && off(other) < 0.01, `${off(contact)}, ${off(other)}`);
  },
  driven: (runs) => assert.ok(Math.max(...runs.map(({ final: { q } }) => q)) - Math.min(...runs.map(({ final: { q } }) => q)) < 0.02),
  orders(runs) {
    const truth = runs[3].final, [second, fourth, sixth] = runs.map(({ final: { x, y } }) => Math.hypot(x - truth.x, y - truth.y));
    assert.ok(second > 50 * fourth && fourth > 50 * sixth, `${second}, ${fourth}, ${sixth}`);
  },
  stars(runs) {
    const [flat, sine, plummer, own] = runs.map(({ diagnostics }) => diagnostics.zeros[0]);
    assert.ok(Math.abs(flat - Math.sqrt(6)) < 1e-3 && Math.abs(sine - Math.PI) < 1e-3 && plummer === undefined && own > sine);
    const { t, q } = runs[2].trajectory;
    assert.ok(largest(t.map((r, i) => q[i] - 1 / Math.sqrt(1 + (r * r) / 3))) < 1e-4, "the formula");
  },
  relaxation(runs) {
    const [one, ten, hundred, thousand] = runs.map(({ diagnostics }) => diagnostics.cycle);
    assert.ok([one, ten, hundred, thousand].every(({ amplitude }) => Math.abs(amplitude - 2) < 0.02));
    assert.ok(one.period < 7 && ten.period < 20 && Math.abs(thousand.period / hundred.period / 10 - 1) < 0.02);
  },
  capture: (runs) => assert.ok(runs.every(({ trajectory: { p } }) => Math.abs(p.slice(-1000).reduce((a, b) => a + b) / 1000 - 1) < 0.02)),
  cosmos([first, second, euler]) {
    const off = ({ trajectory: { q, p, s } }) => largest(q.map((_, i) => Math.hypot(q[i], p[i], s[i]) - Math.SQRT2));
    assert.ok(off(first) < 1e-3 && off(second) < 1e-3 && off(euler) > 0.05);
    assert.ok(first.trajectory.s[0] < -1.2 && Math.abs(first.final.s - Math.SQRT2) < 1e-3, "from pole to pole");
  },
  bath([narrow, wide]) {
    const inner = ({ trajectory: { q } }) => share(q, (v) => Math.abs(v) < 0.6745); // of a Gaussian 0.5
    const far = ({ trajectory: { q } }) => share(q, (v) => Math.abs(v) > 2.3); // of a Gaussian 0.021
    assert.ok(Math.abs(inner(narrow) - 0.5) < 0.02 && Math.abs(far(narrow) - 0.021) < 0.006, `${inner(narrow)} ${far(narrow)}`);
    assert.equal(far(wide), 0);
  },
  downhill(runs) {
    assert.ok(runs.every(({ trajectory: { potential } }) => falls(potential)));
    assert.deepEqual([...new Set(runs.map(({ final: { x } }) => Math.sign(x)))].sort(), [-1, 1], "both wells");
  },
  heat([splitting, euler]) {
    assert.ok(largest(splitting.trajectory.energy.map((e) => e - 1.5)) < 1e-12 && end(euler.trajectory.energy) > 10);
    assert.ok(splitting.diagnostics.entropy.monotone && splitting.diagnostics.entropy.final > 0.3);
  },
  butterfly([a, b]) {
    const apart = a.trajectory.x.map((x, i) => Math.abs(x - b.trajectory.x[i])), part = Math.floor(apart.length / 5);
    assert.ok(largest(apart.slice(0, part)) < 1e-2 && largest(apart.slice(-2 * part)) > 10);
  },
  islands(points) {
    const found = widths(points), sways = found.filter((width) => width < Math.PI).length;
    assert.ok(found.length === 40 && sways >= 5 && sways <= 15 && found.filter((width) => width > 5.4).length === 40 - sways, `${found}`);
  },
  galaxy({ member, x, y }) {
    const visited = Array.from({ length: 20 }, (_, m) => new Set(member.flatMap((of, i) => (
      of === m ? [`${Math.floor(x[i] * 50)},${Math.floor(y[i] * 50)}`] : []))).size);
    assert.ok(member.length > 4000 && Math.max(...visited) < 125, `each on a curve of its own, not all over the plane: ${visited}`);
  },
  basins({ ends }) {
    const near = (speed) => share(ends, (v) => Math.abs(v - speed) < 0.02), [back, forth] = [near(-0.607), near(2.04)];
    assert.ok(ends.length === 512 * 512 && back > 0.3 && forth > 0.3 && back + forth > 0.95, `${back} and ${forth} of ${ends.length}`);
  },
  typed: (runs) => assert.deepEqual(runs.map(({ final: { x } }) => Math.round(x)), [1, -1, 1]),
  digits(curves) {
    assert.equal(curves.length, 5);
    const slope = ({ points }) => {
      const good = points.filter(({ error }) => error > 1e-10 && error < 1e-2), [a, b] = [good[0], good.at(-1)];
      return -Math.log(b.error / a.error) / Math.log(b.force_evaluations / a.force_evaluations);
    };
    assert.ok(Math.abs(slope(curves[0]) - 2) < 0.4, `leapfrog pays threefold for a digit: ${slope(curves[0])}`);
    assert.ok(slope(curves[2]) > 6, `order 8: ${slope(curves[2])}`);
  },
};

/** How wide each member of a portrait is. */
function widths({ member, x }) {
  const ends = new Map();
  member.forEach((m, i) => {
    const [low, high] = ends.get(m) ?? [Infinity, -Infinity];
    ends.set(m, [Math.min(low, x[i]), Math.max(high, x[i])]);
  });
  return [...ends.values()].map(([low, high]) => high - low);
}

pageTest("every lesson runs, its claim is true, and its picture is in sight on every screen", { ...calm, viewport: { width: 1280, height: 720 } }, async (page) => {
  for (const [i, lesson] of lessons.entries()) {
    if (i > 0) await page.keyboard.press("ArrowRight");
    await opened(page, lesson.id);
    const { runs, study } = await said(page);
    claims[lesson.id](study ?? runs);
    assert.equal(await page.textContent("#claim"), lesson.title);
    assert.equal(await page.textContent("#lesson .wrong"), "");
    assert.equal(await page.locator("#legend tbody").count(), lesson.runs?.length ?? 0);
    const forces = (await all(page, "#legend td:nth-of-type(1) data", "value")).map(Number);
    assert.deepEqual(forces, runs.map(({ cost }) => cost.force_evaluations), "the work stands beside each run");
    for (const colour of ["a", "b"]) {
      if (!study) assert.ok(await seen(page, `--run-${colour}`), `${lesson.id}: run ${colour} is drawn`);
    }
    await assertInSight(page, lesson.id, "#figures :is(canvas.plane, .precision)");
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
    const whole = page.waitForFunction((room) => document.documentElement.scrollWidth <= room, width, { timeout: 5000 });
    assert.ok(await whole.then(() => true, () => false), `${name} is not cut off at ${width}`); // once it is laid out
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
    let flying = 0, most = 0;
    const sizes = [];
    await page.route("**/v1/simulate", async (route) => {
      most = Math.max(most, ++flying);
      sizes.push(route.request().postDataJSON().record.samples);
      await new Promise((resolve) => setTimeout(resolve, 60));
      await route.continue().catch(() => {});
      flying--;
    });
    const before = await times(page);
    const track = page.locator("#control input[type=range]"), { x, y, width, height } = await track.boundingBox();
    await page.mouse.move(x + width / 3, y + height / 2);
    await page.mouse.down();
    for (let i = 1; i <= 20; i++) await page.mouse.move(x + width / 3 + (i * width) / 40, y + height / 2);
    await page.mouse.up();
    await page.waitForSelector(ready);
    const shown = (await times(page)) - before;
    assert.equal(most, 2, "the two runs of one question");
    assert.ok(shown >= 2 && sizes.length < 40, `${shown} pictures, ${sizes.length} requests for twenty moves`);
    assert.ok(sizes[0] < 1000 && sizes.at(-1) >= 4000, `${sizes}`);
    const value = Number(await page.inputValue("#control input[type=text]"));
    assert.equal((await said(page)).runs[0].problem.damping, value, "the newest wins");
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

pageTest("who wishes for less motion sees all at once", { ...calm, hash: "#lesson=pendulum" }, async (page) => {
  assert.match(await page.textContent("#lesson .play"), /Play/);
  assert.equal(await page.textContent("#lesson .player output"), "t = 1200");
});

pageTest("presentation: one picture, large type, keys; and back goes back", { ...calm, viewport: { width: 1280, height: 720 } },
  async (page) => {
    await page.click("#present");
    await frames(page);
    assert.equal(await page.locator("#figures figure:visible").count(), 1);
    for (const run of ["A", "B"]) assert.ok((await drawn(page, "#figures .one canvas.plane", run)).count > 1000, `${run} in the one picture`);
    const sizes = await page.evaluate(() => [...document.querySelectorAll("#claim, #legend td, #see, canvas.plane")]
      .map((node) => parseFloat(getComputedStyle(node).fontSize)));
    assert.ok(Math.min(...sizes) >= 20, `${sizes}`);
    const { y, width, height } = await page.locator("#figures .one canvas.plane").boundingBox();
    assert.ok(width > 750 && height > 480 && y + height <= 720, `${width} × ${height} at ${y}`);
    await page.keyboard.press("ArrowRight");
    await opened(page, "spiral");
    assert.equal(await page.locator("#figures figure:visible").count(), 1);
    await page.keyboard.press("ArrowLeft");
    await opened(page, "orbit");
    await page.keyboard.press("Escape");
    assert.ok((await page.locator("#figures figure:visible").count()) > 1);
    await page.goBack();
    await opened(page, "spiral");
    await page.click("#to-bench");
    await page.waitForSelector("#results[aria-busy=false]");
    assert.deepEqual(await all(page, ".pane .scheme", "value"), ["explicit_euler", "explicit_midpoint", "leapfrog"]);
    assert.equal(await page.inputValue("[data-pointer='/until/t']"), "60", "the same scene");
    await page.goBack();
    await opened(page, "spiral");
  });

pageTest("a link to no lesson is said", { ...calm, hash: "#lesson=nothing" }, async (page) => {
  assert.match(await page.textContent("#notice"), /no lesson “nothing”/);
  assert.equal(await page.textContent("#claim"), lessons[0].title);
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
  assert.deepEqual(groups.map(({ title }) => title), lessons.map(({ group }) => group).filter(Boolean));
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
  assert.doesNotMatch(lessons.find(({ id }) => id === "galaxy").look, /energy is/, "what the control changes is not said to be so");
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

pageTest("the page is small", calm, async (page) => {
  let bytes = 0;
  const { gzipSync } = await import("node:zlib");
  const files = [""], seen = new Set();
  for (let i = 0; i < files.length; i++) {
    const text = await page.evaluate(async (path) => (await fetch(path)).text(), `/${files[i]}`);
    bytes += gzipSync(text).length;
    for (const [, path] of text.matchAll(/(?:from |href=|src=|import\()"([\w./-]+\.(?:js|css|svg))"/g)) {
      const name = new URL(path, `${origin}/${files[i]}`).pathname.slice(1);
      if (!seen.has(name)) files.push(name);
      seen.add(name);
    }
  }
  assert.ok(files.length > 45 && bytes < 150_000, `${bytes} bytes in ${files.length} files`);
});
