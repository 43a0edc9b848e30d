// Schemes that choose their own steps, on the page: made-up ones of every shape, then those of the program.
import assert from "node:assert/strict";
import { all, drawn, frames, number, pageTest, pane, plane, settled, statuses } from "./browser.mjs";
import { enter, madeUp, scene, variable } from "./made.mjs";

const numeric = (name, value, more = {}) => ({
  ...variable(name, value), type: "number", minimum: 0, maximum: 9, nullable: false, ...more,
});
const choice = (name, choices, value = choices[0]) => ({ ...variable(name, value), type: "choice", choices, nullable: false });
const scheme = (id, parameters, more = {}) => ({
  id, title: id, summary: "", order: 2, implicit: false, symmetric: true, structure: "none", parameters, recommended: null,
  presets: [], own_clock: true, good_for: "", fails_when: "", needs: "", references: [], ...more,
});
const step = numeric("step", 0.5, { symbol: "h", suggested: "step" });
const hybrid = scheme("hybrid", [
  step, numeric("theta", 0.04, { symbol: "θ", suggested: "theta" }), numeric("critical", null, { nullable: true }),
  choice("exit", ["nominal", "paper"]), { ...numeric("order", 4), type: "integer" }, numeric("alpha", 0.1, { nullable: true }),
], {
  order: { 2: 2, 4: 4, 6: 6 },
  presets: [{ name: "default", doc: "Robust.", parameters: {} },
            { name: "paper", doc: "As published.", parameters: { exit: "paper", order: 2, alpha: null } },
            { name: "coarse", doc: "", parameters: { theta: 0.5 } }],
});
const timed = scheme("timed", [
  numeric("sigma", 0.02, { symbol: "σ", suggested: "sigma" }), numeric("kappa", 1, { nullable: true, word: "energy" }),
  choice("composition", ["none", "suzuki_4"]), choice("splitting", ["automatic", "plain", "aba_864"]),
], { order: { none: 2, suzuki_4: 4, aba_864: 6 }, presets: [{ name: "exact", doc: "", parameters: { kappa: "energy" } }] });
const plain = scheme("plain", [step, choice("monitor", ["arclength", "frequency"])]);
const swing = scene("swing", {
  variables: [variable("q", 1), variable("p", 0)], columns: ["t", "q", "p", "step_size", "energy", "mode", "parameter"],
  schemes: ["leapfrog", "hybrid", "timed", "plain"], suggested: { step: 0.1, theta: 0.01, sigma: 0.2 },
});
const flow = scene("flow", { variables: [variable("x", 1), variable("y", 0)], columns: ["t", "x", "y"], schemes: ["plain"] });
const clockTest = madeUp([swing, flow], [hybrid, timed, plain]);

const field = (page, run, name) => pane(page, run).locator(`[data-name=${name}]`);
const preset = (page, run) => pane(page, run).locator(".preset");
const last = (asked, id) => asked.findLast((request) => request.scheme.id === id);

async function pick(page, run, select, value) {
  await pane(page, run).locator(select).selectOption(value);
  await settled(page);
}
/** Types into a field of a run. */
async function set(page, run, name, value) {
  await field(page, run, name).fill(value);
  await field(page, run, name).press("Enter");
  await settled(page);
}

const both = "#problem=swing&A=leapfrog&B=hybrid";
clockTest("of a scheme with its own clock samples are asked for, and the mode where there is one", { hash: both },
  async (page, asked) => {
    assert.deepEqual(last(asked, "hybrid").record, { samples: 10000 });
    assert.deepEqual(last(asked, "hybrid").columns, ["t", "q", "p", "energy", "mode"]);
    assert.deepEqual(last(asked, "leapfrog").record, { every: 1 });
    assert.deepEqual(last(asked, "leapfrog").columns, ["t", "q", "p", "energy"], "the others have no modes");
    await enter(page, "/record/samples", "50");
    assert.deepEqual(last(asked, "hybrid").record, { samples: 50 });
    assert.deepEqual(last(asked, "leapfrog").record, { every: 10 });
    await page.selectOption("#problem", "flow");
    await settled(page);
    assert.deepEqual(last(asked, "plain").columns, ["t", "x", "y"]);
  });

const twice = { hash: "#problem=swing&A=hybrid&B=hybrid" };
clockTest("B has half the suggested step, of whatever kind it is, and the titles say it", twice,
  async (page, asked) => {
    const sizes = async (names) => Promise.all(["A", "B"].map(async (run) =>
      Promise.all(names.map((name) => field(page, run, name).inputValue()))));
    assert.deepEqual(await sizes(["step", "theta"]), [["0.1", "0.01"], ["0.05", "0.005"]]);
    assert.deepEqual(asked.slice(-2).map((request) => request.scheme.theta), [0.01, 0.005]);
    const title = (run) => pane(page, run).locator("figcaption .title").textContent();
    assert.equal(await title("B"), "B hybrid, h = 0.05, θ = 0.005");
    assert.match(await pane(page, "B").locator(".traits").textContent(), /^order 4 /, "the parameter says the order");
    for (const run of ["A", "B"]) await pick(page, run, ".scheme", "timed");
    assert.deepEqual(await sizes(["sigma"]), [["0.2"], ["0.1"]]);
    await pick(page, "B", "[data-name=composition]", "suzuki_4");
    assert.equal(await title("B"), "B timed (suzuki 4), σ = 0.1");
    assert.match(await pane(page, "B").locator(".traits").textContent(), /^order 4 /);
    await pick(page, "B", "[data-name=composition]", "none");
    await pick(page, "B", "[data-name=splitting]", "aba_864");
    assert.equal(await title("B"), "B timed (aba 864), σ = 0.1");
    assert.match(await pane(page, "B").locator(".traits").textContent(), /^order 6 /, "of whatever says the most");
    await page.selectOption("#problem", "flow");
    await settled(page);
    assert.deepEqual(await sizes(["step"]), [["0.1"], ["0.05"]]);
  });

clockTest("presets of a scheme fill in its fields, run, and are in the link", { hash: both }, async (page, asked, context) => {
  assert.ok(!(await preset(page, "A").isVisible()), "leapfrog has none");
  assert.deepEqual(await all(page, ".pane[data-run=B] .preset option", "textContent"), ["default", "paper", "coarse"]);
  assert.equal(await preset(page, "B").inputValue(), "default");
  await set(page, "B", "theta", "0.003");
  await set(page, "B", "order", "6");
  await pick(page, "B", ".preset", "paper");
  assert.deepEqual(last(asked, "hybrid").scheme, { id: "hybrid", preset: "paper", step: 0.05, theta: 0.003, critical: null,
                                                   exit: "paper", order: 2, alpha: null }, "the fineness stays");
  assert.equal(await field(page, "B", "alpha").inputValue(), "");
  assert.match(await pane(page, "B").locator("figcaption .title").textContent(), /hybrid \(paper\)/);
  await set(page, "B", "order", "4");
  assert.equal(last(asked, "hybrid").scheme.order, 4, "what is set by hand wins");

  const other = await context.newPage();
  await other.goto(page.url());
  await settled(other);
  assert.equal(other.url(), page.url());
  assert.equal(await preset(other, "B").inputValue(), "paper");
  assert.equal(await field(other, "B", "order").inputValue(), "4");
  assert.equal(await field(other, "B", "alpha").inputValue(), "");
  assert.deepEqual(last(asked, "hybrid"), last(asked.slice(0, -2), "hybrid"), "and the same is run");

  await pick(page, "B", ".preset", "coarse");
  assert.equal(await field(page, "B", "theta").inputValue(), "0.5", "a preset's step is taken as given");
  assert.equal(await field(page, "B", "alpha").inputValue(), "0.1");
  await pick(page, "B", ".scheme", "timed");
  assert.deepEqual(await all(page, ".pane[data-run=B] .preset option", "value"), ["", "exact"]);
  assert.ok(!("preset" in last(asked, "timed").scheme));
  await pick(page, "B", ".preset", "exact");
  assert.equal(last(asked, "timed").scheme.kappa, "energy");
  await pick(page, "B", ".scheme", "plain");
  assert.ok(!(await preset(page, "B").isVisible()));
  assert.ok(!("preset" in last(asked, "plain").scheme));
});

clockTest("a field may be empty, or hold the word that stands for a number", { hash: "#problem=swing&A=hybrid&B=timed" },
  async (page, asked, context) => {
    assert.equal(last(asked, "hybrid").scheme.critical, null);
    assert.equal(await field(page, "A", "alpha").getAttribute("placeholder"), "off");
    await set(page, "A", "alpha", "");
    assert.equal(last(asked, "hybrid").scheme.alpha, null);
    await set(page, "A", "critical", "0.75");
    assert.equal(last(asked, "hybrid").scheme.critical, 0.75);
    assert.equal(last(asked, "timed").scheme.kappa, 1);
    assert.match(await field(page, "B", "kappa").getAttribute("title"), /empty: energy/);
    for (const typed of ["energy", ""]) {
      await set(page, "B", "kappa", "2");
      assert.equal(last(asked, "timed").scheme.kappa, 2);
      await set(page, "B", "kappa", typed);
      assert.equal(last(asked, "timed").scheme.kappa, "energy", `"${typed}"`);
    }
    assert.equal(await field(page, "B", "kappa").getAttribute("placeholder"), "energy");
    const other = await context.newPage();
    await other.goto(page.url());
    await settled(other);
    assert.equal(last(asked, "timed").scheme.kappa, "energy");
    assert.equal(last(asked, "hybrid").scheme.alpha, null);
  });

const stretch = async (page, run) => (await drawn(page, plane(run), "--stretch")).count;
const legend = (page, run) => pane(page, run).locator(".stretches");
const long = {
  hash: `${both}&until.t=4&B.preset=paper&B.step=0.0123456789&B.theta=0.0123456789`, // a caption of two lines
  change: ({ trajectory, scheme }) => {
    if (scheme.id === "timed") trajectory.mode = trajectory.mode.map(() => null);
  },
};
clockTest("stretches of the other principle are marked where they are, with a legend, dark or light", long, async (page) => {
  await page.selectOption("#axes [name=x]", "t");
  await page.selectOption("#axes [name=y]", "q");
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme });
    await frames(page);
    const marked = await drawn(page, plane("B"), "--stretch"), own = await drawn(page, plane("B"), "B");
    assert.ok(marked.count > 200, `${marked.count} pixels in ${colorScheme}`);
    const at = (pixel) => ((pixel - own.left) / (own.right - own.left)) * 4;
    assert.ok(Math.abs(at(marked.left) - 1) < 0.15 && Math.abs(at(marked.right) - 2) < 0.15, "from t = 1 to 2");
    const width = await page.locator(plane("B")).evaluate((canvas) => canvas.width);
    const above = await drawn(page, plane("B"), "B", [marked.left / width, marked.right / width]);
    assert.ok(above.count > 50, "the run's own colour lies above");
    assert.equal(await stretch(page, "A"), 0);
  }
  assert.match(await legend(page, "B").textContent(), /Jacobi–Maupertuis/);
  assert.deepEqual([await legend(page, "A").isVisible(), await legend(page, "B").isVisible()], [false, true]);
  const [top, other] = await Promise.all(["A", "B"].map(async (run) => (await page.locator(plane(run)).boundingBox()).y));
  assert.equal(top, other, "the pictures stand at one height");
  await pick(page, "B", ".scheme", "timed");
  assert.equal(await stretch(page, "B"), 0);
  assert.ok(!(await legend(page, "B").isVisible()), "a scheme without modes marks nothing");
});

const eventful = { hash: both, change: (outcome) => {
  const of = (kind, n) => Array.from({ length: n }, (_, i) => ({ t: i, kind }));
  outcome.events = outcome.scheme.id === "hybrid" ? [...of("switch", 2), ...of("parameter", 1), ...of("near_miss", 1200)] : [];
} };
clockTest("events are counted", eventful, async (page) => {
  assert.equal(await pane(page, "B").locator(".messages .events").textContent(),
               "2 switches, 1 change of parameter, 1\u202f200 near miss");
  assert.equal(await pane(page, "A").locator(".messages li").count(), 0);
});

const narrow = { viewport: { width: 390, height: 844 }, ...long };
clockTest("at the width of a telephone many parameters fit as well", narrow, async (page) => {
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
});

// ── the program's own ──────────────────────────────────────────────────────────────────────────────────────────────────

const orbit = "#problem=kepler&until.t=95&A=leapfrog&A.step=0.01";
pageTest("the hybrid stops the precession, and its fast stretches are marked",
  { hash: `${orbit}&B=jacobi_maupertuis&B.step=0.01&B.theta=0.01` }, async (page, context) => {
    assert.deepEqual(await statuses(page), ["completed", "completed"]);
    assert.equal(await page.locator(".fault").count(), 0);
    const rotation = async (run) => Math.abs(await number(page, "apsidal_rotation", run));
    assert.ok(Math.abs((await rotation("A")) / 0.0454 - 1) < 0.02);
    assert.ok((await rotation("B")) < 1e-4, `${await rotation("B")}`);
    assert.equal(await stretch(page, "A"), 0);
    const marked = await drawn(page, plane("B"), "--stretch"), own = await drawn(page, plane("B"), "B");
    assert.ok(marked.count > 50 && marked.bottom - marked.top < 0.5 * (own.bottom - own.top), "near the centre only");
    assert.ok(await legend(page, "B").isVisible());
    assert.match(await pane(page, "B").locator(".messages .events").textContent(), /\b10 switches/, "two a revolution");
    await pick(page, "B", ".preset", "paper");
    assert.deepEqual(await statuses(page), ["completed", "completed"]);
    assert.ok((await rotation("B")) > 2e-6 && (await rotation("B")) < 0.01, "the published scheme precesses a little");
    assert.equal(await field(page, "B", "alpha_max").inputValue(), "");
    const other = await context.newPage(), energy = await number(page, "energy", "B");
    await other.goto(page.url());
    await settled(other);
    assert.equal(await preset(other, "B").inputValue(), "paper");
    assert.equal(await number(other, "energy", "B"), energy);
  });

const transformed = { expected: /status of 422/, hash: `${orbit}&B=time_transformed` };
pageTest("transformed time keeps the orbit's shape, by a word in a field", transformed, async (page) => {
  assert.equal(await field(page, "B", "sigma").inputValue(), "0.01");
  await pick(page, "B", ".preset", "kepler");
  assert.equal(await field(page, "B", "kappa").inputValue(), "energy");
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
  assert.ok(Math.abs(await number(page, "apsidal_rotation", "B")) < 1e-10);
  assert.equal(await stretch(page, "B"), 0);
  await set(page, "B", "kappa", "energetic");
  const fault = pane(page, "B").locator(".field", { has: page.locator("[data-pointer='/scheme/kappa']") }).locator(".fault");
  assert.match(await fault.textContent(), /or "energy"/);
  await set(page, "B", "kappa", "");
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
});

pageTest("adaptive steps run", { hash: `${orbit}&B=adaptive_verlet` }, async (page) => {
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
  assert.equal(await page.locator(".fault").count(), 0);
  assert.ok((await drawn(page, plane("B"), "B")).count > 300);
  assert.ok(!(await preset(page, "B").isVisible()));
});
