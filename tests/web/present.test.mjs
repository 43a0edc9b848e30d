// A lecture: what a presentation shows, that a link holds it, and the page in a frame of another page.
import assert from "node:assert/strict";
import { createServer } from "node:http";
import { test } from "node:test";
import { all, becomes, drawn, frames, options, origin, pageTest } from "./browser.mjs";
import { start } from "./served.mjs";
import { lessons } from "../../web/lessons/lessons.js";

const ready = "#lesson[aria-busy=false]";
const calm = { ready, reducedMotion: "reduce" };
const opened = (page, id) => page.waitForSelector(`html[data-shown=${id}]`);
const isPresenting = (page) => page.evaluate(() => document.documentElement.classList.contains("present"));

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

pageTest("a link presents; turning keeps it, leaving takes it out of the link", { ...calm, hash: "#lesson=orbit&present" }, async (page) => {
  assert.ok(await isPresenting(page));
  assert.equal(await page.locator("#figures figure:visible").count(), 1);
  assert.deepEqual(await all(page, "[data-presents]", "textContent"), ["Leave", "Leave"]);
  await page.keyboard.press("ArrowRight");
  await opened(page, "spiral");
  assert.match(page.url(), /#lesson=spiral&present$/);
  await page.keyboard.press("Escape");
  assert.ok(!(await isPresenting(page)) && !page.url().includes("present"), page.url());
  await page.goBack();
  await opened(page, "orbit");
  assert.ok(!(await isPresenting(page)) && !page.url().includes("present"), "the way back leads to a lesson, not into a presentation");
  await page.evaluate(() => (location.hash = "#problem=pendulum&until.t=20&present"));
  await page.waitForSelector("#results[aria-busy=false]");
  assert.ok((await isPresenting(page)) && (await page.inputValue("#problem")) === "pendulum");
  assert.equal(await page.isVisible("#notice"), false, "the link means something");
});

pageTest("by a hand it takes the whole screen, which the Escape of a browser leaves as well", { ...calm }, async (page) => {
  const full = () => page.evaluate(() => Boolean(document.fullscreenElement));
  await page.click("#present");
  await becomes(full, Boolean);
  await page.evaluate(() => document.exitFullscreen());
  await becomes(() => isPresenting(page), (on) => !on);
  assert.equal(await page.textContent("#present"), "Present");
  await page.click("#present");
  await becomes(full, Boolean);
  await page.click("#present");
  await becomes(full, (on) => !on);
});

pageTest("the words of every lesson are whole at 1280 × 720 and at 1920 × 1080", { ...calm, hash: "#lesson=orbit&present", viewport: { width: 1920, height: 1080 } }, async (page) => {
  for (const [i, { id }] of lessons.entries()) {
    if (i > 0) await page.keyboard.press("ArrowRight");
    await opened(page, id);
    for (const [width, height] of [[1280, 720], [1920, 1080]]) {
      await page.setViewportSize({ width, height });
      await frames(page);
      const cut = await page.evaluate(() => [...document.querySelectorAll("#claim, .turn, .beside, #legend :is(td, th), #figures .note, .player")]
        .filter((node) => node.offsetParent && (node.scrollHeight > node.clientHeight + 1 || node.scrollWidth > node.clientWidth + 1 ||
                                                node.getBoundingClientRect().bottom > innerHeight + 1)).map((node) => node.id || node.className || node.textContent));
      assert.deepEqual(cut, [], `${id} at ${width} × ${height}`);
      const size = await page.evaluate(() => parseFloat(getComputedStyle(document.querySelector("#see")).fontSize) *
        Number(document.querySelector("#lesson .beside").style.zoom || 1));
      assert.ok(size >= 15, `${id}: ${size} px`);
    }
  }
});

pageTest("the workbench presents pictures, the scene and what is moved by hand, and nothing else",
  { hash: "#problem=pendulum&until.t=20&present", reducedMotion: "reduce", viewport: { width: 1280, height: 720 } }, async (page) => {
    for (const part of [".pane canvas.plane", "#bodies", "#energy canvas", "#motion .play", "#parameters input[type=range]", "#present-bench"]) {
      assert.ok(await page.locator(part).first().isVisible(), part);
    }
    for (const part of ["header nav", "#choice", "#studies", ".pane .scheme", ".curl", "#take", "#starts", "#numbers", "#until"]) {
      assert.equal(await page.locator(part).first().isVisible(), false, part);
    }
    for (const run of ["A", "B"]) {
      const { height, y } = await page.locator(`.pane[data-run=${run}] canvas.plane`).boundingBox();
      assert.ok(height > 250 && y + height <= 720, `${run}: ${height} at ${y}`);
      assert.ok((await drawn(page, `.pane[data-run=${run}] canvas.plane`, run)).count > 200);
    }
    assert.equal(await page.evaluate(() => document.documentElement.scrollHeight), 720, "all in one screen");
    await page.keyboard.press("Escape");
    assert.ok(await page.isVisible("#choice"));
  });

test("in a frame: of an origin that is allowed the page, of others what to do", options, async (context) => {
  const host = createServer((request, response) => {
    response.setHeader("Content-Type", "text/html");
    response.end(`<!doctype html><title>course</title><iframe width=1200 height=700 src="${decodeURIComponent(request.url.slice(2))}"></iframe>`);
  });
  await new Promise((resolve) => host.listen(0, "127.0.0.1", resolve));
  const course = `http://127.0.0.1:${host.address().port}`, served = await start([], ["--allow-frame", course]);
  context.after(() => Promise.all([served.stop(), host.close()]));
  const page = await served.browser.newPage(), holding = (url) => page.goto(`${course}/?${encodeURIComponent(url)}`);
  const frame = page.frameLocator("iframe");
  await holding(`${served.origin}/#lesson=orbit&present`);
  await frame.locator("#lesson[aria-busy=false]").waitFor();
  assert.ok(await frame.locator("#figures .one canvas.plane").isVisible(), "it presents within the frame");
  assert.equal(await frame.locator("#present").textContent(), "Leave");
  await holding(`${origin}/`); // of a service that was not told of the course
  assert.match(await frame.locator("p").textContent(), /--allow-frame/);
});

pageTest("the plot of the energy is told in letters as large as all others, and its numbers keep apart", { hash: "#problem=pendulum", reducedMotion: "reduce", viewport: { width: 1920, height: 1080 } }, async (page) => {
  const room = () => page.locator("#energy .u-over").evaluate((over) => [parseFloat(over.style.left), parseFloat(getComputedStyle(over).fontSize)]);
  const [before, small] = await room();
  await page.click("#present-bench");
  await becomes(room, ([left]) => left > 1.4 * before);
  const [left, size] = await room();
  assert.ok(Math.abs(left / size - before / small) < 0.1, `${before} for letters of ${small}, then ${left} for ${size}`);
  await page.click("#present-bench");
  await becomes(room, ([back]) => back === before);
});
