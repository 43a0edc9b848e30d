// What a scene as text states of its pictures: views, its columns and formulas drawn together, and bodies with their links.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { all, becomes, drawn, frames, pageTest, plane, settled } from "./browser.mjs";
import { typedScene } from "./made.mjs";
import { definitionOf, linked, placeOf, textsOf, unlinked } from "../../web/service/text.js";
import { fitting } from "../../web/drawing/stated.js";
import { indexAt, valueAt } from "../../web/drawing/mapping.js";

const scenes = JSON.parse(readFileSync(new URL("../../web/scenes.json", import.meta.url)));
const pendulum = {
  id: "custom", variables: ["theta"], parameters: { l: 2 }, lagrangian: "l^2*vtheta^2/2 + l*cos(theta)", note: "It swings.",
  views: [["l*sin(theta)", "-l*cos(theta)"], ["theta", "ptheta"], ["t", "l*sin(theta)"]],
  bodies: [{ at: ["l*sin(theta)", "-l*cos(theta)"], linked: ["pivot"] }, { at: ["0", "-l"], kind: "sun" }],
};
const hashOf = (problem, more = "") => `#${new URLSearchParams(Object.entries(linked(problem)).map(([key, value]) => [key === "id" ? "problem" : `problem.${key}`, value]))}${more}`;
const swinging = { hash: hashOf(pendulum, "&initial.theta=1&until.t=20&record.samples=400"), reducedMotion: "reduce" };
const chosen = async (page) => [await all(page, "#axes [name=x]", "selectedOptions.0.textContent"), await all(page, "#axes [name=y]", "selectedOptions.0.textContent")].flat();

test("texts, links and requests hold the same pictures", () => {
  for (const brief of [true, false]) {
    const { problem, faults } = definitionOf(textsOf(pendulum, brief));
    assert.deepEqual([problem, faults], [pendulum, []]);
  }
  assert.deepEqual(definitionOf(unlinked(linked(pendulum))).problem, pendulum);
  assert.equal(definitionOf({ ...textsOf(pendulum), views: "x, y" }).problem.views, "x, y", "the service says what it should be");
  assert.deepEqual(placeOf(textsOf(pendulum), { pointer: "/problem/bodies/0/linked/0" }), { key: "bodies", from: null });
});

test("bodies of all runs are seen whole, and the pivot with them", () => {
  const bodies = [{ at: ["x", "y"], linked: ["pivot"] }, { at: ["x", "3"] }];
  const place = fitting(bodies, [{ trajectory: { x: [1, 5], y: [2, 1] } }, { trajectory: { x: [2, 3], y: [4, 2] } }]);
  for (const point of [[0, 0], [5, 1], [3, 4]]) assert.ok(place(point).every((v) => Math.abs(v) <= 0.9), `${point} at ${place(point)}`);
  const [[a, b], [c, d]] = [place([0, 0]), place([1, 1])];
  assert.ok(Math.abs(c - a - (d - b)) < 1e-12, "of equal scales");
});

test("a run backward in time is where it was at each time", () => {
  const times = [4, 3, 2, 0], values = [0, 10, 20, 40];
  assert.deepEqual([5, 4, 3.5, 2, 1, 0, -1].map((t) => valueAt(times, values, t)), [0, 0, 5, 20, 30, 40, 40]);
  assert.equal(indexAt(times, 2.5), 1);
});

pageTest("the first view is the picture, of equal scales; another is chosen, and links hold it", swinging, async (page, context) => {
  assert.deepEqual(await chosen(page), ["l*sin(theta)", "-l*cos(theta)"]);
  assert.deepEqual(await all(page, "#axes [name=view] option", "textContent"),
                   ["of your own", "-l*cos(theta) over l*sin(theta)", "ptheta over theta", "l*sin(theta) over t"]);
  const { left, right, top, bottom } = await drawn(page, plane("A"), "A"); // an arc of a circle: 2·2·sin 1 wide, 2(1 − cos 1) high
  assert.ok(Math.abs((right - left) / (bottom - top) / (Math.sin(1) * 2 / (1 - Math.cos(1))) - 1) < 0.1, `${right - left} × ${bottom - top}`);
  await page.selectOption("#axes [name=view]", "2");
  await settled(page);
  assert.deepEqual(await chosen(page), ["t", "l*sin(theta)"]);
  assert.ok((await drawn(page, plane("A"), "A")).count > 200);
  const other = await context.newPage();
  await other.goto(page.url());
  await settled(other);
  assert.deepEqual(await chosen(other), ["t", "l*sin(theta)"]);
  assert.equal(await other.inputValue("#axes [name=view]"), "2");
  assert.equal(await other.inputValue("[data-key=note] input"), "It swings.");
  await page.selectOption("#axes [name=x]", "theta");
  await settled(page);
  assert.equal(await page.inputValue("#axes [name=view]"), "", "axes of one's own are no view of the scene");
});

pageTest("bodies are drawn where they are, with what links them, and move", swinging, async (page) => {
  const sun = await drawn(page, "#bodies", "--sun"), { width } = await page.locator("#bodies").evaluate(({ width: w }) => ({ width: w }));
  assert.ok(sun.count > 100 && Math.abs((sun.left + sun.right) / 2 - width / 2) < 5, "below the pivot, which is in the middle");
  const look = () => page.locator("#bodies").evaluate((canvas) => canvas.toDataURL());
  const wind = async (share) => {
    await page.locator("#motion .time input").fill(String(share));
    await frames(page);
    return look();
  };
  const [start, later] = [await wind(0), await wind(200)];
  assert.notEqual(start, later);
  await wind(0);
  const { left, right } = await drawn(page, "#bodies", "A", [0.5, 1]); // at θ = 1, on the right; B covers a part of A
  assert.ok(right > width / 2 + 10, `${left} to ${right}`);
});

pageTest("what is wrong with views and bodies stands at their fields", { ...swinging, expected: /422/ }, async (page) => {
  const field = (key) => page.locator(`[data-key=${key}] :is(textarea, input)`);
  const says = (key) => becomes(() => page.textContent(`#spot-${key}`), Boolean).then(() => page.textContent(`#spot-${key}`));
  await field("views").fill('[["theta", "pteta"]]');
  assert.match(await says("views"), /unknown column or name pteta; did you mean "ptheta"/);
  await field("views").fill("theta over t");
  await becomes(() => page.textContent("#spot-views"), (text) => /must be a list/.test(text));
  await field("views").fill("");
  await field("bodies").fill('[{"at": ["theta", "t"], "linked": [3]}]');
  assert.match(await says("bodies"), /no such body/);
  assert.ok(await field("bodies").evaluate((node) => node.ariaInvalid === "true" || node.hasAttribute("aria-invalid")));
  await field("bodies").fill("");
  await settled(page);
  assert.equal(await page.isVisible("#bodies"), false, "none are stated any more");
});

// What has x, y and z moves in space in the picture itself.
for (const name of [...scenes.filter(({ problem }) => String(problem.variables) !== "x,y,z").map((scene) => scene.name), "restricted_three_body", "spherical_pendulum"]) {
  const { problem, initial } = scenes.find((scene) => scene.name === name) ?? typedScene(name);
  const start = Object.entries(initial).map(([key, value]) => `&initial.${key}=${value}`).join("");
  pageTest(`the example ${name} is seen in motion`, { hash: hashOf(problem, `${start}&until.t=5`), reducedMotion: "reduce" }, async (page) => {
    assert.ok((await drawn(page, "#bodies", "A")).count + (await drawn(page, "#bodies", "B")).count > 60);
  });
}
