// Measures the page in a browser: `./dev measure`. It prints numbers beside the most that is wanted, and "over" where they are:
// times are those of this machine. What can be judged anywhere, weight and counts, the tests assert.
import { browserPath, start } from "./served.mjs";
import { lessons } from "../../web/lessons/lessons.js";

if (!browserPath) throw new Error("measuring the page needs a browser: install chromium or set LEAST_BROWSER");
const tell = (what, value, most, digits = 0) =>
  console.log(`${what.padEnd(66)} ${value.toFixed(digits).padStart(8)}   at most ${String(most).padStart(4)}${value > most ? "   over" : ""}`);
const median = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];

/** When the first picture stands after an address was opened: drawn, in the frame after the page says so. */
async function pictured(page, address) {
  await page.addInitScript(() => document.addEventListener("seen", () => requestAnimationFrame(() => (
    setTimeout(() => (document.documentElement.dataset.at ??= performance.now()))))));
  await page.goto(address);
  await page.waitForSelector("html[data-at]");
  return Number(await page.getAttribute("html", "data-at"));
}

/** The times from moving the control of a lesson, each time to another place, to its pictures; none for a lesson without control. */
const moved = (page) => page.evaluate(async () => {
  const lesson = document.querySelector("#lesson"), track = lesson.querySelector("#control input[type=range]"), found = [];
  const way = Number(track?.value) > 500 ? -7 : 7;
  for (let i = 0; track && i < 9; i++) {
    const drawn = new Promise((resolve) => document.addEventListener("shown", resolve, { once: true })), from = performance.now();
    track.value = Number(track.value) + way;
    track.dispatchEvent(new Event("input", { bubbles: true }));
    await drawn;
    await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
    found.push(performance.now() - from);
  }
  return found;
});

const { origin, browser, stop } = await start(["--enable-precise-memory-info", "--js-flags=--expose-gc"]);
try {
  const opened = [];
  let bytes = 0;
  for (let i = 0; i < 5; i++) { // each with an empty cache
    const context = await browser.newContext({ viewport: { width: 1280, height: 720 } }), page = await context.newPage();
    opened.push(await pictured(page, origin));
    const own = /\.(js|css|html|svg)$|language\/\w+\.json$|\/$/;
    bytes = await page.evaluate((source) => [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")]
      .filter(({ name }) => new RegExp(source).test(new URL(name).pathname)).reduce((sum, entry) => sum + entry.encodedBodySize, 0), own.source);
    await context.close();
  }
  tell("the page, compressed, kB", bytes / 1000, 150, 1);
  tell("the first lesson's picture after its address, ms, median of 5", median(opened), 600);

  for (const { id } of lessons) {
    const times = [];
    let answers = [], whole = 0;
    for (let i = 0; i < 3; i++) {
      const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, reducedMotion: "reduce" }), page = await context.newPage();
      times.push(await pictured(page, `${origin}/#lesson=${id}`));
      await page.waitForSelector("#lesson[aria-busy=false]");
      whole = await page.evaluate(() => performance.now());
      if (i === 2) answers = await moved(page);
      await context.close();
    }
    tell(`lesson ${id}: its picture after its address, ms, median of 3`, median(times), 600);
    if (whole > 2 * median(times)) console.log(`  … which grows until ${whole.toFixed()} ms`);
    if (answers.length) tell(`lesson ${id}: from a move of its slider to its pictures, ms, median of 9`, median(answers), 100);
  }

  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, reducedMotion: "reduce" });
  await page.goto(`${origin}/#lesson=spiral`);
  await page.waitForSelector("#lesson[aria-busy=false]");
  for (const [points, wanted] of [[1e5, 50], [1e6, 150]]) {
    for (const kind of ["a curve", "a series"]) {
      const times = await page.evaluate(async ([n, series]) => {
        const { Plane } = await import("./drawing/plane.js"), figure = document.querySelector("#figures figure");
        figure.replaceChildren(Object.assign(document.createElement("canvas"), { className: "plane" }));
        const canvas = figure.firstChild, plane = new Plane(canvas);
        const t = Array.from({ length: n }, (_, i) => (i / n) * 600), turn = t.map((v) => v * 0.999);
        const x = series ? t : turn.map((v) => Math.cos(v) * (1 - v / 1200)), y = turn.map((v) => Math.sin(v) * (1 - v / 1200));
        const view = { x: series ? [0, 600] : [-1, 1], y: [-1, 1], free: series };
        plane.show({ curves: [{ t, x, y, series, colour: "--run-a", title: "" }], view, labels: ["x", "y"] });
        const found = [];
        for (let i = 0; i < 7; i++) {
          const from = performance.now();
          plane.draw();
          canvas.getContext("2d").getImageData(0, 0, 1, 1); // until it is painted
          found.push(performance.now() - from);
        }
        return found;
      }, [points, kind === "a series"]);
      tell(`a redraw of ${points.toExponential(0)} points of ${kind}, ms, median of 7`, median(times), wanted);
    }
  }
  await page.close();

  const hand = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  await hand.goto(`${origin}/#problem=kepler&until.t=95`);
  await hand.waitForSelector("#results[aria-busy=false]");
  const answers = await hand.evaluate(async () => {
    const results = document.querySelector("#results"), slider = document.querySelector("#initial input[type=range]"), found = [];
    for (let i = 0; i < 9; i++) {
      const from = performance.now();
      slider.value = 500 + 10 * i;
      slider.dispatchEvent(new Event("input", { bubbles: true }));
      while (results.getAttribute("aria-busy") === "true") await new Promise((resolve) => setTimeout(resolve));
      found.push(performance.now() - from);
    }
    return found;
  });
  tell("from a move of a slider to both pictures, ms, median of 9", median(answers), 100);
  await hand.close();

  const many = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  await many.goto(`${origin}/#problem=henon_heiles&until.t=20`);
  await many.waitForSelector("#results[aria-busy=false]");
  const crossings = await many.evaluate(async () => {
    const { Crossings } = await import("./drawing/crossings.js"), n = 1e4, found = [], figure = document.querySelector("#section figure");
    figure.hidden = false;
    figure.replaceChildren(Object.assign(document.createElement("canvas"), { className: "plane" }));
    const canvas = figure.firstChild, crossings = new Crossings(canvas);
    crossings.start(40, "x", "y");
    for (let k = 0; k < 100; k++) { // as they come from the service
      const values = (of) => Array.from({ length: n }, (_, i) => of((k * n + i) * 0.618));
      crossings.add({ section: { member: Array.from({ length: n }, (_, i) => i % 40), x: values(Math.sin), y: values((v) => Math.sin(1.7 * v)) } });
    }
    for (let i = 0; i < 7; i++) {
      const from = performance.now();
      crossings.draw();
      canvas.getContext("2d").getImageData(0, 0, 1, 1);
      found.push(performance.now() - from);
    }
    return found;
  });
  tell("a redraw of 1e+6 points of a section, ms, median of 7", median(crossings), 150);
  await many.close();

  const bench = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  await bench.goto(`${origin}/#problem=harmonic_oscillator&until.t=1000&record.samples=1000001&A=runge_kutta_4&A.step=0.001&B=runge_kutta_4&B.step=1`);
  await bench.waitForSelector("#results[aria-busy=false]", { timeout: 120_000 });
  const held = await bench.evaluate(() => {
    window.gc();
    return performance.memory.usedJSHeapSize;
  });
  tell("memory of the workbench with a run of 1e6 points, MB", held / 1e6, 200);
} finally {
  await stop();
}
