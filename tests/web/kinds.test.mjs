// Scenes of several bodies: what the names of variables say, and that all bodies are drawn, each at its place.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { drawn, pageTest, pane, plane, settled, statuses } from "./browser.mjs";
import { fieldAt, typedScene } from "./made.mjs";
import { arrangementOf, bodiesOf, drawnOf, kindsOf } from "../../web/catalogue/kinds.js";
import { columns } from "../../web/catalogue/card.js";
import { definitionOf, linked, overrides, startIn, textsOf, unlinked } from "../../web/service/text.js";
import { toHash } from "../../web/service/link.js";

const hashOf = ({ problem, ...scene }) => toHash({ problem: linked(problem), ...scene });
const three = { ...typedScene("figure_eight"), A: { id: "taylor" } }, { x: across, y: up } = three.initial;
const chain = { ...typedScene("toda"), initial: { q: [1, 0.5, -0.5, -1, 0.25, -0.25], p: [0.5, 0, 0, -0.5, 0, 0] }, A: { id: "leapfrog", step: 0.05 } };
const card = (names, more = {}) => ({ form: {}, variables: names.map((name) => ({ name })), invariants: [], columns: [], ...more });
const many = (letter, n) => Array.from({ length: n }, (_, i) => `${letter}[${i + 1}]`);

test("names that differ by an index are of one kind: bodies in the plane, in space, or a chain", () => {
  assert.deepEqual([...kindsOf(card(["x1", "y1", "x2", "y2", "m", "p_1"]))], [["x*", ["x1", "x2"]], ["y*", ["y1", "y2"]]]);
  const arranged = (...names) => arrangementOf(card(names));
  assert.deepEqual(arranged("x1", "y1", "x2", "y2", "px1", "py1", "px2", "py2"), ["x*", "y*"]);
  assert.deepEqual(arranged(...many("x", 2), ...many("y", 2), ...many("z", 2)), ["x*", "y*", "z*"]);
  assert.deepEqual(arranged("x", "y", "z", "px", "py", "pz"), ["x", "y", "z"]);
  assert.deepEqual(arranged(...many("q", 5), ...many("p", 5)), ["index", "q*"]);
  assert.deepEqual(arranged("x1", "x2", "x3", "px1", "px2", "px3", "s"), ["index", "x*"]);
  assert.equal(arranged("theta1", "theta2", "ptheta1", "ptheta2"), null, "two are no chain");
  assert.equal(arranged("x1", "x2", "x3"), null, "nor are the three variables of a flow");
  assert.equal(arrangementOf({ ...card(["x1", "y1", "x2", "y2"]), form: undefined }), null, "scenes of the catalogue stay as they are");
  const kinds = kindsOf(card(["x1", "y1", "x2", "y2"]));
  assert.deepEqual(bodiesOf(["x*", "y*"], kinds), [["x1", "y1"], ["x2", "y2"]]);
  assert.deepEqual(bodiesOf(["t", "x*"], kinds), [["t", "x1"], ["t", "x2"]], "all over time");
  assert.deepEqual(drawnOf(["index", "x*"], kinds), ["x1", "x2"]);
});

test("of very many variables only what is drawn is asked for", () => {
  const names = [...many("q", 100), ...many("p", 100)], crowd = card(names, { columns: ["energy", ...names] });
  assert.equal(columns(crowd, null, drawnOf(["index", "q*"], kindsOf(crowd))).length, 102);
});

const eight = { hash: hashOf(three), reducedMotion: "reduce" };
pageTest("three bodies are drawn in one picture, each in its colour, where it is at a time", eight, async (page) => {
  const boxes = await Promise.all(["A", "B", "C"].map((colour) => drawn(page, plane("A"), colour)));
  assert.ok(boxes.every(({ count }) => count > 30), `${boxes.map(({ count }) => count)}`); // the starts, where the curves cover each other
  assert.ok(!/axes/.test(page.url()), "this is the default");
  await page.locator("#motion .time input").fill("0");
  const at = async (colour) => {
    const { left, right, top, bottom } = await drawn(page, ".pane[data-run=A] canvas.over", colour);
    return [(left + right) / 2, (top + bottom) / 2];
  };
  const [first, second, third] = [await at("A"), await at("B"), await at("C")];
  const scale = (second[0] - third[0]) / across[1];
  assert.ok(scale > 50, `equal scales of ${scale} pixels`);
  const near = (place, x, y) => assert.ok(Math.hypot(place[0] - third[0] - scale * x, place[1] - third[1] + scale * y) < 6, `${place} is (${x}, ${y})`);
  near(first, across[0], up[0]);
  near(second, across[1], up[1]);
});

pageTest("a body's start is dragged alone", eight, async (page) => {
  const { x, y, width, height } = await page.locator(plane("A")).boundingBox();
  await page.locator("#motion .time input").fill("0");
  const { left, right, top, bottom } = await drawn(page, ".pane[data-run=A] canvas.over", "B");
  await page.mouse.move(x + (left + right) / 2, y + (top + bottom) / 2);
  await page.mouse.down();
  await page.mouse.move(x + (left + right) / 2 + 20, y + (top + bottom) / 2 - 20);
  await page.mouse.up();
  await settled(page);
  const value = async (name) => Number(await fieldAt(page, `/initial/${name}`).inputValue());
  assert.ok((await value("x[2]")) > across[1] + 0.02 && (await value("y[2]")) > up[1] + 0.02, `${width} × ${height}`);
  for (const i of [1, 3]) assert.deepEqual([await value(`x[${i}]`), await value(`y[${i}]`)], [across[i - 1], up[i - 1]], `body ${i}`);
});

pageTest("a chain is drawn over its index, and moves", { hash: hashOf(chain), reducedMotion: "reduce" }, async (page) => {
  assert.deepEqual([await page.inputValue("#axes [name=x]"), await page.inputValue("#axes [name=y]")], ["index", "q*"]);
  const over = ".pane[data-run=A] canvas.over";
  await page.locator("#motion .time input").fill("0");
  const whole = await drawn(page, over, "A"), { clientWidth } = await page.locator(over).evaluate((canvas) => ({ clientWidth: canvas.clientWidth }));
  const places = [];
  for (let i = 0; i < 6; i++) { // the disc about each place of the chain
    const at = (whole.left + 5 + ((whole.right - whole.left - 10) * i) / 5) / clientWidth;
    const { top, bottom } = await drawn(page, over, "A", [at - 2 / clientWidth, at + 2 / clientWidth]);
    places.push(-(top + bottom) / 2);
  }
  const rank = (values) => values.map((v) => values.filter((w) => w < v).length);
  assert.deepEqual(rank(places), rank([1, 2, 3, 4, 5, 6].map((i) => chain.initial.q[i - 1])), `${places}`);
  await page.locator("#motion .time input").fill("300");
  assert.notDeepEqual(await drawn(page, over, "A"), whole);
  await page.locator("#motion .time input").fill("1000");
  await page.selectOption("#axes [name=x]", "t");
  await settled(page);
  for (const colour of ["A", "B", "C", "--run-f"]) assert.ok((await drawn(page, plane("A"), colour)).count > 100, `${colour}: each over time`);
  assert.match(page.url(), /axes\.x=t/);
});

const pair = "#problem=custom&problem.variables=x[2],y[2],z[2]&problem.potential=-1/sqrt((x[1]-x[2])^2%2B(y[1]-y[2])^2%2B(z[1]-z[2])^2)" +
  "&initial.x=-1,1&initial.px=0,0&initial.py=0.4,-0.4&initial.pz=0.2,-0.2&until.t=20&A=leapfrog";
pageTest("bodies with a z are drawn in space", { hash: pair, reducedMotion: "reduce" }, async (page) => {
  assert.equal(await page.inputValue("#axes [name=z]"), "z*");
  for (const colour of ["A", "B"]) assert.ok((await drawn(page, plane("A"), colour)).count > 150, colour);
  await page.selectOption("#axes [name=z]", "");
  await settled(page);
  assert.match(page.url(), /axes\.z=(&|$)/, "the link says that there is no third axis");
  await page.reload();
  await settled(page);
  assert.equal(await page.inputValue("#axes [name=z]"), "");
});

pageTest("the spherical pendulum hangs in space", { hash: hashOf(typedScene("spherical_pendulum")), reducedMotion: "reduce" }, async (page) => {
  const look = () => page.locator("#bodies").evaluate((canvas) => canvas.toDataURL());
  const before = await look();
  await page.locator("#motion .time input").fill("300");
  assert.ok(await page.isVisible("#bodies") && (await look()) !== before);
});

const pythagoras = "#problem=custom&problem.variables=x[3],y[3]&problem.parameters=m=[3,4,5]&problem.masses=x=m,y=m" +
  "&problem.definitions=d(i,j)=sqrt((x[i]-x[j])^2%2B(y[i]-y[j])^2)&problem.potential=-sum(i=1..3,j=i%2B1..3,m[i]*m[j]/d(i,j))" +
  "&initial.x=1,-2,1&initial.y=3,-1,-1&until.t=10&A=taylor";
pageTest("lists and definitions stand in texts and links", { hash: pythagoras }, async (page) => {
  assert.equal((await statuses(page))[0], "completed");
  assert.equal(await page.locator("[data-key=parameters] textarea").inputValue(), "m = [3, 4, 5]");
  assert.equal(await fieldAt(page, "/initial/x[2]").inputValue(), "-2");
  assert.equal(await fieldAt(page, "/problem/m[3]").inputValue(), "5");
  await pane(page, "A").locator(".curl summary").click();
  const request = async () => {
    await pane(page, "A").locator(".curl select").selectOption("JSON");
    return JSON.parse(await pane(page, "A").locator(".curl pre").textContent());
  };
  assert.deepEqual((await request()).problem.parameters, { m: [3, 4, 5] });
  assert.ok(!("m[3]" in (await request()).problem), "what is as the text says is not set beside it");
  await page.reload();
  await settled(page);
  assert.equal(await fieldAt(page, "/initial/y[1]").inputValue(), "3");
});

test("texts, requests and links of many of a kind say the same", () => {
  const problem = { variables: ["x[3]"], parameters: { m: [3, 4, 5], k: 1 }, definitions: { "d(i,j)": "atan2(x[i], x[j])" },
                    potential: "sum(i=1..2, d(i,i+1))" };
  const { problem: read, faults } = definitionOf(textsOf(problem));
  assert.deepEqual([read, faults], [{ id: "custom", ...problem }, []]);
  assert.deepEqual(definitionOf(unlinked(linked(read))).problem, read);
  assert.deepEqual(overrides(read, { k: 1, "m[1]": 3, "m[2]": 9 }), { "m[2]": 9 });
  assert.deepEqual(startIn(read, { x: "1,2,3", "px[2]": "4", "px[4]": "1", y: "2" }), { x: [1, 2, 3], "px[2]": 4 });
});
