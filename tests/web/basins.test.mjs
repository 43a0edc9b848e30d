// Where many runs end: a pixel for each start, in the colour of its end, and the way back to a run.
import assert from "node:assert/strict";
import { becomes, origin, pageTest, seen, settled } from "./browser.mjs";
import { fieldAt } from "./made.mjs";

const canvas = "#basins canvas.plane";
/** The colour of the picture at a fraction of the canvas: red, green, blue. */
const colourAt = (page, x, y) => seen(page, canvas, (picture, [across, down]) => {
  const pen = new OffscreenCanvas(picture.width, picture.height).getContext("2d", { willReadFrequently: true });
  pen.drawImage(picture, 0, 0);
  return [...pen.getImageData(Math.round(across * picture.width), Math.round(down * picture.height), 1, 1).data].slice(0, 3);
}, [x, y]);
const isColoured = (rgb) => Math.max(...rgb) - Math.min(...rgb) > 60;
const said = (page) => page.textContent("#basins-status");

const rectangle = "&basins.left=-2&basins.right=2&basins.low=-3&basins.high=3&basins.side=64";
const well = { hash: `#problem=damped_pendulum&until.t=200&A=contact_splitting&A.step=0.1&basins.colour=q${rectangle}` };
pageTest("ends of many runs: coloured by where, and a click runs the start", well, async (page, context) => {
  const [question] = await Promise.all([page.waitForRequest("**/v1/ensemble"), page.click("#measure-basins")]);
  await becomes(() => said(page), (text) => /^4096 runs with contact splitting\. q at the end from/.test(text.replace(/^4\D/, "4")));
  const asked = question.postDataJSON();
  assert.deepEqual([asked.columns, asked.keep, asked.members], [["q"], ["final"],
    { vary: { "/initial/q": { grid: [-2, 2, 64] }, "/initial/p": { grid: [-3, 3, 64] } } }]);
  const { final } = await (await fetch(`${origin}/v1/ensemble`, { method: "POST", body: JSON.stringify(asked) })).json();
  const turns = final.q.map((q) => Math.round(q / (2 * Math.PI)));
  assert.ok(new Set(turns).size >= 3, "some turned over, to either side");
  await page.locator(canvas).scrollIntoViewIfNeeded();
  const box = await page.locator(canvas).boundingBox();
  await page.mouse.click(box.x + 0.5 * box.width, box.y + 0.2 * box.height);
  await settled(page);
  const member = Number(await page.inputValue("#basins .member input")), [i, j] = [Math.floor(member / 64), member % 64];
  const start = async (name) => Number(await fieldAt(page, `/initial/${name}`).inputValue());
  assert.ok(Math.abs((await start("q")) - (-2 + (4 * i) / 63)) < 1e-12 && Math.abs((await start("p")) - (-3 + (6 * j) / 63)) < 1e-12);
  assert.ok(j > 45 && Math.abs(i - 31) < 4, `what lies above is fast: row ${j}, column ${i}`);
  assert.ok(await page.isVisible(canvas), "the picture stays beside the run");
  const [above, below] = [await colourAt(page, 0.55, 0.1), await colourAt(page, 0.55, 0.8)];
  assert.ok(isColoured(above) && isColoured(below) && String(above) !== String(below), `${above}; ${below}`);
  await page.fill("#basins .member input", "0");
  await page.click("#basins .member button");
  await settled(page);
  assert.deepEqual([await start("q"), await start("p")], [-2, -3], "by keys as well");
  const other = await context.newPage();
  await other.goto(page.url());
  await settled(other);
  assert.equal(await other.inputValue("#basins [data-name=side]"), "64");
});

const line = (first, more) => ({ kind: "block", first, members: 2, final: { index: [first, first + 1], p: [first ? 3 : -3, null] }, ...more });
const slowly = (opened) => opened.addInitScript((lines) => {
  const whole = window.fetch, text = new TextEncoder();
  window.fetch = (path, options) => {
    if (!String(path).endsWith("ensemble")) return whole(path, options);
    const body = new ReadableStream({
      start(stream) {
        const say = (said) => stream.enqueue(text.encode(`${JSON.stringify(said)}\n`));
        say(lines[0]);
        window.goOn = () => {
          say(lines[1]);
          say({ kind: "end", completed: 3, stopped: { singular: 1 }, warnings: [] });
          stream.close();
        };
      },
    });
    return Promise.resolve(new Response(body, { headers: { "Content-Type": "application/x-ndjson" } }));
  };
}, [line(0), line(2, { final: { index: [2], p: [3] } })]);
// Members 0 and 1 are the left column from below, 2 and 3 the right one.
pageTest("ends appear as blocks come", { hash: "#problem=pendulum&until.t=5&basins.side=2", prepare: slowly }, async (page) => {
  await page.click("#measure-basins");
  await becomes(() => said(page), (text) => text === "2 of 4 runs…");
  await becomes(() => colourAt(page, 0.35, 0.65), isColoured);
  assert.ok(!isColoured(await colourAt(page, 0.8, 0.65)), "the others are to come");
  await page.evaluate(() => window.goOn());
  await becomes(() => said(page), (text) => /^3 runs with .*\. p at the end from −?-?3, red, to 3, violet\. 1 stopped \(singular\)\.$/.test(text));
  await becomes(() => colourAt(page, 0.8, 0.65), isColoured);
  const grey = await colourAt(page, 0.8, 0.25);
  assert.ok(!isColoured(grey) && grey[0] > 100 && grey[0] < 160, `${grey}: one that stopped`);
});
