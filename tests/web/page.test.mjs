// The page with the scenes and schemes that the program has.
import assert from "node:assert/strict";
import { test } from "node:test";
import { all, assertDrawn, catalogue, drawn, frames, number, options, origin, pageTest, pane, plane, seen, settled, statuses, stepOf } from "./browser.mjs";

const revolutions = { hash: "#problem=kepler&until.t=95" };
pageTest("the workbench opens with the paper's orbit, which precesses less with half the step", revolutions, async (page) => {
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
  assert.equal(await stepOf(page, "A").inputValue(), "0.01");
  assert.equal(await stepOf(page, "B").inputValue(), "0.005");
  const [a, b] = [await number(page, "apsidal_rotation", "A"), await number(page, "apsidal_rotation", "B")];
  assert.ok(Math.abs(a / 0.0454 - 1) < 0.02, `apsidal rotation per period at h = 0.01: ${a}`);
  assert.ok(Math.abs(b / 0.0117 - 1) < 0.03, `apsidal rotation per period at h = 0.005: ${b}`);
  assert.ok((await number(page, "energy", "A")) > (await number(page, "energy", "B")));
  assert.ok((await number(page, "steps", "B")) === 2 * (await number(page, "steps", "A")));
  assert.equal(await page.locator("#formula math").count(), 1);
  assert.equal(await page.locator(".fault").count(), 0);
  await assertDrawn(page);
  const [wide, narrow] = [await drawn(page, plane("A"), "A"), await drawn(page, plane("B"), "B")];
  assert.ok(wide.right - wide.left > 1.1 * (narrow.right - narrow.left), "the ellipses of A fan out more than those of B");
});

test("the page forbids foreign and inline code", options, async () => {
  const response = await fetch(`${origin}/`);
  const policy = response.headers.get("content-security-policy") ?? "";
  assert.match(policy, /default-src 'self'/);
  assert.doesNotMatch(policy, /unsafe|\*|https?:|data:/);
  assert.doesNotMatch(await response.text(), /\sstyle=|\son\w+=|<style|<script>/);
});

pageTest("every problem of the catalogue rebuilds the forms and runs, also with each of its presets", {}, async (page) => {
  let excluded = 0;
  for (const problem of catalogue.problems) {
    await page.evaluate((hash) => (location.hash = hash), `problem=${problem.id}&record.samples=800`);
    await shows(page, problem.id);
    const names = (form) => all(page, `${form} [data-name]`, "dataset.name");
    assert.deepEqual(await names("#parameters"), problem.parameters.map((p) => p.name), problem.id);
    assert.deepEqual(await names("#initial"), [...problem.variables.map((v) => v.name), "t"], problem.id);
    for (const run of ["A", "B"]) {
      const offered = await all(page, `.pane[data-run=${run}] .scheme option`, "value");
      assert.deepEqual([...offered].sort(), [...problem.schemes].sort(), `${problem.id}: only schemes that fit`);
      excluded += catalogue.schemes.length - offered.length;
      const scheme = catalogue.schemes.find((s) => offered.includes(s.id) && s.id === chosenIn(page.url(), run));
      const composition = scheme.parameters.find((p) => p.name === "composition");
      if (composition) {
        const choices = await all(page, `.pane[data-run=${run}] [data-name=composition] option`, "value");
        assert.deepEqual(choices, composition.choices);
      }
    }
    await assertRan(page, problem);
    const bodies = Boolean(problem.form); // a scene as text may show many, each in a colour of its own
    if (bodies) await assertBodiesDrawn(page, problem.id);
    else await assertDrawn(page);
    assert.equal(await page.locator("#energy").isVisible(), problem.columns.includes("energy"), problem.id);
    for (const { name, until, suggested } of problem.presets) {
      if (until.t / (suggested.step ?? problem.suggested.step) > 1e7) continue; // seconds
      await page.selectOption("#preset", name);
      await settled(page);
      await assertRan(page, problem, name);
      if (bodies) await assertBodiesDrawn(page, `${problem.id} ${name}`);
      else assert.ok((await drawn(page, plane("A"), "A")).count > 150, `${problem.id} ${name}: there is something to see`);
    }
  }
  assert.ok(excluded > 0, "some pair of problem and scheme is impossible, and is not offered");
});

const shows = (page, id) => page.waitForFunction((wanted) => document.querySelector("#problem").value === wanted, id)
  .then(() => settled(page));

/** Both planes hold curves, of bodies in colours of their own: how many pixels are no grey. */
async function assertBodiesDrawn(page, label) {
  const count = (canvas) => {
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height }), pen = copy.getContext("2d");
    pen.drawImage(canvas, 0, 0);
    const { data } = pen.getImageData(0, 0, copy.width, copy.height);
    let found = 0;
    for (let i = 0; i < data.length; i += 4) found += data[i + 3] > 200 && Math.max(data[i], data[i + 1], data[i + 2]) - Math.min(data[i], data[i + 1], data[i + 2]) > 60;
    return found;
  };
  for (const run of ["A", "B"]) {
    const found = await seen(page, plane(run), count);
    assert.ok(found > 150, `${label}: plane ${run} holds curves (${found} pixels)`);
  }
}

/** A scene that keeps its energy completes its run; another may stop, at a singularity of its own, and says so. */
async function assertRan(page, problem, preset = "") {
  const label = `${problem.id} ${preset}`, found = await statuses(page);
  assert.equal(await page.locator(".fault").count(), 0, label);
  assert.equal(found.length, 2, label);
  const keeps = problem.invariants.some((invariant) => invariant.name === "energy");
  assert.ok(found.every((status) => status === "completed" || (status === "stopped" && !keeps)), `${label}: ${found}`);
  assert.equal(await page.locator(".stop").count(), found.filter((status) => status === "stopped").length, label);
}

const chosenIn = (url, run) => new URLSearchParams(new URL(url).hash.slice(1)).get(run);

pageTest("every scheme runs in either column", {}, async (page) => {
  const ids = await all(page, ".pane[data-run=A] .scheme option", "value");
  assert.ok(ids.length > 3);
  const steps = (id) => catalogue.schemes.find((s) => s.id === id).parameters.some(({ name }) => name === "step");
  await stepOf(page, "B").fill("0.004");
  for (const id of [...ids.filter(steps), ...ids.filter((id) => !steps(id))]) {
    await pane(page, "B").locator(".scheme").selectOption(id);
    await settled(page);
    assert.equal(await page.locator(".fault").count(), 0, id);
    assert.equal((await statuses(page)).length, 2, id);
    assert.ok((await drawn(page, plane("B"), "B")).count > 100, id);
    if (steps(id)) assert.equal(await stepOf(page, "B").inputValue(), "0.004", `${id} keeps the step that was set`);
  }
});

pageTest("axes have equal scales, and both runs the same ones",
  { hash: "#problem=harmonic_oscillator&until.t=10&A=explicit_euler&A.step=0.05&B=leapfrog&B.step=0.05" }, async (page) => {
    const [a, b] = [await drawn(page, plane("A"), "A"), await drawn(page, plane("B"), "B")];
    const ratio = (b.right - b.left) / (b.bottom - b.top);
    assert.ok(Math.abs(ratio - 1) < 0.05, `the oscillator's phase portrait is round: width / height = ${ratio}`);
    assert.ok(b.bottom - b.top > 150);
    const growth = (a.bottom - a.top) / (b.bottom - b.top);
    assert.ok(growth > 1.1 && growth < 1.4, `Euler's spiral is the larger one in the same view: ${growth}`);
  });

pageTest("the service's faults appear at their fields", { expected: /status of 422/ }, async (page) => {
  await stepOf(page, "B").fill("-1");
  await stepOf(page, "B").press("Enter");
  await settled(page);
  const step = pane(page, "B").locator(".field", { has: page.locator("[data-pointer='/scheme/step']") });
  assert.equal(await stepOf(page, "B").getAttribute("aria-invalid"), "true");
  assert.match(await step.locator(".fault").textContent(), /greater|than|allowed/);
  assert.equal(await stepOf(page, "B").getAttribute("aria-describedby"), await step.locator(".fault").getAttribute("id"));
  assert.equal(await page.locator("[aria-invalid]").count(), 1, "the other run, whose step is good, has no fault");
  assert.equal((await statuses(page)).length, 1, "and ran");
  assert.match(await pane(page, "B").getAttribute("class"), /stale/, "the last good picture stays, faint");
  assert.match(await page.getAttribute(plane("B"), "aria-label"), /^y over x of run B/);
  await pane(page, "B").locator(".messages button").click();
  assert.ok(await stepOf(page, "B").evaluate((field) => field === document.activeElement), "the list leads to the field");

  await stepOf(page, "B").fill("0.02");
  await stepOf(page, "B").press("Enter");
  await settled(page);
  assert.equal(await page.locator(".fault, [aria-invalid]").count(), 0, "a mended fault is gone");
  assert.equal((await statuses(page)).length, 2);

  await page.fill("[data-pointer='/problem/mu']", "heavy");
  await page.fill("[data-pointer='/until/t']", "soon");
  await page.press("[data-pointer='/until/t']", "Enter");
  await settled(page);
  const marked = await all(page, "#scene [aria-invalid]", "dataset.pointer");
  assert.ok(marked.includes("/problem/mu"), "what is no number is refused at its field");
  assert.ok(marked.includes("/until/t"), "all faults at once");
  assert.equal(await pane(page, "B").locator(".messages .fault").count(), marked.length, "and listed");
});

pageTest("a link restores the experiment", {}, async (page, context) => {
  await page.selectOption("#problem", "pendulum");
  await settled(page);
  await page.fill("[data-pointer='/initial/q']", "2.5");
  await page.fill("[data-pointer='/until/t']", "12");
  await stepOf(page, "B").fill("0.3");
  await pane(page, "A").locator(".scheme").selectOption("runge_kutta_4");
  await pane(page, "B").locator("[data-name=composition]").selectOption("kahan_li_6");
  await page.click("#go");
  await settled(page);
  const link = page.url(), energy = await number(page, "energy", "B");
  assert.ok(link.length < 500, `the link is short (${link.length})`);

  const other = await context.newPage();
  await other.goto(link);
  await settled(other);
  assert.equal(other.url(), link, "and stays the same");
  assert.equal(await other.inputValue("#problem"), "pendulum");
  assert.equal(await other.inputValue("[data-pointer='/initial/q']"), "2.5");
  assert.equal(await other.inputValue("[data-pointer='/until/t']"), "12");
  assert.equal(await stepOf(other, "B").inputValue(), "0.3");
  assert.equal(await pane(other, "A").locator(".scheme").inputValue(), "runge_kutta_4");
  assert.equal(await pane(other, "B").locator("[data-name=composition]").inputValue(), "kahan_li_6");
  assert.equal(await number(other, "energy", "B"), energy);
  await other.evaluate(() => (location.hash = "#problem=kepler"));
  await other.waitForFunction(() => document.querySelector("#problem").value === "kepler");
  await settled(other);
  assert.deepEqual(await statuses(other), ["completed", "completed"], "a new link in the same window loads");
});

pageTest("the curl line makes the same run", { permissions: ["clipboard-read", "clipboard-write"] }, async (page) => {
  await pane(page, "B").locator(".curl summary").click();
  await pane(page, "B").locator(".curl button").click();
  const line = await pane(page, "B").locator(".curl pre").textContent();
  assert.equal(await page.evaluate(() => navigator.clipboard.readText()), line, "the button copies it");
  const found = /^curl -s (\S+) -d '(.*)'$/.exec(line);
  assert.ok(found, line);
  assert.equal(found[1], `${origin}/v1/simulate`);
  const response = await fetch(found[1], { method: "POST", body: found[2].replaceAll("'\\''", "'") });
  assert.equal(response.status, 200);
  const outcome = await response.json();
  assert.equal(outcome.cost.steps, await number(page, "steps", "B"));
  assert.equal(outcome.diagnostics.energy.max_abs_error, await number(page, "energy", "B"));
  assert.equal(outcome.scheme.step, 0.005);
});

pageTest("a new request drops the one under way", {}, async (page) => {
  const dropped = [];
  page.on("requestfailed", (request) => dropped.push(request.postDataJSON().until.t));
  let slow = true;
  await page.route("**/v1/simulate", async (route) => {
    if (slow) await new Promise((resolve) => setTimeout(resolve, 500));
    await route.continue().catch(() => {});
  });
  await page.fill("[data-pointer='/until/t']", "10");
  await page.press("[data-pointer='/until/t']", "Enter");
  assert.equal(await page.getAttribute("#results", "aria-busy"), "true");
  await page.waitForTimeout(200);
  slow = false;
  await page.fill("[data-pointer='/until/t']", "20");
  await page.press("[data-pointer='/until/t']", "Enter");
  await settled(page);
  assert.equal(await number(page, "steps", "A"), 2000);
  await page.waitForTimeout(600);
  assert.equal(await number(page, "steps", "A"), 2000, "the late answer is not shown");
  assert.deepEqual(dropped.filter((t) => t === 10), [10, 10]);
});

pageTest("a service that is busy or gone is told from a fault of the request",
  { expected: /status of 503|ERR_CONNECTION_REFUSED/ }, async (page) => {
    const busy = { status: 503, headers: { "Retry-After": "2" }, contentType: "application/problem+json",
                   body: JSON.stringify({ title: "busy", status: 503 }) };
    let gone = false;
    await page.route("**/v1/simulate", (route) => (gone ? route.abort("connectionrefused") : route.fulfill(busy)));
    await page.click("#go");
    await settled(page);
    assert.match(await pane(page, "A").locator(".messages").textContent(), /busy.*2 s/);
    gone = true;
    await page.click("#go");
    await settled(page);
    assert.match(await pane(page, "A").locator(".messages").textContent(), /does not answer/);
  });

pageTest("a run that stops says why, and the other is still seen",
  { hash: "#problem=kepler&until.t=40&A=leapfrog&A.step=0.01&B=leapfrog&B.step=3" }, async (page) => {
    assert.deepEqual(await statuses(page), ["completed", "stopped"]);
    assert.match(await pane(page, "B").locator(".messages .stop").textContent(), /unstable step.*t = 9.*hω/);
    assert.equal(await page.locator(".stop").count(), 1);
    await assertDrawn(page, 20);
  });

pageTest("a run that flees does not shrink the other to a dot",
  { hash: "#problem=kepler&until.t=40&A=leapfrog&A.step=0.01&B=explicit_euler&B.step=0.02" }, async (page) => {
    const { left, right, top, bottom } = await drawn(page, plane("A"), "A");
    assert.ok(Math.max(right - left, bottom - top) > 100, "A is still large");
  });

const atCentre = { hash: "#problem=kepler&initial.x=0&initial.y=0" };
pageTest("a start that is singular, and one that never moves", atCentre, async (page) => {
  assert.deepEqual(await statuses(page), ["stopped", "stopped"]);
  assert.match(await pane(page, "A").locator(".messages .stop").textContent(), /singular/);
  assert.equal((await drawn(page, plane("A"), "A")).count, 0);
  assert.match(await page.getAttribute(plane("A"), "aria-label"), /nothing/);
  assert.equal(await page.textContent("#energy-note"), "");
  await page.evaluate(() => (location.hash = "#problem=harmonic_oscillator&initial.q=0&initial.p=0"));
  await page.waitForFunction(() => document.querySelector("#problem").value === "harmonic_oscillator");
  await settled(page);
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
  assert.match(await page.textContent("#energy-note"), /exactly/);
  assert.ok((await drawn(page, plane("A"), "A")).count > 10, "a point is drawn");
});

pageTest("fields have labels, and the state is announced", {}, async (page) => {
  const named = await page.locator("input, select").evaluateAll((found) => found.map((node) => node.labels.length > 0 || Boolean(node.ariaLabel)));
  assert.ok(named.every(Boolean));
  assert.equal(await page.getAttribute("#status", "aria-live"), "polite");
  assert.match(await page.textContent("#status"), /A completed.*B completed/);
  assert.ok((await all(page, "canvas.plane", "ariaLabel")).every((label) => label?.length > 10));
});

const telephone = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 3 };
pageTest("at the width of a telephone nothing is cut off", telephone, async (page) => {
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
  await assertDrawn(page);
  assert.ok((await all(page, ".pane canvas.plane", "clientWidth")).every((width) => width > 300), "one below the other");
  const sharp = await page.locator(plane("A")).evaluate((c) => c.width / c.clientWidth);
  assert.ok(Math.abs(sharp - 3) < 0.05, `the canvas has the display's resolution (${sharp})`);
});

pageTest("the dark scheme is drawn in its own colours", {}, async (page) => {
  const colour = () => page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue("--run-a"));
  const light = await colour();
  await page.emulateMedia({ colorScheme: "dark" });
  await frames(page);
  assert.notEqual(await colour(), light);
  await assertDrawn(page);
});
