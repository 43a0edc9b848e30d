// Many runs seen where they cross a plane: the program's points, in the colours of their members, and the way back to a run.
import assert from "node:assert/strict";
import { becomes, origin, pageTest, seen, settled } from "./browser.mjs";
import { enter, fieldAt } from "./made.mjs";

/** Coloured pixels of the picture: how many, the box around them, and one of them, all in fractions of the canvas. */
const coloured = (page) => seen(page, "#section canvas.plane", (canvas) => {
  const { width, height } = canvas, pen = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true }), found = [], hues = new Set();
  pen.drawImage(canvas, 0, 0);
  const { data } = pen.getImageData(0, 0, width, height);
  for (let i = 0; i < data.length; i += 4) {
    const of = [data[i], data[i + 1], data[i + 2]];
    if (Math.max(...of) - Math.min(...of) < 100) continue;
    found.push([((i / 4) % width) / width, Math.floor(i / 4 / width) / height]);
    hues.add(of.join());
  }
  const ends = (k) => found.reduce(([low, high], at) => [Math.min(low, at[k]), Math.max(high, at[k])], [1, 0]);
  return { count: found.length, hues: hues.size, x: ends(0), y: ends(1), one: found[Math.floor(found.length / 3)] };
});

const chaos = { hash: "#problem=henon_heiles&until.t=300&A=leapfrog&B=leapfrog", expected: /status of 422/ };
pageTest("a section of many runs: points by member, and a click runs the member", chaos, async (page, context) => {
  const said = () => page.textContent("#section-status");
  const [question] = await Promise.all([page.waitForRequest("**/v1/ensemble"), page.click("#measure-section")]);
  await becomes(said, (text) => /points of 40 runs with leapfrog/.test(text));
  const asked = question.postDataJSON();
  assert.deepEqual([asked.section, asked.columns, asked.members], [{ expression: "x", direction: "up" }, ["y", "py"],
                                                                    { vary: { "/initial/y": { grid: [-0.1, 0.3, 40] } } }]);
  const { section } = await (await fetch(`${origin}/v1/ensemble`, { method: "POST", body: JSON.stringify(asked) })).json();
  const picture = await coloured(page);
  assert.ok(picture.count > 1000 && picture.hues > 30, `${picture.count} pixels in ${picture.hues} colours`);
  await page.locator("#section canvas.plane").scrollIntoViewIfNeeded();
  const box = await page.locator("#section canvas.plane").boundingBox();
  await page.mouse.click(box.x + picture.one[0] * box.width, box.y + picture.one[1] * box.height);
  await settled(page);
  const member = Number(await page.inputValue("#section .member input")), start = Number(await fieldAt(page, "/initial/y").inputValue());
  assert.ok(Math.abs(start - (-0.1 + (0.4 * member) / 39)) < 1e-12, "the start of that member");
  const part = (values, v) => (v - Math.min(...values)) / (Math.max(...values) - Math.min(...values));
  const at = [part(picture.x, picture.one[0]), 1 - part(picture.y, picture.one[1])];
  const distances = section.member.map((m, i) => (m === member
    ? Math.hypot(part(section.y, section.y[i]) - at[0], part(section.py, section.py[i]) - at[1]) : Infinity));
  assert.ok(Math.min(...distances) < 0.02, `it has a point there: ${Math.min(...distances)}`);
  assert.ok(await page.isVisible("#section canvas"), "the section stays beside the run");
  await page.fill("#section .member input", "39");
  await page.click("#section .member button");
  await settled(page);
  assert.ok(Math.abs(Number(await fieldAt(page, "/initial/y").inputValue()) - 0.3) < 1e-12, "by keys as well");
  await enter(page, "/initial/px", "0.2");
  assert.ok(!(await page.isVisible("#section canvas")), "another scene has other crossings");

  await page.locator("#section [data-name=count]").fill("4");
  await page.locator("#section [data-name=where]").fill("zz");
  await page.locator("#section [data-name=where]").press("Tab");
  assert.match(page.url(), /section\.where=zz&section\.count=4/);
  await page.click("#measure-section");
  await becomes(said, (text) => /zz/.test(text));
  const other = await context.newPage();
  await other.goto(page.url());
  await settled(other);
  assert.equal(await other.inputValue("#section [data-name=count]"), "4");
});

const blocks = [0, 1].map((k) => ({ kind: "block", section: { member: [k, k], crossing: [0, 1], t: [0, 1], y: [k, k + 0.5], py: [0, 1] } }));
const slowly = (opened) => opened.addInitScript((lines) => {
  const whole = window.fetch, text = new TextEncoder();
  window.fetch = (path, options) => {
    if (!String(path).endsWith("ensemble")) return whole(path, options);
    const body = new ReadableStream({
      start(stream) {
        const say = (line) => stream.enqueue(text.encode(`${JSON.stringify(line)}\n`));
        say(lines[0]);
        window.goOn = () => {
          say(lines[1]);
          say({ kind: "end", completed: 2, stopped: { singular: 1 }, warnings: [] });
          stream.close();
        };
      },
    });
    return Promise.resolve(new Response(body, { headers: { "Content-Type": "application/x-ndjson" } }));
  };
}, blocks);
pageTest("a section fills as blocks come", { hash: "#problem=henon_heiles&until.t=5", prepare: slowly }, async (page) => {
  await page.click("#measure-section");
  await becomes(() => page.textContent("#section-status"), (text) => text === "2 points…");
  const first = (await coloured(page)).count;
  await page.evaluate(() => window.goOn());
  await becomes(() => page.textContent("#section-status"), (text) => text === "4 points of 2 runs with leapfrog. 1 stopped (singular).");
  assert.ok((await coloured(page)).count > first && first > 0);
});
