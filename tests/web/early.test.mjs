// A lesson that measures is seen before it has ended: its picture grows from what the service has said so far.
import assert from "node:assert/strict";
import { becomes, drawn, frames, pageTest, seen } from "./browser.mjs";
import { claims } from "./claims.mjs";

/**
 * In the page: lets lines of answers under a path through as long as `through(lines so far, number of the answer)` says so; the others
 * come when `goOn()` is called. What comes is what the service says.
 */
const holds = (wanted, through) => {
  const whole = window.fetch, text = new TextEncoder(), decoder = new TextDecoder();
  const on = new Promise((resolve) => (window.goOn = resolve));
  document.addEventListener("seen", () => (window.early = (window.early ?? 0) + 1));
  window.asked = [];
  window.fetch = async (address, options) => {
    if (!String(address).endsWith(wanted)) return whole(address, options);
    window.asked.push(JSON.parse(options.body));
    const response = await whole(address, options), reader = response.body.getReader(), number = window.asked.length;
    const body = new ReadableStream({
      async start(stream) {
        let rest = "";
        const lines = [];
        for (let next = await reader.read(); !next.done; next = await reader.read()) {
          const parts = (rest + decoder.decode(next.value, { stream: true })).split("\n");
          rest = parts.pop();
          for (const line of parts) {
            lines.push(JSON.parse(line));
            if (!through(lines, number)) await on;
            stream.enqueue(text.encode(`${line}\n`));
          }
        }
        stream.close();
      },
    });
    return new Response(body, { headers: response.headers });
  };
};
const held = (path, through) => (opened) => opened.addInitScript({ content: `(${holds})(${JSON.stringify(path)}, ${through})` });

const early = (page) => page.evaluate(() => window.early ?? 0);
const busy = (page) => page.getAttribute("#lesson", "aria-busy");
const ended = (page) => page.evaluate(() => window.said !== undefined);

// Two points of every scheme, and no more.
const stretches = (lines) => [0, 1, 2, 3, 4].some((scheme) => lines.slice(0, -1).filter(({ point, curve }) => point && curve === scheme).length < 2);
const digits = { hash: "#lesson=digits", ready: "#lesson .precision canvas", reducedMotion: "reduce", prepare: held("work-precision", stretches) };
pageTest("what a digit costs is seen while it is measured, a stretch of each curve, and the curves grow", digits, async (page) => {
  await becomes(() => early(page), (times) => times === 1);
  await frames(page);
  assert.equal(await busy(page), "true");
  assert.ok(!(await ended(page)), "the study goes on");
  const colours = ["--run-a", "--run-b", "--curve-c", "--curve-d", "--curve-e"], counts = async () => {
    const found = [];
    for (const colour of colours) found.push((await drawn(page, "#figures .precision canvas", colour)).count);
    return found;
  };
  const first = await counts();
  assert.ok(first.every((count) => count > 40), `each curve has begun: ${first}`);
  await page.evaluate(() => window.goOn());
  await becomes(() => busy(page), (now) => now === "false");
  const { study } = await page.evaluate(() => window.said);
  claims.digits(study);
  assert.ok(study.every(({ points }) => points.length > 5), "each has come to its end");
  const last = await counts();
  assert.ok(last.every((count) => count > 40), `${last}`);
});

const canvas = "#figures canvas.plane";
/** How many of places all over the picture have a colour. */
const coloured = (page) => seen(page, canvas, (picture) => {
  const pen = new OffscreenCanvas(picture.width, picture.height).getContext("2d", { willReadFrequently: true });
  pen.drawImage(picture, 0, 0);
  const { data, width } = pen.getImageData(0, 0, picture.width, picture.height);
  let count = 0;
  for (let i = 1; i < 10; i++) for (let k = 1; k < 10; k++) {
    const at = 4 * (Math.round((0.12 + 0.084 * i) * picture.width) + width * Math.round((0.06 + 0.078 * k) * picture.height));
    count += Math.max(...data.slice(at, at + 3)) - Math.min(...data.slice(at, at + 3)) > 60 ? 1 : 0;
  }
  return count;
});
const sideOf = ({ members: { vary } }) => vary["/initial/q"].grid[2];

const basins = { hash: "#lesson=basins", ready: "#figures .hues", reducedMotion: "reduce", prepare: held("ensemble", (lines, number) => number < 2) };
pageTest("where a pendulum ends is seen at once in coarse pixels, which the fine ones cover", basins, async (page) => {
  assert.ok((await early(page)) === 1 && (await busy(page)) === "true" && !(await ended(page)));
  assert.deepEqual(await page.evaluate(() => window.asked.map(({ members: { vary } }) => vary["/initial/p"].grid)), [[-2, 4, 74], [-2, 4, 512]]);
  assert.equal(await coloured(page), 81, "all over the picture");
  await page.evaluate(() => window.goOn());
  await becomes(() => busy(page), (now) => now === "false");
  claims.basins((await page.evaluate(() => window.said)).study);
  assert.equal(await coloured(page), 81);
});

pageTest("while a hand moves the drive the picture is coarse, one request at a time, and in the end fine", { ...basins, ready: "#lesson[aria-busy=false]", prepare: undefined }, async (page) => {
  const asked = [], flying = { now: 0, most: 0 };
  await page.route("**/v1/ensemble", async (route) => {
    asked.push(sideOf(route.request().postDataJSON()));
    flying.most = Math.max(flying.most, ++flying.now);
    await new Promise((resolve) => setTimeout(resolve, 60));
    await route.continue().catch(() => {});
    flying.now--;
  });
  const { x, y, width, height } = await page.locator("#control input[type=range]").boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  for (let i = 1; i <= 10; i++) {
    await page.mouse.move(x + width / 2 + (i * width) / 40, y + height / 2);
    await page.waitForTimeout(20);
  }
  await becomes(() => busy(page), (now) => now === "false");
  assert.ok(asked.length > 1 && asked.length < 10 && asked.every((side) => side === 74), `${asked}`);
  assert.equal(flying.most, 1);
  await page.mouse.up();
  await becomes(() => asked.at(-1), (side) => side === 512);
  await becomes(() => busy(page), (now) => now === "false");
  const { study: { ends } } = await page.evaluate(() => window.said);
  assert.equal(ends.length, 512 * 512);
});

let late = null; // lets the run that is held back go on
const slow = async (opened) => {
  const on = new Promise((resolve) => (late = resolve));
  await opened.addInitScript(() => document.addEventListener("seen", () => (window.early = (window.early ?? 0) + 1)));
  await opened.route("**/v1/simulate", async (route) => {
    if (route.request().postDataJSON().problem.epsilon === 1000) await on;
    return route.fallback();
  });
};
pageTest("runs that come first are seen while a long one is under way", { hash: "#lesson=relaxation", ready: "#legend tbody:nth-of-type(3)", reducedMotion: "reduce", prepare: slow }, async (page) => {
  const counts = async () => {
    const found = [];
    for (const [i, run] of ["A", "B", "C", "D"].entries()) found.push((await drawn(page, `#figures figure:nth-child(${i + 1}) canvas.plane`, run)).count);
    return found;
  };
  assert.ok((await early(page)) >= 1 && (await busy(page)) === "true" && !(await ended(page)));
  const first = await counts();
  assert.ok(first.slice(0, 3).every((count) => count > 100) && first[3] === 0, `${first}`);
  late();
  await becomes(() => busy(page), (now) => now === "false");
  assert.ok((await counts()).every((count) => count > 100));
  claims.relaxation((await page.evaluate(() => window.said)).runs);
});

pageTest("while a hand moves the step of a long way its first part is run, and in the end all of it", { hash: "#lesson=frame", ready: "#lesson[aria-busy=false]", reducedMotion: "reduce" }, async (page) => {
  const asked = [];
  page.on("request", (request) => request.url().endsWith("/v1/simulate") && asked.push(request.postDataJSON().until.t));
  const track = page.locator("#control input[type=range]");
  const move = (type) => track.evaluate((slider, [by, kind]) => {
    slider.value = String(Number(slider.value) + by);
    slider.dispatchEvent(new Event(kind, { bubbles: true }));
  }, [type === "input" ? -40 : 0, type]);
  await move("input");
  await becomes(() => busy(page), (now) => now === "false");
  assert.deepEqual(asked, [1395, 1395]);
  assert.equal(await page.textContent("#lesson .player output"), "t = 13950");
  const part = await drawn(page, "#figures figure:nth-child(1) canvas.plane", "A"), { width } = await page.locator("#figures canvas.plane").first().evaluate((canvas) => ({ width: canvas.width }));
  assert.ok(part.count > 100 && part.right < 0.4 * width, `a tenth of the way, of the same picture: to ${part.right} of ${width}`);
  await move("change");
  await becomes(() => busy(page), (now) => now === "false");
  assert.deepEqual(asked.slice(2), [13950, 13950]);
});
