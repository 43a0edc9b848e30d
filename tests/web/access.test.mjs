// Accessibility: axe finds no violation in any part of the page, light or dark, and everything can be done by keys.
import assert from "node:assert/strict";
import { axeViolations } from "./axe.mjs";
import { frames, pageTest, pane, settled } from "./browser.mjs";

const parts = {
  "a lesson and the gallery": { hash: "#lesson=paper", ready: "#lesson[aria-busy=false]", open: ".all summary" },
  "a lesson that measures": { hash: "#lesson=digits", ready: "#lesson .precision canvas" },
  "a presentation": { hash: "#lesson=downhill", ready: "#lesson[aria-busy=false]", open: "#present" },
  "the workbench": { hash: "#problem=kepler&until.t=20&B=jacobi_maupertuis", open: ".curl summary" },
  "a presentation of a scene": { hash: "#problem=pendulum&until.t=20&present" },
  "a portrait": { hash: "#problem=pendulum&starts.of=q,p&starts.at=0,1,0,2&view.field=both", ready: "#start-list li" },
  "points with tangents": { hash: "#lesson=clock", ready: "#lesson[aria-busy=false]" },
  "multipliers about the unit circle": { hash: "#lesson=arenstorf", ready: "#lesson[aria-busy=false]" },
  "many runs, with a key": { hash: "#lesson=islands", ready: "#lesson .hues" },
  "a scene as text, with a fault": { hash: "#problem=custom&problem.variables=q&problem.potential=k*q^2", ready: "#spot-formula mark", expected: /422/ },
};
for (const [name, { open, ...part }] of Object.entries(parts)) {
  pageTest(`axe finds nothing wrong: ${name}`, { reducedMotion: "reduce", ...part }, async (page) => {
    if (open) await page.locator(open).first().click();
    assert.deepEqual(await axeViolations(page), []);
    await page.emulateMedia({ colorScheme: "dark" });
    await frames(page);
    assert.deepEqual(await axeViolations(page, ["color-contrast"]), [], "in the dark");
  });
}

const measured = { hash: "#problem=pendulum&initial.q=1&until.t=20&closed.by=energy&closed.to=0.5&closed.count=6", reducedMotion: "reduce" };
pageTest("axe finds nothing wrong: derivatives, a parameter over a range, a closed orbit; all fit a telephone", measured, async (page) => {
  for (const study of ["tangent", "sweep", "closed"]) {
    await page.click(`#measure-${study}`);
    await page.locator(`#${study} figure:not([hidden])`).first().waitFor();
    await page.locator(`#measure-${study}:not(:text-is("Stop"))`).waitFor();
  }
  assert.deepEqual(await axeViolations(page), []);
  await page.emulateMedia({ colorScheme: "dark" });
  await frames(page);
  assert.deepEqual(await axeViolations(page, ["color-contrast"]), [], "in the dark");
  await page.setViewportSize({ width: 360, height: 740 });
  await frames(page);
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 360);
});

/** Walks with the Tab key until `there(element)` holds of what has the focus. */
async function tabTo(page, selector) {
  for (let i = 0; i < 150; i++) {
    await page.keyboard.press("Tab");
    const ring = await page.evaluate((wanted) => {
      const at = document.activeElement;
      const { outlineStyle, outlineWidth } = getComputedStyle(at);
      return at.matches(wanted) && outlineStyle !== "none" && parseFloat(outlineWidth) >= 2;
    }, selector);
    if (ring) return;
  }
  assert.fail(`${selector} cannot be reached, or is not seen to have the focus`);
}

pageTest("keys alone: a lesson is moved, presented and left for the workbench, where a run is changed and stopped",
  { hash: "#lesson=spiral", ready: "#lesson[aria-busy=false]", reducedMotion: "reduce" }, async (page) => {
    await tabTo(page, "#next");
    await tabTo(page, "#present");
    await page.keyboard.press("Enter");
    assert.ok(await page.evaluate(() => document.documentElement.classList.contains("present")));
    await page.keyboard.press("Escape");
    await tabTo(page, "#lesson .play");
    await tabTo(page, "#lesson .time input");
    await page.keyboard.press("ArrowLeft");
    assert.notEqual(await page.textContent("#lesson .player output"), "t = 60");
    await tabTo(page, "#control input[type=range]");
    const before = await page.inputValue("#control input[type=text]");
    await page.keyboard.press("ArrowRight");
    assert.notEqual(await page.inputValue("#control input[type=text]"), before);
    await tabTo(page, "#to-bench");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#experiment:not([hidden])");
    await settled(page);
    await tabTo(page, "#problem");
    await tabTo(page, "#axes [name=y]");
    await tabTo(page, ".pane[data-run=A] .lens button");
    await tabTo(page, ".pane[data-run=A] .scheme");
    await page.keyboard.press("ArrowDown");
    await settled(page);
    assert.notEqual(await pane(page, "A").locator(".scheme").inputValue(), "explicit_euler");
    await tabTo(page, "#motion .play");
    for (const part of ["#add", "#even", "#continue", "#initial [data-name=q]", "#initial input[type=range]", "#measure-precision"]) {
      await tabTo(page, part);
    }
  });

pageTest("keys skip the header, and on small screens reach the scene before its studies", { hash: "#lesson=spiral", ready: "#lesson[aria-busy=false]", viewport: { width: 1024, height: 768 } }, async (page) => {
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.id), "skip");
  await page.keyboard.press("Enter");
  assert.equal(await page.evaluate(() => document.activeElement.id), "claim");
  await page.evaluate(() => (location.hash = "#problem=kepler&until.t=20"));
  await settled(page);
  await page.focus("#skip");
  await page.keyboard.press("Enter");
  assert.equal(await page.evaluate(() => document.activeElement.id), "problem");
  for (const [width, height] of [[1024, 768], [360, 740]]) {
    await page.setViewportSize({ width, height });
    const top = async (selector) => (await page.locator(selector).boundingBox()).y;
    assert.ok((await top("#results")) < (await top("#scene")) && (await top("#scene")) < (await top("#studies")), `${width}`);
  }
});
