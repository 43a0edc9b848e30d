// The workbench as hands use it: runs added and laid over each other, sliders, a start that is dragged, ways back, files.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { all, becomes, drawn, number, origin, pageTest, pane, plane, settled, statuses, stepOf } from "./browser.mjs";
import { enter, fieldAt } from "./made.mjs";
import { energyOf } from "../../web/drawing/bars.js";

const loaded = (page, id) => page.waitForFunction((wanted) => document.querySelector("#problem").value === wanted, id)
  .catch(() => {}).then(() => settled(page));
const whole = "#all-runs";

const swing = { hash: "#problem=harmonic_oscillator" };
pageTest("up to six runs, apart or in one picture, and the link holds them", swing, async (page, context) => {
  await pane(page, "B").locator(".scheme").selectOption("symplectic_euler");
  await settled(page);
  for (const name of ["C", "D", "E", "F"]) {
    await page.click("#add");
    await settled(page);
    assert.equal(await pane(page, name).locator(".scheme").inputValue(), "symplectic_euler", "like the last one");
  }
  assert.ok(await page.isDisabled("#add"));
  assert.equal((await statuses(page)).length, 6);
  for (const name of ["D", "E", "F"]) await pane(page, name).locator(".remove").click();
  await settled(page);
  await pane(page, "C").locator(".scheme").selectOption("explicit_euler");
  await settled(page);
  await page.check("#together");
  assert.ok(!(await page.locator(plane("A")).isVisible()));
  for (const run of ["--run-a", "--run-c"]) assert.ok((await drawn(page, whole, run)).count > 100, run);
  const other = await context.newPage();
  await other.goto(page.url());
  await settled(other);
  assert.ok((await drawn(other, whole, "--run-c")).count > 100);
  assert.deepEqual(await all(other, ".pane .scheme", "value"), ["leapfrog", "symplectic_euler", "explicit_euler"]);
});

pageTest("links leave defaults out", {}, async (page) => {
  assert.equal(new URL(page.url()).hash, "#problem=kepler&until.t=20&A=leapfrog&B=leapfrog");
  await enter(page, "/initial/y", "-3");
  assert.equal(new URL(page.url()).hash, "#problem=kepler&initial.y=-3&until.t=20&A=leapfrog&B=leapfrog");
});

pageTest("back undoes, also across problems, and what was set comes back with a problem", {}, async (page) => {
  await enter(page, "/initial/y", "-3");
  await page.selectOption("#problem", "pendulum");
  await settled(page);
  await page.selectOption("#problem", "kepler");
  await settled(page);
  assert.equal(await fieldAt(page, "/initial/y").inputValue(), "-3", "as it was left");
  await page.goBack();
  await settled(page);
  assert.equal(await page.inputValue("#problem"), "pendulum");
  await page.goBack();
  await settled(page);
  await page.goBack();
  await settled(page);
  assert.equal(await page.inputValue("#problem"), "kepler");
  assert.equal(await fieldAt(page, "/initial/y").inputValue(), "-4");
});

pageTest("a link that cannot be read is said", { hash: "#problem=keplr&colour=red" }, async (page) => {
  assert.match(await page.textContent("#notice"), /problem=keplr, colour means nothing/);
});

pageTest("a slider moves its number, with few points while the hand is on it", { hash: "#problem=kepler&until.t=95" }, async (page) => {
  const asked = [];
  page.on("request", (request) => request.url().endsWith("simulate") && asked.push(request.postDataJSON()));
  const track = page.locator("#initial .sliding", { has: fieldAt(page, "/initial/y") }).locator("input[type=range]");
  await track.evaluate((node) => {
    node.value = 300;
    node.dispatchEvent(new Event("input", { bubbles: true }));
  });
  await settled(page);
  const value = Number(await fieldAt(page, "/initial/y").inputValue());
  assert.ok(value < -2.5 && value > -4 && asked.at(-1).initial.y === value, `${value}`);
  const points = ({ record, scheme }) => record.samples ?? record.curve ?? 95 / scheme.step / record.every;
  assert.ok(asked.every((request) => points(request) <= 801));
  await track.dispatchEvent("change");
  await settled(page);
  assert.ok(points(asked.at(-1)) >= 4000, "all of them in the end");
});

pageTest("the start is dragged in the picture", { hash: "#problem=pendulum&until.t=20" }, async (page) => {
  const { x, y, width, height } = await page.locator(plane("A")).boundingBox();
  const seen = await drawn(page, plane("A"), "A");
  const at = { x: x + seen.right - 4, y: y + (seen.top + seen.bottom) / 2 }; // q = 1.5, p = 0
  await page.mouse.move(at.x, at.y);
  await page.mouse.down();
  for (let i = 1; i <= 5; i++) await page.mouse.move(at.x - i * 8, at.y - i * 6);
  await page.mouse.up();
  await settled(page);
  const [q, p] = [Number(await fieldAt(page, "/initial/q").inputValue()), Number(await fieldAt(page, "/initial/p").inputValue())];
  assert.ok(q > 1 && q < 1.4 && p > 0.1 && p < 0.6, `${q}, ${p}; ${width} × ${height}`);
  assert.match(page.url(), new RegExp(`initial.q=${q}`));
});

pageTest("an orbit that is accurate is drawn accurately: even where it is fast",
  { hash: "#problem=kepler&until.t=950&A=leapfrog&A.step=0.0005&A.composition=kahan_li_6&B=leapfrog" }, async (page) => {
    const request = JSON.parse(await asJson(page, "A"));
    assert.ok(request.record.curve > 1000);
    const { left, right, count } = await drawn(page, plane("A"), "A");
    const { width } = await page.locator(plane("A")).boundingBox();
    assert.ok(right - left < 0.4 * width && count < 6000, `one thin ellipse after fifty revolutions: ${count} pixels`);
  });

/** The request of a run as the page tells it. */
async function asJson(page, run) {
  await pane(page, run).locator(".curl summary").click();
  await pane(page, run).locator(".curl select").selectOption("JSON");
  return pane(page, run).locator(".curl pre").textContent();
}

pageTest("the mode of a hybrid stands on an axis, 0 in time and 1 in a coordinate; of other schemes there is none",
  { hash: "#problem=kepler&until.t=20&B=jacobi_maupertuis&axes.x=t&axes.y=mode" }, async (page) => {
    const hybrid = await drawn(page, plane("B"), "B");
    assert.ok(hybrid.count > 100 && hybrid.bottom - hybrid.top > 100, `it goes up and down: ${JSON.stringify(hybrid)}`);
    assert.equal((await drawn(page, plane("A"), "A")).count, 0);
  });

pageTest("any column over any other, on logarithmic axes, enlarged and whole again", {}, async (page) => {
  await page.selectOption("#axes [name=y]", "error_of_energy");
  await page.selectOption("#axes [name=x]", "step_size");
  await settled(page);
  await page.selectOption("#axes [name=x]", "t");
  await page.check("#axes [name=logy]");
  await settled(page);
  assert.match(await page.getAttribute(plane("A"), "aria-label"), /H₀.* over t of run A/);
  assert.match(page.url(), /axes.x=t&axes.y=error_of_energy&axes.log=y/);
  const before = await drawn(page, plane("A"), "A");
  assert.ok(before.bottom - before.top > 100);
  const look = () => page.locator(plane("A")).evaluate((canvas) => canvas.toDataURL());
  const small = await look();
  await pane(page, "A").locator(".lens button").first().click();
  assert.notEqual(await look(), small);
  await pane(page, "A").locator(".lens button").last().click();
  assert.equal(await look(), small);
});

pageTest("equal work for all runs, and on from the end", {}, async (page) => {
  await pane(page, "B").locator(".scheme").selectOption("runge_kutta_4");
  await settled(page);
  assert.ok((await number(page, "force_evaluations", "B")) > 7 * (await number(page, "force_evaluations", "A")));
  await page.click("#even");
  await settled(page);
  const [a, b] = [await number(page, "force_evaluations", "A"), await number(page, "force_evaluations", "B")];
  assert.deepEqual(await all(page, "figcaption .work", "textContent"), [a, b].map((n) => `${n.toLocaleString("en").replaceAll(",", "\u202f")} force evaluations`));
  assert.ok(Math.abs(b / a - 1) < 0.01 && Math.abs(Number(await stepOf(page, "B").inputValue()) - 0.04) < 1e-4, `${a}, ${b}`);
  await page.click("#continue");
  await settled(page);
  assert.equal(await fieldAt(page, "/initial/t").inputValue(), "20");
  assert.equal(await fieldAt(page, "/until/t").inputValue(), "40", "for as long again");
  assert.equal((await statuses(page))[0], "completed");
});

pageTest("a service that is gone is asked again until it answers", { expected: /ERR_CONNECTION_REFUSED/ }, async (page) => {
  let gone = true;
  await page.route("**/v1/simulate", (route) => (gone ? route.abort("connectionrefused") : route.fallback()));
  await page.click("#go");
  await settled(page);
  assert.match(await page.textContent("#status"), /does not answer/);
  assert.ok((await drawn(page, plane("A"), "A")).count > 50, "the last picture stays");
  gone = false;
  await page.locator("#status", { hasText: "A completed" }).waitFor();
});

pageTest("runs are taken away as Python, JSON, a table and pictures", {}, async (page) => {
  await enter(page, "/until/t", "9");
  const request = JSON.parse(await asJson(page, "A"));
  assert.equal((await (await fetch(`${origin}/v1/simulate`, { method: "POST", body: JSON.stringify(request) })).json()).status, "completed");
  await pane(page, "A").locator(".curl select").selectOption("Python");
  const program = await pane(page, "A").locator(".curl pre").textContent();
  const python = (text) => {
    try {
      return execFileSync("python3", ["-c", text.replace("import numpy", "class numpy: array = list")], { stdio: "pipe" }).toString();
    } catch (error) {
      return error.stderr.toString();
    }
  };
  assert.match(python(program), /^completed 901 force evaluations/);
  assert.match(python(program.replace('"step":0.01', '"step":-1')), /\/scheme\/step: must be/, "raises with the service's own faults");
  const taken = async (kind) => {
    const coming = page.waitForEvent("download", (file) => file.suggestedFilename().endsWith(kind.toLowerCase()));
    await page.locator("#take button", { hasText: kind }).click();
    const file = await coming;
    return [file.suggestedFilename(), readFileSync(await file.path())];
  };
  const [name, table] = await taken("CSV"), lines = table.toString().trim().split("\n");
  assert.deepEqual([name, lines[0], lines[1]], ["kepler-problem.csv", "run,t,x,y,px,py,energy", "A,0,0,-4,-0.1,-0.1,-0.24"]);
  assert.equal(lines.length, 1 + 901 + 1801);
  const [picture, png] = await taken("PNG"), { clientWidth } = await page.locator(plane("A")).evaluate((canvas) => ({ clientWidth: canvas.clientWidth }));
  assert.match(picture, /^kepler-problem-[AB]\.png$/);
  assert.deepEqual([png.subarray(1, 4).toString(), png.readUInt32BE(16)], ["PNG", 3 * clientWidth], "three times as fine as the screen");
  const [, svg] = await taken("SVG");
  assert.ok(/^<svg [^]*<path d="M[^"]{200,}" fill="none" stroke="#d55e00"[^]*<\/svg>\n$/.test(svg.toString()));
});

pageTest("the scene moves: its body, and the time by hand", { hash: "#problem=double_pendulum", reducedMotion: "reduce" }, async (page) => {
  const body = () => page.locator("#bodies").evaluate((canvas) => canvas.toDataURL());
  const first = await body();
  await page.locator("#motion .time input").fill("200");
  assert.notEqual(await body(), first);
  assert.equal(await page.textContent("#motion output"), "t = 10");
  await page.click("#motion .play");
  await becomes(() => page.textContent("#motion output"), (text) => parseFloat(text.slice(4)) > 10);
});

pageTest("what does not apply is not claimed: no contact structure of a flow; formulas are whole", { hash: "#problem=lorenz" }, async (page) => {
  await loaded(page, "lorenz");
  assert.doesNotMatch(await pane(page, "A").locator(".traits").textContent(), /contact/);
  assert.equal(await page.locator("#formula math").count(), 3);
  assert.ok(await page.locator("#formula").evaluate((box) => box.scrollWidth <= box.clientWidth));
  await page.selectOption("#problem", "double_pendulum");
  await settled(page);
  assert.ok(await page.locator("#formula").evaluate((box) => box.scrollWidth <= box.clientWidth));
  await page.selectOption("#problem", "damped_kepler");
  await settled(page);
  assert.match(await page.locator("#summary").innerHTML(), /e<sup>−αt<\/sup>/);
});

/** Bytes of each frame of a WebM: of its groups of blocks and simple blocks, in the clusters of its segment. */
function frameSizes(bytes) {
  const sizes = [], number = (at, marked) => {
    const length = Math.clz32(bytes[at]) - 23; // leading zeros of the first byte say how many bytes follow it
    let value = marked ? bytes[at] : bytes[at] & (0xff >> length);
    for (let k = 1; k < length; k++) value = value * 256 + bytes[at + k];
    return { value, end: at + length };
  };
  for (let at = 0; at < bytes.length;) {
    const id = number(at, true), size = number(id.end, false);
    if (id.value === 0xa0 || id.value === 0xa3) sizes.push(size.value);
    at = id.value === 0x18538067 || id.value === 0x1f43b675 ? size.end : size.end + size.value;
  }
  return sizes;
}

pageTest("what plays is taken away as a film", { hash: `${swing.hash}&until.t=90`, reducedMotion: "reduce" }, async (page) => {
  await page.selectOption("#motion .player select", "4");
  const film = page.locator("#take button", { hasText: "WebM" }), coming = page.waitForEvent("download");
  await film.click();
  assert.equal(await page.locator("#take button", { hasText: "Stop filming" }).count(), 1);
  await becomes(() => page.textContent("#motion output"), (text) => parseFloat(text.slice(4)) > 30);
  await page.locator("#take button", { hasText: "Stop filming" }).click();
  const file = await coming, bytes = readFileSync(await file.path());
  assert.equal(file.suggestedFilename(), "harmonic-oscillator.webm");
  assert.deepEqual([...bytes.subarray(0, 4)], [0x1a, 0x45, 0xdf, 0xa3], "it is Matroska");
  const size = (id) => bytes.readUInt16BE(bytes.indexOf(Buffer.from([id, 0x82])) + 2); // an element of two bytes
  const { width, height } = await page.locator(plane("A")).evaluate((canvas) => ({ width: canvas.width, height: canvas.height }));
  assert.deepEqual([size(0xb0), size(0xba)], [2 * width, height], "both pictures beside each other");
  const sizes = frameSizes(bytes);
  assert.ok(sizes.slice(1).filter((size) => size > 200).length > 1, `a still film repeats its first frame in few bytes: ${sizes}`);
  assert.ok(await film.isVisible(), "and another can be made");
});

test("energies: kinetic, potential, lost", () => {
  const close = (found, wanted) => found.forEach((v, i) => assert.ok(Math.abs(v - wanted[i]) < 1e-12, `${found}`));
  close(energyOf("pendulum", { q: Math.PI / 2, p: 1 }, { gravity: 4, length: 2 }), [0.5, 2, 0]);
  close(energyOf("spring", { q: 1, p: 1 }, { stiffness: 2 }, { q: 2, p: 0 }), [0.5, 1, 2.5]);
  const double = { m1: 1, m2: 2, l1: 3, l2: 4, gravity: 5 };
  close(energyOf("double_pendulum", { theta1: 0, theta2: Math.PI, energy: 2 }, double), [7, 80, 0]);
  assert.equal(energyOf("planet", { x: 1 }, {}), null);
  assert.equal(energyOf("pendulum", { q: 1 }, {}), null, "without the momentum nothing is known");
});

pageTest("energy stands as bars beside the body: what friction takes, is lost", { hash: "#problem=damped_pendulum&until.t=30&A=contact_leapfrog&B=contact_leapfrog", reducedMotion: "reduce" }, async (page) => {
  const { part } = await page.locator("#bodies").evaluate((canvas) => {
    const { clientWidth: width } = canvas, beside = Math.min(0.4 * width, 17 * parseFloat(getComputedStyle(canvas).fontSize));
    return { part: beside / 3 / width };
  });
  const heights = async () => {
    const found = [];
    for (let k = 3; k > 0; k--) {
      const { count, top, bottom } = await drawn(page, "#bodies", "A", [1 - k * part, 1 - (k - 1) * part]);
      found.push(count ? bottom - top : 0);
    }
    return found;
  };
  await page.locator("#motion .time input").fill("0");
  const [kinetic, potential, lost] = await heights();
  assert.ok(potential > 50 && kinetic < 3 && lost < 3, `at rest near the top: ${[kinetic, potential, lost]}`);
  await page.locator("#motion .time input").fill("1000");
  const end = await heights();
  assert.ok(end[2] > 0.8 * potential && end[0] + end[1] < 0.2 * potential && Math.abs(end[0] + end[1] + end[2] - potential) < 8, `${end}`);
});
