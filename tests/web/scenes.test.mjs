// The page with scenes of every shape that the catalogue may describe: made up here, and answered here, so that each
// shape is met on its own and what the page asks for is seen.
import assert from "node:assert/strict";
import { test } from "node:test";
import { all, assertDrawn, drawn, number, pageTest, pane, plane, settled, stepOf } from "./browser.mjs";
import { enter, fieldAt, madeUp, row, scene, variable } from "./made.mjs";
import { commonView } from "../../web/drawing/mapping.js";

const damped = scene("damped", {
  variables: [variable("q", 1), variable("p", 0), variable("s", null, { optional: true })],
  parameters: [{ ...variable("damping", 0.1), symbol: "α", type: "number", minimum: 0, maximum: 9, nullable: false }],
  presets: [
    { name: "strong_damping", doc: "Hardly one swing.", parameters: { damping: 0.5 }, initial: { q: 2, t: 5 } },
    { name: "kicked", doc: "From rest.", parameters: {}, initial: { q: 0, p: 1, s: 0.2 }, suggested: { step: 0.02 }, until: { t: 80 } },
  ],
  columns: ["t", "q", "p", "s", "energy"],
  diagnostics: ["energy", "structure", "error", "decay", "entropy", "zeros", "cycle", "moments"],
});
const attractor = scene("attractor", {
  variables: [variable("x", 1), variable("y", 1), variable("z", 1)],
  columns: ["t", "x", "y", "z"], diagnostics: ["error", "cycle"], schemes: ["explicit_euler", "runge_kutta_4"],
});
const keeper = scene("keeper", {
  variables: [variable("q", 1), variable("p", 0), variable("U", 0)], columns: ["t", "q", "p", "U", "energy"],
  invariants: [{ name: "energy", symbol: "E", doc: "total energy" }],
});

const sceneTest = madeUp([damped, attractor, keeper]);

sceneTest("a preset fills in parameters and start, runs, and is in the link", {}, async (page, asked, context) => {
  assert.ok(await page.locator("#presets").isVisible());
  assert.deepEqual(await all(page, "#preset option", "textContent"), ["default", "strong damping", "kicked"]);
  assert.equal(await page.textContent("#preset-doc"), "");
  assert.ok(asked.every((request) => !("preset" in request.problem)));
  await page.fill("[data-pointer='/record/samples']", "100");
  await stepOf(page, "B").fill("0.04");
  await page.selectOption("#preset", "strong_damping");
  await settled(page);
  assert.equal(await page.textContent("#preset-doc"), "Hardly one swing.");
  for (const [pointer, value] of [["/problem/damping", "0.5"], ["/initial/q", "2"], ["/initial/p", "0"],
                                  ["/initial/t", "5"], ["/until/t", "55"], ["/record/samples", "100"]]) {
    assert.equal(await fieldAt(page, pointer).inputValue(), value, pointer);
  }
  assert.equal(await stepOf(page, "B").inputValue(), "0.04", "the runs stay as they were set");
  const [a, b] = asked.slice(-2);
  assert.deepEqual(a.problem, { id: "damped", preset: "strong_damping", damping: 0.5 });
  assert.deepEqual(a.initial, { t: 5, q: 2, p: 0 });
  assert.deepEqual([a.record.every, b.record.every], [5, 13], "the span is 50, not 55");

  await enter(page, "/problem/damping", "0.7");
  const other = await context.newPage();
  await other.goto(page.url());
  await settled(other);
  assert.equal(other.url(), page.url());
  assert.equal(await other.inputValue("#preset"), "strong_damping");
  assert.equal(await fieldAt(other, "/problem/damping").inputValue(), "0.7", "what was set by hand wins");
  assert.equal(await fieldAt(other, "/initial/q").inputValue(), "2");
  assert.deepEqual(asked.at(-1), asked.at(-3), "and the same is run");

  await page.selectOption("#preset", "");
  await settled(page);
  assert.equal(await fieldAt(page, "/problem/damping").inputValue(), "0.1");
  assert.equal(await fieldAt(page, "/until/t").inputValue(), "50");
  await page.selectOption("#problem", "attractor");
  await settled(page);
  assert.ok(!(await page.locator("#presets").isVisible()), "no presets, no choice of them");
});

sceneTest("a preset brings the steps and the span that it suggests, but for what was set", {}, async (page, asked) => {
  await stepOf(page, "B").fill("0.04");
  await page.selectOption("#preset", "kicked");
  await settled(page);
  const [a, b] = asked.slice(-2);
  assert.deepEqual([a.until.t, a.scheme.step, b.scheme.step], [80, 0.02, 0.04]);
  assert.doesNotMatch(page.url(), /until|A\.step/, "which the link leaves out");
  await page.selectOption("#preset", "");
  await settled(page);
  assert.deepEqual([asked.at(-2).until.t, asked.at(-2).scheme.step], [50, 0.1]);
});

test("lengths have one scale, unless nothing would be seen", () => {
  const free = (x, y) => commonView([{ x: [0, x], y: [0, y] }]).free;
  assert.deepEqual([free(1, 1), free(4, 1), free(60, 1), free(1, 60), free(1, 0)], [false, false, true, true, false]);
});

sceneTest("the default end follows the start, and an end that was set stays", {}, async (page, asked) => {
  assert.equal(await fieldAt(page, "/initial/t").inputValue(), "0");
  await enter(page, "/initial/t", "2.5");
  assert.equal(await fieldAt(page, "/until/t").inputValue(), "52.5");
  assert.deepEqual([asked.at(-1).initial.t, asked.at(-1).until.t], [2.5, 52.5]);
  await enter(page, "/until/t", "10");
  await enter(page, "/initial/t", "4");
  assert.equal(await fieldAt(page, "/until/t").inputValue(), "10");
  await page.selectOption("#preset", "kicked");
  await settled(page);
  assert.deepEqual([asked.at(-1).initial.t, asked.at(-1).until.t], [0, 10]);
  await page.evaluate(() => (location.hash = "#problem=damped&initial.t=7"));
  await page.waitForFunction(() => document.querySelector("[data-pointer='/until/t']").value === "57");
});

sceneTest("an optional variable is sent when it is given, and is no column", {}, async (page, asked) => {
  assert.equal(await fieldAt(page, "/initial/s").inputValue(), "");
  assert.deepEqual(asked.at(-1).initial, { t: 0, q: 1, p: 0 });
  assert.deepEqual(asked.at(-1).columns, ["t", "q", "p", "energy"]);
  assert.deepEqual(await all(page, "#axes [name=x] option", "value"), ["q", "p", "t", "s", "energy", "error_of_energy"]);
  await enter(page, "/initial/s", "0.25");
  assert.equal(asked.at(-1).initial.s, 0.25);
  assert.deepEqual(asked.at(-1).columns, ["t", "q", "p", "energy"]);
  assert.match(page.url(), /initial\.s=0\.25/);
  await enter(page, "/initial/s", "");
  assert.ok(!("s" in asked.at(-1).initial));
  await page.selectOption("#preset", "kicked");
  await settled(page);
  assert.equal(await fieldAt(page, "/initial/s").inputValue(), "0.2", "a preset's is seen");
  assert.ok(!("s" in asked.at(-1).initial), "and comes with the preset's name");
});

const attracted = { hash: "#problem=attractor" };
sceneTest("a scene without energy is not asked for it, and the page says so", attracted, async (page, asked) => {
  assert.deepEqual(asked.at(-1).columns, ["t", "x", "y", "z"]);
  assert.deepEqual(asked.at(-1).diagnostics, ["cycle"]);
  assert.equal(asked.at(-1).scheme.id, "runge_kutta_4", "where no scheme keeps a structure, not simply the first");
  assert.match(await page.textContent("#energy-note"), /no energy/);
  assert.ok(!(await page.locator("#energy").isVisible()));
  assert.equal(await page.locator("#numbers tr[data-row^=energy]").count(), 0);
  assert.ok((await drawn(page, plane("A"), "A")).count > 200);
  await page.selectOption("#problem", "keeper");
  await settled(page);
  assert.ok((await drawn(page, "#energy canvas", "B")).count > 100, "the plot is back");
  assert.equal(await page.textContent("#energy-note"), "");
});

sceneTest("energy that decays is shown itself; energy that is kept, by its error", {}, async (page) => {
  const heights = async (run) => {
    const [early, late] = [await drawn(page, "#energy canvas", run, [0, 0.3]), await drawn(page, "#energy canvas", run, [0.7, 1])];
    return [early.top, late.bottom];
  };
  assert.match(await page.textContent("#energy-title"), /^Energy H\b/);
  for (const run of ["A", "B"]) {
    const [early, late] = await heights(run);
    assert.ok(late > early + 60, `H falls, from ${early} px to ${late} px, and ${run} is seen beside the other`);
  }
  await assertDrawn(page);
  assert.deepEqual(await row(page, "energy_initial"), ["1", "1"]);
  assert.deepEqual(await row(page, "energy_final"), ["0.25", "0.25"]);
  assert.equal(await page.locator("#numbers tr[data-row=energy]").count(), 0, "what is no error is not called one");
  await page.selectOption("#problem", "keeper");
  await settled(page);
  assert.match(await page.textContent("#energy-title"), /^Energy error/);
  const [early, late] = await heights("B");
  assert.ok(early < Infinity && (await drawn(page, "#energy canvas", "B", [0, 0.15])).bottom > late, "the error grows");
  assert.equal(await number(page, "energy", "A"), 0.75);
});

sceneTest("the axes are chosen, without another run, and stay in the link", attracted, async (page, asked, context) => {
  const width = (box) => box.right - box.left, height = (box) => box.bottom - box.top;
  const seen = () => drawn(page, plane("A"), "A");
  const label = (shown) => shown.getAttribute(plane("A"), "aria-label");
  const axis = { x: "#axes [name=x]", y: "#axes [name=y]" };
  assert.deepEqual(await all(page, `${axis.x} option`, "value"), ["x", "y", "z", "t"]);
  assert.match(await label(page), /^y over x /);
  const circle = await seen(), before = asked.length;
  assert.ok(Math.abs(width(circle) / height(circle) - 1) < 0.1);
  await page.selectOption(axis.y, "z");
  assert.match(await label(page), /^z over x /);
  const flat = await seen();
  assert.ok(width(flat) > 3 * height(flat), "z, a quarter of x, on the scale of x");

  await page.selectOption(axis.x, "t");
  assert.match(await label(page), /^z over t /);
  const wave = await seen();
  const { clientWidth, clientHeight } = await page.locator(plane("A")).evaluate((c) => ({
    clientWidth: c.clientWidth, clientHeight: c.clientHeight }));
  assert.ok(width(wave) > 0.7 * clientWidth && height(wave) > 0.7 * clientHeight, "time has a scale of its own");
  assert.equal(asked.length, before, "what is there already is not run again");

  const other = await context.newPage();
  await other.goto(page.url());
  await settled(other);
  assert.match(await label(other), /^z over t /);
  await page.selectOption("#problem", "keeper");
  await settled(page);
  assert.match(await label(page), /^p over q /, "another scene has its own axes");
});

const halfMeasured = ({ diagnostics, scheme }) => {
  if (scheme.step === 0.1) diagnostics.cycle = null;
  if (scheme.step === 0.1) diagnostics.entropy = { initial: 0, final: null, monotone: false };
  if (scheme.step === 0.05) diagnostics.zeros = [];
};
sceneTest("any diagnostic is in the table, as far as it is known", { change: halfMeasured }, async (page, asked) => {
  assert.deepEqual(asked.at(-1).diagnostics, ["energy", "decay", "entropy", "zeros", "cycle"], "no costlier ones");
  assert.deepEqual(await row(page, "decay.max_residual"), ["0.00125", "0.00125"]);
  assert.deepEqual(await row(page, "entropy.final"), ["–", "0.5"]);
  assert.deepEqual(await row(page, "entropy.monotone"), ["no", "yes"]);
  assert.deepEqual(await row(page, "zeros"), ["1.5, 4.7, 7.9, … (5)", "none"]);
  assert.deepEqual(await row(page, "cycle.period"), ["–", "6.66"]);
  assert.equal(await page.locator("#numbers tr[data-row=cycle]").count(), 0);
  assert.match(await page.textContent("#numbers"), /Decay: max residual/);
});

const interrupted = ({ trajectory, scheme }) => {
  trajectory.q = trajectory.q.map((v) => v + 3); // far from zero, which a null must not be taken for
  if (scheme.step !== 0.1) return;
  trajectory.energy = trajectory.energy.map((v) => v * v); // beside the other's
  for (const column of ["q", "energy"]) {
    trajectory[column] = trajectory[column].map((v, i) => (i > 100 && i < 400 ? null : v));
  }
};
for (const [id, what] of [["damped", "the energy"], ["keeper", "its error"]]) {
  const gappy = { hash: `#problem=${id}&axes.x=t&axes.y=q`, change: interrupted };
  sceneTest(`what has no value leaves a gap, in the plane and in ${what}`, gappy, async (page) => {
    for (const canvas of [plane, () => "#energy canvas"]) {
      const count = async (run, columns) => (await drawn(page, canvas(run), run, columns)).count;
      assert.ok((await count("A", [0.1, 0.25])) > 20 && (await count("A", [0.85, 1])) > 20, "both ends are drawn");
      assert.equal(await count("A", [0.35, 0.7]), 0, "nothing between them");
      assert.ok((await count("B", [0.35, 0.7])) > 20, "the other run has no gap");
    }
    const { top, bottom } = await drawn(page, plane("B"), "B");
    const height = await page.locator(plane("B")).evaluate((canvas) => canvas.clientHeight);
    assert.ok(bottom - top > 0.75 * height, "the view is around what there is");
  });
}

const singular = (outcome) => {
  if (outcome.scheme.step !== 0.1) return;
  outcome.status = "stopped";
  outcome.stop = { reason: "singular", detail: "the density vanishes", t: 2.25, step: 22, singular_at: 2.3125 };
};
sceneTest("a stop names its singularity, where it knows one", { change: singular }, async (page) => {
  const text = await pane(page, "A").locator(".messages .stop").textContent();
  assert.match(text, /singular.*t = 2\.25: the density vanishes \(singular at t = 2\.3125\)/);
  assert.equal(await pane(page, "B").locator(".messages .stop").count(), 0);
});

const unplaced = (outcome) => {
  outcome.status = "stopped";
  outcome.stop = { reason: "left_domain", detail: "q fell below 0", t: 2.25, step: 22, singular_at: null };
};
sceneTest("a stop without a singularity names none", { change: unplaced }, async (page) => {
  const text = await pane(page, "A").locator(".messages .stop").textContent();
  assert.match(text, /left domain.*q fell below 0$/);
});

const narrow = { viewport: { width: 390, height: 844 }, hash: "#problem=damped&preset=strong_damping" };
sceneTest("at the width of a telephone the choices fit as well", narrow, async (page) => {
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
  assert.ok(await page.locator("#preset").isVisible() && (await page.locator("#axes [name=x]").isVisible()));
});

pageTest("a step of a millionth is seen whole in its field, and is no change", { hash: "#problem=argon" }, async (page) => {
  assert.deepEqual([await stepOf(page, "A").inputValue(), await stepOf(page, "B").inputValue()], ["2e-6", "1e-6"]);
  assert.equal(new URL(page.url()).hash, "#problem=argon&A=leapfrog&B=leapfrog");
});
