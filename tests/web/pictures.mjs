// Takes the README's pictures of the page: page.png, the first lesson as it opens, and spiral.png, a lesson that plays.
// `./dev figure` calls it; LEAST_BINARY and LEAST_BROWSER as in browser.mjs.
import { writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { decode, encode } from "./apng.mjs";
import { browserPath, start } from "./served.mjs";

const settled = "#lesson[aria-busy=false]";
const frames = 80, every = 5; // positions of the time slider from one frame to the next: a fifth of its thousand is 12 of 60
const milliseconds = 90;

function write(name, bytes) {
  const path = fileURLToPath(new URL(name, import.meta.url));
  writeFileSync(path, bytes);
  console.log(`${path}: ${bytes.length} bytes`);
}

if (!browserPath) throw new Error("pictures of the page need a browser: install chromium or set LEAST_BROWSER");
const { origin, browser, stop } = await start();
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, reducedMotion: "reduce" });
  await page.goto(origin);
  await page.waitForSelector(settled);
  write("page.png", await page.screenshot());

  await page.setViewportSize({ width: 960, height: 600 });
  await page.goto(`${origin}/#lesson=spiral`);
  await page.waitForSelector(`#which:has(option[value=spiral]:checked)`);
  await page.waitForSelector(settled);
  const clip = await page.locator("#figures").boundingBox(), taken = [];
  for (let i = 0; i < frames; i++) {
    await page.locator("#lesson .time input").fill(String(i * every));
    taken.push(decode(await page.screenshot({ clip })));
  }
  write("spiral.png", encode(taken, milliseconds));
} finally {
  await stop();
}
