// A scene of one's own, typed: what is read of it, what is wrong where, and that everything else works with it.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { all, assertDrawn, becomes, catalogue, drawn, number, options, origin, pageTest, pane, plane, settled, statuses, stepOf } from "./browser.mjs";
import { enter, fieldAt } from "./made.mjs";
import { examplesOf } from "../../web/catalogue/examples.js";
import { definitionOf, entries, linked, placeOf, textsOf, unlinked } from "../../web/service/text.js";

const scenes = JSON.parse(readFileSync(new URL("../../web/scenes.json", import.meta.url)));
const text = (page, key) => page.locator(`[data-key=${key}] :is(textarea, input)`);
const spot = (page, key) => page.locator(`#spot-${key}`);
const marked = (page, key) => spot(page, key).locator("mark").allTextContents();
const well = "#problem=custom&problem.variables=q&problem.parameters=gamma=0.05&problem.lagrangian=v^2/2-(q^2-1)^2/4-gamma*s" +
  "&initial.q=2&until.t=60&record.samples=500&A=contact_splitting&B=contact_leapfrog";
const own = { hash: well };
const refused = { ...own, expected: /status of 422/ };

/** Types texts and waits for what is made of the last of them: what stands there before may be of the first. */
async function type(page, texts, ready = "#results[aria-busy=false]") {
  for (const [key, value] of Object.entries(texts)) {
    if (key === "kind") await page.selectOption("#kind", value);
    else await text(page, key).fill(value);
  }
  await page.waitForSelector("#own[aria-busy=false]");
  await page.waitForSelector(ready);
}
/** Waits until `read()` resolves to `wanted`. */
async function until(read, wanted) {
  for (let i = 0; (await read()) !== wanted; i++) {
    if (i === 1200) assert.equal(await read(), wanted);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

const kepler = { kind: "lagrangian", variables: "x, y", parameters: "mu = 1", formula: "(vx^2 + vy^2)/2 + mu/sqrt(x^2 + y^2)",
                 invariants: "L = x*py - y*px" };

pageTest("it shows what was read of a text, and the link carries the text", own, async (page, context) => {
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
  await assertDrawn(page);
  assert.match(await page.textContent("#form"), /^Contact: linear.*does not keep its energy; \d+ schemes/);
  assert.equal(await page.locator("#as-read math mfrac").count(), 2);
  assert.match(await page.textContent("#as-read"), /γ/);
  assert.match(await page.textContent("#equations"), /dq\/dt = p.*dp\/dt = .*gamma\*p/s);
  await page.click("#derived summary");
  await until(() => page.locator("#equations li math").count().then((n) => n >= 3), true); // q, p and s, each in its lines
  assert.deepEqual(await page.locator("#equations li").evaluateAll((items) => items.map((item) => item.textContent.replace(/[\u2062\s]/g, ""))),
                   ["q˙=p", "p˙=−q3+q−γp", "s˙=0.5p2−0.25(q2−1)2−γs"]);
  assert.ok((await page.locator("#equations msup").count()) >= 3, "powers are typeset");
  await enter(page, "/problem/gamma", "0.2");
  const other = await context.newPage();
  await other.goto(page.url());
  await settled(other);
  assert.equal(other.url(), page.url());
  assert.equal(await text(other, "formula").inputValue(), "v^2/2-(q^2-1)^2/4-gamma*s");
  assert.equal(await text(other, "parameters").inputValue(), "gamma = 0.05");
  assert.equal(await fieldAt(other, "/problem/gamma").inputValue(), "0.2", "what was set beside the text is in the link");
  assert.equal(await number(other, "energy_final", "A"), await number(page, "energy_final", "A"));
});

pageTest("equations that stay in momenta say why", refused, async (page) => {
  assert.equal(await page.textContent("#equations-note"), "");
  await text(page, "formula").fill("v^2/2 + v^4/4 - q^2/2");
  await until(async () => (await page.textContent("#equations-note")).length > 20, true);
  assert.match(await page.textContent("#form"), /^A general Lagrangian/);
});

pageTest("what is typed becomes a scene as good as one of the catalogue", refused, async (page) => {
  const asked = [];
  page.on("request", (request) => request.url().endsWith("simulate") && asked.push(request.postDataJSON()));
  await type(page, kepler, "#parameters [data-name=mu]");
  await settled(page);
  assert.deepEqual(await all(page, "#initial [data-name]", "dataset.name"), ["x", "y", "px", "py", "t"]);
  assert.match(await page.textContent("#form"), /^Separable.*; it keeps its energy/);
  for (const [name, value] of [["x", "0"], ["y", "-4"], ["px", "-0.1"], ["py", "-0.1"]]) await fieldAt(page, `/initial/${name}`).fill(value);
  await pane(page, "A").locator(".scheme").selectOption("leapfrog");
  await enter(page, "/until/t", "20");
  const error = await number(page, "energy", "A");
  assert.ok((await number(page, "L", "A")) < 1e-12, "the invariant of the text is followed");
  const line = await pane(page, "A").locator(".curl pre").textContent();
  const answer = await (await fetch(`${origin}/v1/simulate`, { method: "POST", body: /-d '(.*)'$/.exec(line)[1] })).json();
  assert.equal(answer.diagnostics.energy.max_abs_error, error, "the line for curl makes the same run");
  const { step } = asked.at(-2).scheme;
  const same = { problem: "kepler", scheme: { id: "leapfrog", step }, until: { t: 20 } };
  const known = await (await fetch(`${origin}/v1/simulate`, { method: "POST", body: JSON.stringify(same) })).json();
  assert.ok(Math.abs(error / known.diagnostics.energy.max_abs_error - 1) < 1e-9, "as the problem of the catalogue");

  const track = page.locator("#parameters .sliding", { has: fieldAt(page, "/problem/mu") }).locator("input[type=range]");
  await track.evaluate((node) => {
    node.value = 900;
    for (const kind of ["input", "change"]) node.dispatchEvent(new Event(kind, { bubbles: true }));
  });
  await settled(page);
  const { problem } = asked.at(-1), mu = Number(await fieldAt(page, "/problem/mu").inputValue());
  assert.deepEqual([problem.parameters, problem.mu], [{ mu: 1 }, mu], "a slider moves the parameter, not the text");
  await text(page, "invariants").fill("J = x*py - y*px");
  await page.waitForSelector("#numbers tr[data-row=J]");
  assert.deepEqual([await fieldAt(page, "/problem/mu").inputValue(), await fieldAt(page, "/initial/y").inputValue()], [String(mu), "-4"],
                   "another text keeps what was set");
  await text(page, "parameters").fill("mu = 3");
  await page.waitForURL(/mu=3/);
  await settled(page);
  assert.equal(await fieldAt(page, "/problem/mu").inputValue(), "3", "but not a value that was typed anew");
});

const singular = "#problem=custom&problem.variables=q&problem.lagrangian=(1%2Bq)*v^2/2-q^2/2&initial.q=-1&A=contact_gauss";
pageTest("a text is looked at from the start that is set, and again from another", { hash: singular, expected: /status of 422/ }, async (page) => {
  const asked = [];
  page.on("request", (request) => request.url().endsWith("v1/problems") && asked.push(request.postDataJSON().initial));
  assert.match(await spot(page, "formula").textContent(), /not regular at the start/);
  assert.match(await page.textContent("#form"), /schemes apply/, "it is shown all the same");
  await enter(page, "/initial/q", "0.5");
  await until(() => spot(page, "formula").textContent(), "");
  assert.deepEqual(asked, [{ q: 0.5 }]);
  await settled(page);
  assert.match((await statuses(page)).join(), /completed/);
});

const forAll = { hash: "#problem=custom&problem.variables=q&problem.parameters=k=1&problem.potential=k*q^2/2&problem.k=2&initial.q=1&B=auto" };
pageTest("auto and the studies take it", forAll, async (page) => {
  assert.match(await pane(page, "B").locator(".messages .choice").textContent(), /force/);
  const scene = { id: "custom", variables: ["q"], potential: "k*q^2/2", parameters: { k: 1 }, k: 2 };
  await page.selectOption("#budget", "60"); // it is not over before it is stopped
  for (const [path, button] of [["work-precision", "#measure-precision"], ["stability", "#measure-stability"]]) {
    const [study] = await Promise.all([page.waitForRequest(`**/v1/${path}`), page.click(button)]);
    assert.deepEqual(study.postDataJSON().problem, scene);
    if (path === "work-precision") await page.waitForSelector("#precision-status:text('Measuring')");
  }
  await page.click("#measure-precision");
  await page.waitForSelector("#stability tbody tr");
  assert.ok(Math.abs(Number(await page.locator("#stability tr", { hasText: /^leapfrog/ }).locator("td").first().textContent()) - Math.SQRT2) < 0.01);
});

pageTest("a fault stands under the text at its place, and the rest keeps the last good scene", refused, async (page) => {
  const good = page.url();
  await type(page, { formula: "v^2/2 - (q^2 - 1)^2/4 - gama*s" }, "#spot-formula mark");
  await settled(page);
  assert.deepEqual(await marked(page, "formula"), ["gama"]);
  assert.match(await spot(page, "formula").textContent(), /did you mean "gamma"/);
  assert.equal(await text(page, "formula").getAttribute("aria-invalid"), "true");
  assert.equal(await text(page, "formula").getAttribute("aria-describedby"), "spot-formula");
  await spot(page, "formula").locator("button").click();
  const at = await text(page, "formula").evaluate((node) => [node === document.activeElement, node.selectionStart, node.selectionEnd]);
  assert.deepEqual(at, [true, 24, 28]);
  assert.equal(page.url(), good, "what cannot be read is in no link");
  await enter(page, "/initial/q", "1.5");
  assert.deepEqual(await statuses(page), ["completed", "completed"], "the last good scene still runs");
  assert.match(await pane(page, "A").locator(".curl pre").textContent(), /gamma\*s/);
  assert.deepEqual(await marked(page, "formula"), ["gama"], "and the fault stays");

  await type(page, { formula: "v^2/2 - q^2/2 - gamma*s +" });
  await until(async () => (await marked(page, "formula")).join(), "\u00a0");
  await type(page, { formula: "v^2/2 - q^2/2 - gamma*s", parameters: "gamma = 0.1\n gamma = much" });
  await page.waitForSelector("#spot-parameters mark");
  assert.deepEqual([await marked(page, "formula"), await marked(page, "parameters")], [[], ["gamma"]]);
  assert.match(await spot(page, "parameters").textContent(), /twice/);
  await type(page, { parameters: "gamma = much" });
  await page.waitForSelector("#spot-parameters :text('number')");
  await type(page, { parameters: "gamma = 0.3" });
  await page.waitForURL(/gamma=0.3/);
  await settled(page);
  assert.equal(await page.locator("#own :is(.fault, [aria-invalid])").count(), 0, "what is mended is gone");
  assert.equal(await fieldAt(page, "/initial/q").inputValue(), "1.5");

  await type(page, { kind: "equations", variables: "x, y", formula: "x = y\ny = -x - zz*y", parameters: "" }, "#spot-formula mark");
  await until(async () => (await marked(page, "formula")).join(), "zz");
  await spot(page, "formula").locator("button").click();
  assert.equal(await text(page, "formula").evaluate((node) => node.value.slice(node.selectionStart, node.selectionEnd)), "zz");
  await type(page, { formula: "x = y\ny = -x" });
  await page.waitForSelector("#initial [data-name=y]");
  await settled(page);
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
  assert.match(await page.textContent("#form"), /^Equations of a flow/);
});

const broken = "#problem=custom&problem.variables=q&problem.potential=k*q^2&initial.q=0.7&A=leapfrog&B=runge_kutta_4";
pageTest("a link whose text cannot be read shows the text, and runs when it is mended",
  { hash: broken, ready: "#spot-formula mark", expected: /status of 422/ }, async (page) => {
    assert.ok(!(await page.locator("#results").isVisible()));
    assert.match(await page.textContent("#status"), /cannot be read/);
    await text(page, "parameters").fill("k = 2");
    await settled(page);
    assert.equal(await fieldAt(page, "/initial/q").inputValue(), "0.7");
    assert.equal(await pane(page, "B").locator(".scheme").inputValue(), "runge_kutta_4");
    assert.deepEqual(await statuses(page), ["completed", "completed"]);
  });

pageTest("examples begin with what runs; a start in velocities is one in momenta", { hash: "#problem=custom" }, async (page) => {
  const velocities = scenes.find(({ problem, initial }) => problem.lagrangian && Object.keys(initial).some((name) => /^v/.test(name)));
  for (const [i, { title, problem, initial }] of [scenes[0], velocities].entries()) {
    if (i > 0) await page.selectOption("#example", { label: title });
    await until(() => text(page, "formula").inputValue(), textsOf(problem).formula);
    await page.waitForSelector(`#initial [data-name=${problem.variables[0]}]`);
    await settled(page);
    assert.equal(await page.locator("#example option:checked").textContent(), title);
    for (const [name, value] of i === 0 ? Object.entries(initial) : []) {
      assert.equal(await fieldAt(page, `/initial/${name}`).inputValue(), String(value), name);
    }
    assert.deepEqual(await statuses(page), ["completed"], `${title}: one run, nobody asked for a second like it`);
    assert.ok(!(await page.locator(".pane .remove").isVisible()));
    assert.ok((await drawn(page, plane("A"), "A")).count > 100, title);
    assert.deepEqual(await all(page, "#parameters [data-name]", "dataset.name"), Object.keys(problem.parameters ?? {}));
  }
  await page.selectOption("#example", { label: "Duffing's oscillator" });
  await until(() => page.url().includes("Duffing"), true);
  await page.selectOption("#example", { label: "Blank: a free particle" });
  await until(() => text(page, "formula").inputValue(), "vx^2/2");
  await page.waitForSelector("#initial [data-name=px]");
  await settled(page);
  assert.deepEqual(await statuses(page), ["completed"]);
  assert.deepEqual([await text(page, "title").inputValue(), await text(page, "note").inputValue(), await page.textContent("#example-note")], ["", "", ""]);
  assert.doesNotMatch(page.url(), /Duffing|title|note/, "what was there before has left nothing");
  await page.evaluate((scene) => (location.hash = scene),
                      "#problem=custom&problem.variables=r,phi&problem.lagrangian=(vr^2%2Br^2*vphi^2)/2%2B1/r&initial.r=2&initial.vphi=0.5");
  await page.waitForSelector("#initial [data-name=pphi]");
  assert.equal(await fieldAt(page, "/initial/pphi").inputValue(), "2", "p = r² · vphi");
});

const central = "#problem=custom&problem.variables=x,y&problem.lagrangian=(vx^2%2Bvy^2)/2%2B1/sqrt(x^2%2By^2)";
pageTest("a coordinate that is singular at 0 starts at 1; a start that is refused is told at its field", { hash: central, expected: /status of 422/ }, async (page) => {
  assert.deepEqual(await Promise.all(["x", "y"].map((name) => fieldAt(page, `/initial/${name}`).inputValue())), ["1", "0"]);
  assert.deepEqual(await statuses(page), ["completed"]);
  assert.ok(!/initial/.test(page.url()), "which is no choice of the reader's");
  await enter(page, "/initial/x", "0");
  assert.equal(await fieldAt(page, "/initial/x").getAttribute("aria-invalid"), "true");
  assert.match(await page.locator("#initial .fault").textContent(), /not finite at the start/);
  await page.focus("#go");
  await pane(page, "A").locator(".messages button").click();
  const focused = () => page.evaluate(() => document.activeElement.dataset.pointer);
  assert.equal(await focused(), "/initial/x", "and is led to");
  await page.focus("#go");
  await page.click("#go");
  await settled(page);
  await becomes(focused, (pointer) => pointer === "/initial/x");
  await enter(page, "/initial/x", "2");
  assert.deepEqual(await statuses(page), ["completed"]);
});

pageTest("a problem of the catalogue that is a text is an example, too", { hash: "#problem=custom" }, async (page) => {
  await page.selectOption("#example", "Three bodies on a figure eight");
  await page.waitForSelector("#initial [data-name='x[3]']");
  await settled(page);
  assert.match(await text(page, "formula").inputValue(), /^-sum\(i=1\.\.3/);
  assert.equal(await page.locator("#example option:checked").textContent(), "Three bodies on a figure eight");
  assert.match(await page.textContent("#example-note"), /^Three equal masses.*Chenciner/);
  assert.deepEqual([await fieldAt(page, "/initial/x[2]").inputValue(), await fieldAt(page, "/until/t").inputValue()], ["1", "6.3259139829"]);
  assert.equal(await stepOf(page, "A").inputValue(), "0.01", "as the catalogue suggests it");
  await page.selectOption("#example", "Toda lattice"); // without parameters
  await page.waitForSelector("#initial [data-name='q[6]']");
  await settled(page);
  assert.equal(await page.locator("#example option:checked").textContent(), "Toda lattice");
  assert.equal(await stepOf(page, "A").inputValue(), "0.02");
  const named = examplesOf(catalogue.problems).map(({ name }) => name);
  assert.ok(named.length > 10 && !named.includes("bouncing_ball") && !named.some((name) => scenes.some((one) => one.name === name)), "each stands once");
});

test("every example can be read", options, async () => {
  for (const { title, problem } of [...scenes, ...examplesOf(catalogue.problems)]) {
    const response = await fetch(`${origin}/v1/problems`, { method: "POST", body: JSON.stringify({ problem }) });
    assert.equal(response.status, 200, `${title}: ${await response.text()}`);
  }
});

pageTest("back goes over what was typed at once, and to the problem before", { hash: "#problem=kepler&until.t=20" }, async (page) => {
  const { formula } = textsOf(scenes[0].problem);
  await page.selectOption("#problem", "custom");
  await page.waitForSelector("#own[open]");
  await settled(page);
  for (const k of [1, 2]) {
    await text(page, "formula").fill(`${formula} + 0*${k}`);
    await page.waitForURL(new RegExp(`0\\*${k}`));
    await settled(page);
  }
  await page.goBack();
  await until(() => text(page, "formula").inputValue(), formula);
  await page.goBack(); // before that is read
  await until(() => page.inputValue("#problem"), "kepler");
  await settled(page);
  assert.ok(!(await page.locator("#own").isVisible()));
  await page.selectOption("#problem", "custom");
  await page.waitForSelector("#own");
  await settled(page);
  assert.ok((await text(page, "formula").inputValue()).startsWith(formula), "the scene that was typed comes back");
});

const hostile = `<math><mi>L</mi><mo onclick="alert(1)">=</mo><mtext><img src="x" onerror="alert(1)"/></mtext><annotation-xml encoding="text/html">
  <script>alert(1)</script></annotation-xml><mi href="javascript:alert(1)" style="color:red">q</mi><a href="https://example.org">there</a></math>`;
const answering = (opened) => opened.route("**/v1/problems", async (route) => {
  const response = await route.fetch(), card = await response.json();
  return route.fulfill({ json: { ...card, formula: hostile, equations: { "<b>q</b>": "<img src=x>" } } });
});
pageTest("of a formula only what is known gets into the page, and a text never ends a program",
  { ...own, prepare: answering }, async (page) => {
    const inside = await page.locator("#found *").evaluateAll((found) =>
      found.map((node) => [node.localName, ...node.getAttributeNames()].join(" ")));
    const known = /^(math display|mi|mo|mtext|div( id| role| aria-label| data-text-label| tabindex)+|p id( role aria-live)?|details id|summary data-text|ul id tabindex|li|code)$/;
    assert.ok(inside.includes("mi") && inside.every((node) => known.test(node)), inside.join(", "));
    assert.match(await page.textContent("#equations"), /<img src=x>/, "as text");
    await text(page, "title").fill("it's '''quoted'''\"\\");
    await page.waitForURL(/quoted/);
    await settled(page);
    await pane(page, "A").locator(".curl summary").click();
    await pane(page, "A").locator(".curl select").selectOption("Python");
    const program = await pane(page, "A").locator(".curl pre").textContent(), [, json, ...rest] = program.split("'''");
    assert.equal(JSON.parse(json).problem.title, "it's '''quoted'''\"\\");
    assert.equal(rest.length, 1);
  });

const narrow = { ...refused, viewport: { width: 360, height: 740 }, colorScheme: "dark" };
pageTest("on a telephone the text fits, every field has its name, and keys reach them", narrow, async (page) => {
  await page.selectOption("#kind", "potential");
  await page.waitForSelector("[data-key=masses]");
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 360);
  const named = await page.locator("#own :is(input, select, textarea)").evaluateAll((found) =>
    found.map((node) => node.labels[0]?.textContent.trim() ?? ""));
  assert.ok(named.every((name) => name.length > 2), named.join(" | "));
  assert.match(named.join(" | "), /V\(q, t\) =.*Masses.*Damping/);
  await page.focus("#example");
  const reached = [];
  for (let i = 0; i < 4; i++) {
    await page.keyboard.press("Tab");
    reached.push(await page.evaluate(() => document.activeElement.closest("[data-key]")?.dataset.key ?? document.activeElement.id));
  }
  assert.deepEqual(reached.slice(0, 3), ["kind", "variables", "formula"]);
});

/** Answers for columns of one's own: r and its like are the distance from the origin, what knows no name is refused. */
const measured = (asked) => (opened) => opened.route("**/v1/simulate", async (route) => {
  const request = route.request().postDataJSON(), mine = request.columns.filter((column) => column.expression);
  asked.push(mine);
  const at = request.columns.findIndex((column) => /zz/.test(column.expression));
  const errors = [{ pointer: `/columns/${at}/expression`, position: 0, detail: "nobody knows the name zz" }];
  if (at >= 0) return route.fulfill({ status: 422, contentType: "application/problem+json", json: { status: 422, errors } });
  const known = { ...request, columns: request.columns.filter((column) => !column.expression) };
  const headers = { ...route.request().headers(), accept: "application/json" };
  const answer = await (await route.fetch({ headers, postData: JSON.stringify(known) })).json();
  const { x, y } = answer.trajectory;
  for (const { name } of mine) answer.trajectory[name] = x.map((v, i) => Math.hypot(v, y[i]));
  return route.fulfill({ json: answer });
});
const columns = [];
const ownColumns = { prepare: measured(columns), expected: /status of 422/ };
pageTest("columns of one's own are asked for, stand on the axes and in the link", ownColumns, async (page) => {
  await enter(page, "/columns/more", "r = sqrt(x^2 + y^2), d = 2*x");
  assert.deepEqual(columns.at(-1), [{ name: "r", expression: "sqrt(x^2 + y^2)" }, { name: "d", expression: "2*x" }]);
  await page.selectOption("#axes [name=x]", "t");
  await page.selectOption("#axes [name=y]", "r");
  await settled(page);
  assert.match(await page.getAttribute(plane("A"), "aria-label"), /^r over t of run A/);
  assert.ok((await drawn(page, plane("A"), "A")).count > 100);
  assert.match(page.url(), /columns\.more=r\+=\+sqrt\(x%5E2/);
  await enter(page, "/columns/more", "r = zz");
  assert.equal(await fieldAt(page, "/columns/more").getAttribute("aria-invalid"), "true", "a fault stands at the field");
  assert.match(await page.locator("#columns .fault").textContent(), /zz/);
});

test("texts, requests and links say the same", () => {
  for (const { problem } of scenes) {
    const { problem: read, faults } = definitionOf(textsOf(problem));
    assert.deepEqual(faults, []);
    assert.deepEqual(read, { id: "custom", ...problem });
    assert.deepEqual(definitionOf(unlinked(linked(read))).problem, read);
  }
  const texts = { kind: "potential", variables: "x,  yy", parameters: "a = 1; b=2", formula: "  a + b", masses: "" };
  assert.deepEqual(placeOf(texts, { pointer: "/problem/potential", position: 4 }), { key: "formula", from: 6, to: 7 });
  assert.deepEqual(placeOf(texts, { pointer: "/problem/variables/1", position: 0 }), { key: "variables", from: 4, to: 6 });
  assert.deepEqual(placeOf(texts, { pointer: "/problem/parameters/b" }), { key: "parameters", from: 7, to: 8 });
  assert.equal(placeOf(texts, { pointer: "/initial/x" }), null);
  assert.deepEqual(entries("x = a = b").map(({ value }) => value), ["a = b"]);
});
