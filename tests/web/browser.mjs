// The page in a real browser, against the real binary: what the tests of the page share.
//   LEAST_BINARY      the program (required)
//   LEAST_BROWSER     a Chromium; else the first one found on the PATH
//   LEAST_PAGE        a folder whose files stand for those that the program holds, to test the page without building it
//   LEAST_SLOW        milliseconds by which frames are delayed, and answers by up to three times that, as on a busy machine
//   LEAST_SCREENSHOTS a folder for pictures of every lesson and of the workbench, on screens of four sizes, light and dark
// Without a browser the tests are skipped, loudly; under CI that is a failure.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { browserPath, start } from "./served.mjs";

if (!browserPath) {
  console.error("\n*** NO BROWSER: THE TESTS OF THE PAGE ARE SKIPPED. Install chromium or set LEAST_BROWSER. ***\n");
  if (process.env.CI) throw new Error("no browser, and under CI the page must be tested");
}
export const options = { skip: browserPath ? false : "no browser", timeout: 240_000 };
export let origin, catalogue;
/** Where tests begin that say nothing else: the paper's orbit, one revolution of it, in the workbench. */
const workbench = "#problem=kepler&until.t=20";
let served, browser;

before(async () => {
  if (!browserPath) return;
  served = await start();
  ({ origin, browser } = served);
  catalogue = await (await fetch(`${origin}/v1/catalogue`)).json();
}, { timeout: 60_000 });

after(() => served?.stop());

/** Answers requests for the files of LEAST_PAGE with them, under the headers of the page. */
async function servePage(context) {
  const folder = process.env.LEAST_PAGE;
  if (!folder) return;
  const { headers } = await fetch(`${origin}/`);
  await context.route(`${origin}/**`, async (route) => {
    const file = join(folder, new URL(route.request().url()).pathname.slice(1) || "index.html");
    if (!existsSync(file)) return route.fallback();
    const policy = { "content-security-policy": headers.get("content-security-policy") };
    return route.fulfill({ path: file, headers: policy });
  });
}

/** Keeps what the page tells of each lesson that it shows: of the last in `window.said`, how many in the document's dataset. */
const listening = (opened) => opened.addInitScript(() =>
  document.addEventListener("shown", ({ detail }) => {
    window.said = detail;
    const { dataset } = document.documentElement;
    dataset.shown = detail.lesson;
    dataset.times = Number(dataset.times ?? 0) + 1;
  }));

/** Makes frames and answers late, so that a test that reads too early fails always, and not by chance. */
const slowed = (opened, by) => opened.addInitScript((late) => {
  const frame = window.requestAnimationFrame.bind(window), ask = window.fetch, dropped = new Set();
  let asked = 0;
  window.requestAnimationFrame = (draw) => {
    const id = ++asked;
    setTimeout(() => frame((now) => dropped.delete(id) || draw(now)), late);
    return id;
  };
  window.cancelAnimationFrame = (id) => dropped.add(id);
  window.fetch = async (...given) => {
    const answer = await ask(...given);
    await new Promise((resolve) => setTimeout(resolve, 3 * late * Math.random()));
    return answer;
  };
}, by);

// A page is made ready in a tenth of the time that a new one takes to come up, so it is used again where a test asks for no
// more than what can be set on it.
let used = null;
const settable = ["viewport", "reducedMotion", "colorScheme"];
const usualSize = { width: 1280, height: 900 };

async function pageFor(prepare, context) {
  const usual = !prepare && Object.keys(context).every((name) => settable.includes(name));
  const { viewport = usualSize, reducedMotion = "no-preference", colorScheme = "light" } = context;
  if (usual && used) {
    const { page } = used;
    await page.goto("about:blank");
    await page.setViewportSize(viewport);
    await page.emulateMedia({ reducedMotion, colorScheme });
    return used;
  }
  const opened = await browser.newContext({ viewport, reducedMotion, colorScheme, ...context });
  await servePage(opened);
  await listening(opened);
  if (process.env.LEAST_SLOW) await slowed(opened, Number(process.env.LEAST_SLOW));
  await prepare?.(opened);
  const page = await opened.newPage();
  page.setDefaultTimeout(60_000);
  if (usual) used = { opened, page };
  return { opened, page };
}

/** After a test: as it was before, where the page is used again, which it is not when the test `failed`. */
async function leave({ opened, page }, failed) {
  if (failed || page !== used?.page) {
    if (page === used?.page) used = null;
    return opened.close();
  }
  page.removeAllListeners();
  await page.unrouteAll({ behavior: "ignoreErrors" });
  for (const other of opened.pages()) if (other !== page) await other.close();
}

/**
 * Runs `body(page, context)` on a page at `hash` and fails when the browser complained about anything or asked any other
 * origin for anything. `ready` is what tells that the page has settled; `expected` matches complaints that belong to the
 * case; `prepare(context)` may change what is answered.
 */
export function pageTest(name, { hash = workbench, ready = "#results[aria-busy=false]", expected = /^$/, prepare, ...context }, body) {
  test(name, options, async () => {
    const mine = await pageFor(prepare, context), { page, opened } = mine;
    const complaints = [], failures = [];
    page.on("console", (message) => {
      if (["error", "warning"].includes(message.type())) complaints.push(`console: ${message.text()}`);
    });
    page.on("pageerror", (error) => complaints.push(`page error: ${error.message}`));
    page.on("request", (request) => {
      if (new URL(request.url()).origin !== origin) complaints.push(`foreign request: ${request.url()}`);
    });
    page.on("requestfailed", (request) => failures.push(`request failed: ${request.url()}: ${request.failure().errorText}`));
    let failed = true;
    try {
      await page.goto(`${origin}/${ready.startsWith("#lesson") && hash === workbench ? "" : hash}`);
      await page.waitForSelector(ready);
      await body(page, opened);
      failed = false;
    } catch (error) {
      for (const complaint of [...complaints, ...failures]) console.error(complaint); // they may be the cause
      throw error;
    } finally {
      await leave(mine, failed);
    }
    assert.deepEqual(complaints.filter((complaint) => !expected.test(complaint)), []);
  });
}

/** Waits until everything requested has been drawn, however slow the machine is. */
export const frames = (page) =>
  page.evaluate(async () => {
    for (let i = 0; i < 2; i++) await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
  });
/** Waits until `good(value())` holds; after a minute, which a slow machine may take, fails with the value there is instead. */
export async function becomes(value, good) {
  for (const late = Date.now() + 60_000;;) {
    const now = await value();
    if (good(now)) return;
    if (Date.now() > late) assert.fail(`after a minute it still is ${JSON.stringify(now)}; wanted: ${good}`);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}
export const settled = (page) => page.waitForSelector("#results[aria-busy=false]");
export const pane = (page, name) => page.locator(`.pane[data-run=${name}]`);
export const stepOf = (page, name) => pane(page, name).locator("[data-pointer='/scheme/step']");
export const plane = (name) => `.pane[data-run=${name}] canvas.plane`;
export const all = (page, selector, property) =>
  page.locator(selector).evaluateAll((found, path) => found.map((node) => path.reduce((at, key) => at[key], node)),
                                     property.split("."));
export const statuses = (page) => all(page, "#numbers tr[data-row=status] data", "value");

/** What the table says of run A or B in a row. */
export async function number(page, row, name) {
  const cell = page.locator(`#numbers tr[data-row=${row}] td`).nth(name === "A" ? 0 : 1);
  return Number(await cell.locator("data").getAttribute("value"));
}

/** What `look(canvas, given)` sees in a canvas once what the page has to show is drawn: that is done in a later frame. */
export async function seen(page, selector, look, given) {
  await frames(page);
  return page.locator(selector).evaluate(look, given);
}

/**
 * How many pixels of a canvas have the colour of a run, or any other colour of the page (`--stretch`), and the box around
 * them; of all its columns, or of those between two fractions of its width.
 */
export const drawn = (page, selector, run, columns = [0, 1]) => seen(page, selector, (canvas, [variable, from, to]) => {
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
    if (x < from * width || x > to * width) continue;
    found.count++;
    found.left = Math.min(found.left, x);
    found.right = Math.max(found.right, x);
    found.top = Math.min(found.top, y);
    found.bottom = Math.max(found.bottom, y);
  }
  return found;
}, [run.startsWith("--") ? run : `--run-${run.toLowerCase()}`, ...columns]);

/** Both planes hold their own curve, and the plot of the energy, where the scene has one, holds both. */
export async function assertDrawn(page, least = 100) {
  const hasEnergy = await page.locator("#energy").isVisible();
  for (const run of ["A", "B"]) {
    const other = run === "A" ? "B" : "A";
    const own = await drawn(page, plane(run), run);
    assert.ok(own.count > least, `plane ${run} holds its curve (${own.count} pixels)`);
    assert.equal((await drawn(page, plane(run), other)).count, 0, `plane ${run} holds no other`);
    if (!hasEnergy) continue;
    const energy = await drawn(page, "#energy canvas", run);
    assert.ok(energy.count > least / 2, `the energy plot holds ${run} (${energy.count} pixels)`);
    assert.ok(energy.right - energy.left > least, `the energy of ${run} spans the plot`);
  }
}
