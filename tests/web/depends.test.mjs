// What the end of a run depends on: the derivatives that the page tells are true, and the fan shows what they predict.
import assert from "node:assert/strict";
import { all, becomes, drawn, pageTest } from "./browser.mjs";
import { enter, fieldAt } from "./made.mjs";

const said = (page) => page.textContent("#tangent-status");
async function differentiate(page, pattern) {
  const [question] = await Promise.all([page.waitForRequest("**/v1/simulate"), page.click("#measure-tangent")]);
  await becomes(() => said(page), (text) => pattern.test(text));
  return question.postDataJSON();
}
/** The table by rows: `{name: [numbers]}`. */
const table = async (page) => Object.fromEntries((await page.locator("#derivatives tbody tr").evaluateAll((rows) => rows.map((row) => (
  [row.cells[0].textContent, [...row.cells].slice(1).map((cell) => Number(cell.textContent.replace("−", "-").replace("–", "NaN")))])))));
const near = (found, wanted, what) => assert.ok(Math.abs(found - wanted) <= 0.006 * Math.max(Math.abs(wanted), 0.1), `${what}: ${found}, not ${wanted}`);

// q = cos ωt, p = −mω sin ωt from (1, 0), ω² = k/m.
const swing = (m, k, t) => ({ q: Math.cos(Math.sqrt(k / m) * t), p: -Math.sqrt(k * m) * Math.sin(Math.sqrt(k / m) * t) });
const spring = "#problem=harmonic_oscillator&initial.q=1&until.t=2&A=taylor&tangent.vary=stiffness&tangent.shift=0.2&tangent.count=2&tangent.y=q";
pageTest("derivatives of the motion as a table, and neighbours beside what they predict", { hash: spring }, async (page, context) => {
  const { sensitivities, scheme } = await differentiate(page, /neighbour/);
  assert.deepEqual([sensitivities.by, sensitivities.at, scheme.id], [["/initial/q", "/initial/p", "/problem/mass", "/problem/stiffness"], "samples", "taylor"]);
  const found = await table(page), by = (name, d) => (swing(...(name === "mass" ? [1 + d, 1] : [1, 1 + d]), 2));
  assert.deepEqual(await all(page, "#derivatives thead th", "textContent"), ["∂ end / ∂", "q", "p", "mass", "stiffness"]);
  for (const [row, of] of [["q", (end) => end.q], ["p", (end) => end.p]]) {
    const slope = (name) => (of(by(name, 1e-5)) - of(by(name, -1e-5))) / 2e-5;
    const wanted = [...(row === "q" ? [Math.cos(2), Math.sin(2)] : [-Math.sin(2), Math.cos(2)]), slope("mass"), slope("stiffness")];
    wanted.forEach((value, i) => near(found[row][i], value, `d${row} by the ${i}th`));
  }
  const text = await said(page), end = swing(1, 1, 2), less = swing(1, 0.8, 2), distance = (a, b) => Math.hypot(a.q - b.q, a.p - b.p);
  const slope = (of) => (of(by("stiffness", 1e-5)) - of(by("stiffness", -1e-5))) / 2e-5;
  const told = { q: end.q - 0.2 * slope((at) => at.q), p: end.p - 0.2 * slope((at) => at.p) };
  const [, apart, missed] = /ends (\S+) from the run, (\S+) from where/.exec(text);
  near(Number(apart), distance(less, end), "the neighbour");
  near(Number(missed), distance(less, told), "what the tangent misses");
  assert.match(text, /of the motion with taylor.*differs by (0|\d\.\d·10⁻¹.) of/);
  const picture = "#tangent canvas.plane";
  for (const colour of ["--run-a", "--run-b", "--run-c"]) assert.ok((await drawn(page, picture, colour)).count > 300, colour);
  assert.match(await page.textContent("#tangent figcaption"), /stiffness from 0\.8 to 1\.2/);
  const other = await context.newPage();
  await other.goto(page.url());
  await becomes(() => other.inputValue("#tangent [data-name=vary]"), (value) => value === "stiffness");
  await enter(page, "/initial/q", "1.5");
  assert.ok(!(await page.isVisible(picture)) && (await page.locator("#derivatives tr").count()) === 0, "another run depends otherwise");
});

pageTest("of a fixed step the derivative is that of the scheme's own map, at its steps", { hash: "#problem=harmonic_oscillator&until.t=8&A=leapfrog&A.step=1" },
  async (page) => {
    const { record } = await differentiate(page, /own map/);
    assert.deepEqual(record, { every: 1 });
    const step = ([q, p]) => { // leapfrog, h = 1
      const half = p - q / 2, there = q + half;
      return [there, half - there / 2];
    };
    const end = Array.from({ length: 8 }).reduce(step, [1, 0]), { q, p } = await table(page);
    near(q[0], end[0], "∂q/∂q");
    near(p[0], end[1], "∂p/∂q");
    assert.ok(Math.abs(q[0] - Math.cos(8)) > 0.1, "which at such steps is not that of the motion");
    await page.selectOption("#tangent [data-name=of]", "motion");
    await differentiate(page, /of the motion/);
    near((await table(page)).q[0], Math.cos(8), "∂q/∂q of the motion");
  });

pageTest("what is refused is told in the service's words, at its pointer", { hash: "#problem=van_der_pol&A=contact_splitting", expected: /status of 422/ }, async (page) => {
  await page.selectOption("#tangent [data-name=of]", "scheme");
  await differentiate(page, /\//);
  assert.match(await said(page), /^\/sensitivities\/of: of the map of contact_splitting on this scene there is no derivative; allowed: motion$/);
  assert.match(await page.getAttribute("#tangent-status", "class"), /fault/);
});

const typed = "#problem=custom&problem.variables=x%5B2%5D&problem.parameters=m=[1,2],k=1&problem.masses=x=m&problem.potential=k*(x%5B1%5D-x%5B2%5D)%5E2" +
  "&initial.x%5B1%5D=1&until.t=4&A=taylor&events.more=meet=x%5B1%5D-x%5B2%5D&tangent.vary=m%5B2%5D&tangent.count=2";
pageTest("of a scene as text: entries of lists, and the times of its events", { hash: typed }, async (page) => {
  const requests = [];
  page.on("request", (request) => request.url().endsWith("/v1/simulate") && requests.push(request.postDataJSON()));
  const { sensitivities } = await differentiate(page, /neighbour/);
  assert.deepEqual(sensitivities.by, ["/initial/x[1]", "/initial/x[2]", "/initial/px[1]", "/initial/px[2]", "/problem/k", "/problem/m/0", "/problem/m/1"]);
  assert.deepEqual(requests.slice(1).map(({ problem }) => problem["m[2]"] > 2), [false, true], "a neighbour on each side");
  // They meet where cos ωt = 0, ω² = 2k(1/m₁ + 1/m₂) = 3: ∂t/∂k = −t/2k, ∂t/∂m₂ = −(t/ω) ∂ω/∂m₂ = t/12.
  const found = await table(page), t = Math.PI / 2 / Math.sqrt(3);
  near(found["t of meet 1"][4], -t / 2, "∂t/∂k");
  near(found["t of meet 1"][6], t / 12, "∂t/∂m₂");
  near(found["t of meet 2"][4], -1.5 * t, "∂t₂/∂k");
  assert.equal(await fieldAt(page, "/tangent/shift").inputValue(), "", "the neighbours' distance is chosen");
});

// From q = 1.2 the spring is at 1.2 cos t, and the prediction is exact: at the start the colour of the upper neighbours
// is seen at one height only.
pageTest("what is predicted lies on the neighbours where the motion is linear", { hash: spring.replace(/&tangent.*/, "&tangent.shift=0.2&tangent.count=2&tangent.y=q") }, async (page) => {
  await differentiate(page, /neighbour/);
  const [, apart, missed] = /ends (\S+) from the run, (\S+) from where/.exec(await said(page));
  near(Number(apart), 0.2, "the neighbour");
  assert.ok(Number(missed.replace(/·10⁻.*/, "e-9")) < 1e-6, missed);
  const all = await drawn(page, "#tangent canvas.plane", "--run-c"), first = await drawn(page, "#tangent canvas.plane", "--run-c", [0, 0.2]);
  assert.ok(first.count > 20 && first.bottom - first.top < 0.15 * (all.bottom - all.top), JSON.stringify([first, all]));
});

const narrow = { hash: spring, viewport: { width: 360, height: 740 } };
pageTest("the table scrolls by itself on a telephone", narrow, async (page) => {
  await differentiate(page, /neighbour/);
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 360);
});

// Let go at rest, a body falls into the centre; the derivatives are those of free fall along its last samples.
pageTest("of a run that stops the derivatives are those of the last sample that they reach",
  { hash: "#problem=kepler&initial.x=1&initial.y=0&initial.px=0&initial.py=0&until.t=5&A=taylor&tangent.count=2&tangent.vary=x" }, async (page) => {
    await differentiate(page, /^Derivatives of the motion with taylor.*at t = 1\.1/);
    const { x } = await table(page);
    assert.ok(x[0] > 1, `a body let go farther out is farther out: ${x[0]}`);
    assert.ok((await drawn(page, "#tangent canvas.plane", "--run-a")).count > 100);
  });
