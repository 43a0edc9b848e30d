// The studies on the page, and auto as a choice of scheme: with answers made up here, then those of the program.
import assert from "node:assert/strict";
import { all, drawn, frames, pageTest, pane, settled, statuses } from "./browser.mjs";
import { enter, fieldAt, madeUp, scene, variable } from "./made.mjs";

const swing = scene("swing", {
  variables: [variable("q", 1), variable("p", 0)], columns: ["t", "q", "p", "energy", "mode"],
  schemes: ["leapfrog", "runge_kutta_4", "auto"],
});
const studyTest = madeUp([swing]);
const status = (page, study) => page.locator(`#${study}-status`);
const schemes = [{ id: "leapfrog", step: 0.1, composition: "none" }, { id: "leapfrog", step: 0.1, composition: "kahan_li_6" },
                 { id: "runge_kutta_4", step: 0.1 }];

// Three curves of orders 2, 6 and 4; the first point of the last failed.
const point = (i, k) => {
  const value = 2 ** -k;
  return { value, step: value, error: i === 2 && k === 0 ? null : 0.1 * value ** [2, 6, 4][i],
           force_evaluations: 100 * [1, 9, 4][i] * 2 ** k, seconds: 1e-6 * [1, 9, 2][i] * 2 ** k, status: "completed" };
};
const lines = [
  { reference: { how: "closed form", uncertainty: 1e-16 }, floor: 2e-10, chaotic: false, until: { t: 50 }, end: 50, schemes },
  ...[0, 1, 2, 3, 4, 5].flatMap((k) => [0, 1, 2].map((i) => ({ curve: i, scheme: schemes[i], setting: "step", point: point(i, k) }))),
  { curves: [{ scheme: schemes[0], setting: "step", observed_order: 2.01, expected_order: 2 },
             { scheme: schemes[1], setting: "step", observed_order: null, expected_order: 6, why: "fewer than three points" },
             { scheme: schemes[2], setting: "step", observed_order: 3.2, expected_order: 4 }],
    pareto: [], left_out: ["ruth_3: the budget was over"], status: "completed" },
];
const limits = [
  { scheme: schemes[0], step: 2, failure: "energy_growth", theory: 2 },
  { scheme: schemes[2], step: null, failure: null, theory: null, why: "every step is stable" },
];

/** Answers studies with what is made up, and keeps what was asked. */
const answered = (asked, refused) => async (opened) => {
  const reply = (route, body) => {
    asked.push([new URL(route.request().url()).pathname, route.request().postDataJSON(), route.request().headers().accept]);
    return refused ? route.fulfill({ status: 422, contentType: "application/problem+json", json: refused })
                   : route.fulfill({ contentType: "application/x-ndjson", body });
  };
  await opened.route("**/v1/work-precision", (route) => reply(route, lines.map((line) => `${JSON.stringify(line)}\n`).join("")));
  await opened.route("**/v1/stability", (route) => reply(route, JSON.stringify({ limits, left_out: [], status: "completed" })));
};
/** Waits until a study says something. */
const told = (page, study, pattern) => page.locator(`#${study}-status`, { hasText: pattern }).waitFor();
async function measure(page) {
  await page.click("#measure-precision");
  await told(page, "precision", /18 runs\./);
  await frames(page);
}
const plot = "#precision canvas";
const hues = ["--run-a", "--run-b", "--curve-c"];

const first = [];
studyTest("error over cost: a curve per scheme, the front, what each point is", { more: answered(first) }, async (page) => {
  assert.ok(!(await page.locator("#precision").isVisible()), "nothing is measured unasked");
  await page.selectOption("#measure", "max");
  await page.selectOption("#budget", "3");
  await measure(page);
  assert.deepEqual(first, [["/v1/work-precision", {
    problem: { id: "swing" }, initial: { t: 0, q: 1, p: 0 }, until: { t: 50 }, schemes: "all", error: "max", budget_seconds: 3,
  }, "application/x-ndjson"]]);
  for (const hue of hues) assert.ok((await drawn(page, plot, hue)).count > 100, hue);
  assert.ok((await drawn(page, plot, "--line")).count > 500, "the front is drawn, broad");
  assert.ok((await drawn(page, plot, "--fault")).count > 100, "and the floor");
  assert.deepEqual((await all(page, "#precision .u-legend th", "textContent")).slice(1),
                   ["leapfrog", "leapfrog (kahan li 6)", "runge kutta 4"]);

  // The point of the largest error and the least cost lies at the left end of the first curve.
  const { left, top } = await drawn(page, plot, "--run-a");
  const ratio = await page.evaluate(() => window.devicePixelRatio);
  const box = await page.locator(plot).boundingBox();
  await page.mouse.move(box.x + left / ratio + 3, box.y + top / ratio + 3);
  assert.equal(await page.textContent("#precision .tip"),
               "leapfrog\nstep 1: error 0.1\n100 force evaluations, 1.00·10⁻⁶ s");
  assert.ok(await page.locator("#precision .tip").isVisible());
  await page.mouse.move(box.x + 5, box.y + 5);
  assert.ok(!(await page.locator("#precision .tip").isVisible()));

  const notes = await all(page, "#precision-notes li", "textContent");
  assert.match(notes[0], /closed form.*2·10⁻¹⁰/);
  assert.deepEqual(notes.slice(1), ["leapfrog (kahan li 6): fewer than three points",
                                    "runge kutta 4: of order 3.2 here, 4 in general", "ruth_3: the budget was over"]);
  assert.equal(await page.locator(".fault").count(), 0);
});

const second = [];
studyTest("the cost may be seconds; another scene takes the study away", { more: answered(second) }, async (page, asked) => {
  await page.selectOption("#measured", "shown");
  await measure(page);
  assert.deepEqual(second[0][1].schemes.map(({ id }) => id), ["leapfrog", "leapfrog"]);
  const before = await drawn(page, plot, "--curve-c"), runs = asked.length;
  await page.selectOption("#cost", "seconds");
  await frames(page);
  const after = await drawn(page, plot, "--curve-c");
  assert.ok(after.left < before.left - 5, "runge_kutta_4 is cheaper in time than in evaluations");
  assert.deepEqual([second.length, asked.length], [1, runs], "nothing is measured or run again");
  await pane(page, "A").locator(".scheme").selectOption("runge_kutta_4");
  await settled(page);
  assert.ok(await page.locator("#precision").isVisible(), "another scheme of a run is no other scene");
  await page.emulateMedia({ colorScheme: "dark" });
  await frames(page);
  assert.ok((await drawn(page, plot, "--curve-c")).count > 100, "drawn in the colours of the dark");
  await enter(page, "/initial/q", "2");
  assert.ok(!(await page.locator("#precision").isVisible()));
  assert.equal(await status(page, "precision").textContent(), "");
  assert.equal(await page.locator("#precision-notes li").count(), 0);
});

studyTest("the longest steps are a table, with failures in words", { more: answered([]) }, async (page) => {
  await page.click("#measure-stability");
  await page.waitForSelector("#stability tbody tr");
  assert.deepEqual(await all(page, "#stability tbody tr:nth-child(1) > *", "textContent"),
                   ["leapfrog", "2", "2", "the energy grows"]);
  assert.deepEqual(await all(page, "#stability tbody tr:nth-child(2) > *", "textContent"),
                   ["runge kutta 4", "–", "–", "every step is stable"]);
});

const refused = { status: 422, title: "no", errors: [{ pointer: "/until/t", detail: "must be later", allowed: "(0, inf)" }] };
studyTest("faults of a study are told beside its button", { expected: /status of 422/, more: answered([], refused) },
  async (page) => {
    for (const study of ["precision", "stability"]) {
      await page.click(`#measure-${study}`);
      await told(page, study, /until/);
      assert.equal(await status(page, study).textContent(), "/until/t: must be later; allowed: (0, inf)");
      assert.match(await status(page, study).getAttribute("class"), /fault/);
    }
  });

const chosen = { change: (outcome, request) => {
  if (request.scheme.id !== "auto") return;
  outcome.scheme = { id: "leapfrog", step: 0.0712345678901234, composition: "kahan_li_6" };
  outcome.choice = { reason: "Nothing cheaper reaches 10⁻⁶", met: request.scheme.accuracy > 1e-9, estimated_error: 4.2e-7,
                     alternatives: [{ scheme: { id: "runge_kutta_4", step: 0.01 }, force_evaluations: 20000, estimated_error: 9e-7,
                                      seconds: 1e-3 }] };
} };
studyTest("auto is a choice of scheme, and says in words what it chose", { hash: "#problem=swing&A=leapfrog&B=auto", ...chosen },
  async (page, asked, context) => {
    const request = () => asked.findLast(({ scheme }) => scheme.id === "auto");
    assert.deepEqual(request().scheme, { id: "auto", accuracy: 1e-6, seconds: null, keep: [] });
    assert.deepEqual(request().record, { samples: 10000 });
    const title = "auto: leapfrog (kahan li 6), h = 0.07123";
    assert.equal(await pane(page, "B").locator("figcaption .title").textContent(), `B ${title}`);
    assert.match(await pane(page, "B").locator(".traits").textContent(), /^order 6 · explicit/);
    const said = pane(page, "B").locator(".messages .choice");
    assert.match(await said.textContent(), /^Nothing cheaper reaches 10⁻⁶\.Alternatives/);
    assert.doesNotMatch(await said.getAttribute("class"), /missed/);
    assert.equal(await said.locator("li").textContent(), "runge kutta 4, h = 0.01: 20\u202f000 force evaluations, error 9.0·10⁻⁷");
    assert.equal(await page.locator(".pane[data-run=A] .messages .choice").count(), 0);

    await pane(page, "B").locator("[data-name=keep]").selectOption(["energy", "momenta"]);
    await settled(page);
    const accuracy = pane(page, "B").locator("[data-name=accuracy]");
    await accuracy.fill("1e-12");
    await accuracy.press("Enter");
    await settled(page);
    assert.deepEqual(request().scheme, { id: "auto", accuracy: 1e-12, seconds: null, keep: ["energy", "momenta"] });
    assert.match(await said.getAttribute("class"), /missed/);
    const other = await context.newPage();
    await other.goto(page.url());
    await settled(other);
    assert.equal(other.url(), page.url());
    assert.deepEqual(request().scheme.keep, ["energy", "momenta"]);
    assert.equal(await pane(other, "B").locator("[data-name=accuracy]").inputValue(), "1e-12");
  });

/** Answers the study with its lines in pieces of seven bytes, which respect neither lines nor letters. */
const piecemeal = (opened) => opened.addInitScript((text) => {
  const bytes = new TextEncoder().encode(text), whole = window.fetch;
  window.fetch = (path, options) => {
    if (!String(path).endsWith("work-precision")) return whole(path, options);
    let at = 0;
    return Promise.resolve(new Response(new ReadableStream({
      pull: (stream) => (at < bytes.length ? stream.enqueue(bytes.slice(at, (at += 7))) : stream.close()),
    }), { headers: { "Content-Type": "application/x-ndjson" } }));
  };
}, lines.map((line) => `${JSON.stringify({ ...line, left_out: ["größer"] })}\n`).join(""));

const narrow = { viewport: { width: 390, height: 844 }, more: piecemeal };
studyTest("at the width of a telephone the studies fit as well, and lines may come in pieces", narrow, async (page) => {
  await measure(page);
  assert.equal(await page.locator("#precision-notes li").last().textContent(), "größer");
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390);
});

// ── the program's own ──────────────────────────────────────────────────────────────────────────────────────────────────

pageTest("points appear while they are measured, and the button ends that", { hash: "#problem=kepler&until.t=400" },
  async (page) => {
    await page.selectOption("#budget", "60");
    await page.click("#measure-precision");
    await told(page, "precision", /Measuring: \d\d/);
    assert.equal(await page.textContent("#measure-precision"), "Stop");
    const seen = await Promise.all([...hues, "--curve-d", "--curve-f"].map((hue) => drawn(page, plot, hue)));
    assert.ok(seen.some(({ count }) => count > 20), "before the end");
    await page.click("#measure-precision");
    await told(page, "precision", /Stopped/);
    assert.equal(await page.textContent("#measure-precision"), "Measure");
    assert.ok(await page.locator("#precision").isVisible(), "what was measured stays");
  });

pageTest("a study of the program comes to its end", { hash: "#problem=harmonic_oscillator&until.t=5" }, async (page) => {
  await page.selectOption("#measured", "shown");
  await page.selectOption("#budget", "3");
  await page.click("#measure-precision");
  await told(page, "precision", /\d runs\. Times/);
  assert.ok((await page.locator("#precision-notes li").count()) > 0);
  await page.click("#measure-stability");
  await page.waitForSelector("#stability tbody tr");
  assert.match((await all(page, "#stability tbody tr", "textContent")).join("\n"), /leapfrog\D*2.*the energy grows|leapfrog1\.99/);
});

pageTest("auto of the program runs what it chose", { hash: "#problem=kepler&until.t=20&A=leapfrog&B=auto&B.accuracy=1e-3" },
  async (page) => {
    assert.deepEqual(await statuses(page), ["completed", "completed"]);
    assert.ok((await pane(page, "B").locator(".messages .choice").textContent()).length > 20);
    assert.match(await pane(page, "B").locator("figcaption .title").textContent(), /^B auto: /);
    assert.equal(await page.locator(".fault").count(), 0);
  });

pageTest("a wish for both an accuracy and a time is refused where it stands", { expected: /status of 422/,
  hash: "#problem=kepler&until.t=20&A=leapfrog&B=auto&B.seconds=0.01" }, async (page) => {
  assert.match(await pane(page, "B").locator(".messages .fault").textContent(), /either accuracy or seconds/);
  await fieldAt(page, "/scheme/accuracy").fill("");
  await fieldAt(page, "/scheme/accuracy").press("Enter");
  await settled(page);
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
});
