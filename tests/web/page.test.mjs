// The page in a real browser, against the real binary.
//   LEAST_BINARY      the program (required)
//   LEAST_BROWSER     a Chromium; else the first one found on the PATH
//   LEAST_SCREENSHOT  where to leave a picture of the page as it opens
// Without a browser the tests are skipped, loudly; under CI that is a failure.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { accessSync, constants } from "node:fs";
import { delimiter, join } from "node:path";
import { createInterface } from "node:readline";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";

const browserPath = process.env.LEAST_BROWSER || onPath("chromium", "google-chrome", "google-chrome-stable", "chrome");
if (!browserPath) {
  console.error("\n*** NO BROWSER: THE TESTS OF THE PAGE ARE SKIPPED. Install chromium or set LEAST_BROWSER. ***\n");
  if (process.env.CI) throw new Error("no browser, and under CI the page must be tested");
}
const options = { skip: browserPath ? false : "no browser", timeout: 60_000 };
const switches = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
                  "--disable-component-update", "--disable-sync"];
let service, origin, browser, catalogue;

before(async () => {
  if (!browserPath) return;
  assert.ok(process.env.LEAST_BINARY, "LEAST_BINARY must name the program");
  service = spawn(process.env.LEAST_BINARY, ["serve", "--port", "0"], { stdio: ["ignore", "pipe", "ignore"] });
  origin = await new Promise((resolve, reject) => {
    createInterface({ input: service.stdout }).on("line", (line) => {
      const found = /listening on (http:\/\/\S+?)\/?$/.exec(line);
      if (found) resolve(found[1]);
    });
    service.on("error", reject);
    service.on("exit", (code) => reject(new Error(`the service ended with ${code} before it listened`)));
  });
  catalogue = await (await fetch(`${origin}/v1/catalogue`)).json();
  browser = await chromium.launch({ executablePath: browserPath, args: switches });
}, { timeout: 60_000 });

after(async () => {
  await browser?.close();
  service?.removeAllListeners("exit");
  service?.kill("SIGTERM");
});

function onPath(...names) {
  for (const name of names) {
    for (const folder of (process.env.PATH ?? "").split(delimiter)) {
      try {
        accessSync(join(folder, name), constants.X_OK);
        return join(folder, name);
      } catch {
        // not here
      }
    }
  }
  return null;
}

/**
 * Runs `body(page)` on a page at `hash` and fails when the browser complained about anything or asked any other origin
 * for anything. `expected` matches complaints that belong to the case.
 */
function pageTest(name, { hash = "", expected = /^$/, ...context }, body) {
  test(name, options, async () => {
    const opened = await browser.newContext({ viewport: { width: 1600, height: 1000 }, ...context });
    const page = await opened.newPage();
    const complaints = [], failures = [];
    page.on("console", (message) => {
      if (["error", "warning"].includes(message.type())) complaints.push(`console: ${message.text()}`);
    });
    page.on("pageerror", (error) => complaints.push(`page error: ${error.message}`));
    page.on("request", (request) => {
      if (new URL(request.url()).origin !== origin) complaints.push(`foreign request: ${request.url()}`);
    });
    page.on("requestfailed", (request) => failures.push(`request failed: ${request.url()}: ${request.failure().errorText}`));
    page.setDefaultTimeout(15_000);
    try {
      await page.goto(`${origin}/${hash}`);
      await settled(page);
      await body(page, opened);
    } catch (error) {
      for (const complaint of [...complaints, ...failures]) console.error(complaint); // they may be the cause
      throw error;
    } finally {
      await opened.close();
    }
    assert.deepEqual(complaints.filter((complaint) => !expected.test(complaint)), []);
  });
}

const settled = (page) => page.waitForSelector("#results[aria-busy=false]");
const pane = (page, name) => page.locator(`.pane[data-run=${name}]`);
const stepOf = (page, name) => pane(page, name).locator("[data-pointer='/scheme/step']");
const plane = (name) => `.pane[data-run=${name}] canvas`;
const all = (page, selector, property) =>
  page.locator(selector).evaluateAll((found, path) => found.map((node) => path.reduce((at, key) => at[key], node)),
                                     property.split("."));
const statuses = (page) => all(page, "#numbers tr[data-row=status] data", "value");

/** What the table says of run A or B in a row. */
async function number(page, row, name) {
  const cell = page.locator(`#numbers tr[data-row=${row}] td`).nth(name === "A" ? 0 : 1);
  return Number(await cell.locator("data").getAttribute("value"));
}

/** How many pixels of a canvas have the colour of a run, and the box around them. */
const drawn = (page, selector, run) => page.locator(selector).evaluate((canvas, variable) => {
  const probe = document.createElement("span");
  probe.style.color = `var(${variable})`;
  document.body.append(probe);
  const wanted = getComputedStyle(probe).color.match(/\d+/g).map(Number);
  probe.remove();
  const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
  const pen = copy.getContext("2d", { willReadFrequently: true });
  pen.drawImage(canvas, 0, 0);
  const { data, width } = pen.getImageData(0, 0, copy.width, copy.height);
  const found = { count: 0, left: Infinity, right: -Infinity, top: Infinity, bottom: -Infinity };
  for (let i = 0; i < data.length; i += 4) {
    if (data[i + 3] < 200 || wanted.some((c, k) => Math.abs(data[i + k] - c) > 12)) continue;
    const x = (i / 4) % width, y = Math.floor(i / 4 / width);
    found.count++;
    found.left = Math.min(found.left, x);
    found.right = Math.max(found.right, x);
    found.top = Math.min(found.top, y);
    found.bottom = Math.max(found.bottom, y);
  }
  return found;
}, `--run-${run.toLowerCase()}`);

async function assertDrawn(page, least = 200) {
  for (const run of ["A", "B"]) {
    const other = run === "A" ? "B" : "A";
    const own = await drawn(page, plane(run), run);
    assert.ok(own.count > least, `plane ${run} holds its curve (${own.count} pixels)`);
    assert.equal((await drawn(page, plane(run), other)).count, 0, `plane ${run} holds no other`);
    const energy = await drawn(page, "#energy canvas", run);
    assert.ok(energy.count > least / 2, `the energy plot holds ${run} (${energy.count} pixels)`);
    assert.ok(energy.right - energy.left > least, `the energy of ${run} spans the plot`);
  }
}

pageTest("the page opens with the paper's orbit, which precesses less with half the step", {}, async (page) => {
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
  if (process.env.LEAST_SCREENSHOT) await page.screenshot({ path: process.env.LEAST_SCREENSHOT, fullPage: true });
});

test("the page forbids foreign and inline code", options, async () => {
  const response = await fetch(`${origin}/`);
  const policy = response.headers.get("content-security-policy") ?? "";
  assert.match(policy, /default-src 'self'/);
  assert.doesNotMatch(policy, /unsafe|\*|https?:|data:/);
  assert.doesNotMatch(await response.text(), /\sstyle=|\son\w+=|<style|<script>/);
});

pageTest("every problem of the catalogue rebuilds the forms and runs", {}, async (page) => {
  let excluded = 0;
  for (const problem of catalogue.problems) {
    await page.selectOption("#problem", problem.id);
    await settled(page);
    const names = (form) => all(page, `${form} [data-name]`, "dataset.name");
    assert.deepEqual(await names("#parameters"), problem.parameters.map((p) => p.name), problem.id);
    assert.deepEqual(await names("#initial"), problem.variables.map((v) => v.name), problem.id);
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
    assert.deepEqual(await statuses(page), ["completed", "completed"], problem.id);
    assert.equal(await page.locator(".fault").count(), 0, problem.id);
    await assertDrawn(page);
  }
  assert.ok(excluded > 0, "some pair of problem and scheme is impossible, and is not offered");
});

const chosenIn = (url, run) => new URLSearchParams(new URL(url).hash.slice(1)).get(run);

pageTest("every scheme runs in either column", {}, async (page) => {
  const ids = await all(page, ".pane[data-run=A] .scheme option", "value");
  assert.ok(ids.length > 3);
  await stepOf(page, "B").fill("0.004");
  for (const id of ids) {
    await pane(page, "B").locator(".scheme").selectOption(id);
    await settled(page);
    assert.equal(await page.locator(".fault").count(), 0, id);
    assert.equal((await statuses(page)).length, 2, id);
    assert.ok((await drawn(page, plane("B"), "B")).count > 100, id);
    assert.equal(await stepOf(page, "B").inputValue(), "0.004", `${id} keeps the step that was set`);
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
  assert.equal((await drawn(page, plane("B"), "B")).count, 0, "nothing is left of the former run");
  await pane(page, "B").locator(".messages button").click();
  assert.ok(await stepOf(page, "B").evaluate((field) => field === document.activeElement), "the list leads to the field");

  await stepOf(page, "B").fill("0.02");
  await stepOf(page, "B").press("Enter");
  await settled(page);
  assert.equal(await page.locator(".fault, [aria-invalid]").count(), 0, "a mended fault is gone");
  assert.equal((await statuses(page)).length, 2);

  await page.fill("[data-pointer='/problem/mu']", "heavy");
  await page.fill("[data-pointer='/until/t']", "-5");
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
  page.on("requestfailed", (request) => dropped.push(request.failure().errorText));
  let slow = true;
  await page.route("**/v1/simulate", async (route) => {
    if (slow) await new Promise((resolve) => setTimeout(resolve, 1000));
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
  await page.waitForTimeout(1200);
  assert.equal(await number(page, "steps", "A"), 2000, "the late answer is not shown");
  assert.deepEqual(dropped, ["net::ERR_ABORTED", "net::ERR_ABORTED"]);
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
  assert.ok((await all(page, "input, select", "labels.length")).every((labels) => labels > 0));
  assert.equal(await page.getAttribute("#status", "aria-live"), "polite");
  assert.match(await page.textContent("#status"), /A completed.*B completed/);
  assert.ok((await all(page, "canvas.plane", "ariaLabel")).every((label) => label?.length > 10));
});

const telephone = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 3 };
pageTest("at the width of a telephone nothing is cut off", telephone, async (page) => {
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
  await assertDrawn(page);
  assert.ok((await all(page, "canvas.plane", "clientWidth")).every((width) => width > 300), "one below the other");
  const sharp = await page.locator(plane("A")).evaluate((c) => c.width / c.clientWidth);
  assert.ok(Math.abs(sharp - 3) < 0.05, `the canvas has the display's resolution (${sharp})`);
});

pageTest("the dark scheme is drawn in its own colours", {}, async (page) => {
  const colour = () => page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue("--run-a"));
  const light = await colour();
  await page.emulateMedia({ colorScheme: "dark" });
  await page.waitForTimeout(300);
  assert.notEqual(await colour(), light);
  await assertDrawn(page);
});
