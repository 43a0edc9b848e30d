// Links contain events that act, and the way back of a run: from a lesson into the workbench, and from one reader to another.
import assert from "node:assert/strict";
import { eventsOf, happeningsText } from "../../web/service/happenings.js";
import { test } from "node:test";
import { all, drawn, number, origin, pageTest, pane, plane, settled, statuses } from "./browser.mjs";
import { enter, fieldAt } from "./made.mjs";

test("events as they are typed, and back", () => {
  const text = "floor = x down {vx = -e*vx, y = max(1, 2)} stop most 20, apsis = x*px + y*py, top = upper + x up";
  const events = [{ name: "floor", expression: "x", direction: "down", stop: true, most: 20, set: { vx: "-e*vx", y: "max(1, 2)" } },
                  { name: "apsis", expression: "x*px + y*py" }, { name: "top", expression: "upper + x", direction: "up" }];
  assert.deepEqual(eventsOf(text), events);
  assert.equal(happeningsText(events), text);
});

pageTest("a ball of a lesson bounces in the workbench, and under another link", { hash: "#lesson=bounce", ready: "#lesson[aria-busy=false]", reducedMotion: "reduce" },
  async (page, context) => {
    await page.click("#to-bench");
    await settled(page);
    assert.equal(await fieldAt(page, "/events/more").inputValue(), "floor = x down {vx = -e*vx}");
    const rests = (e) => Math.SQRT2 * (1 + e) / (1 - e), stop = () => pane(page, "A").locator(".messages .stop").textContent();
    assert.match(await stop(), new RegExp(`accumulating events.*singular at t = ${rests(0.5).toPrecision(5)}`));
    await enter(page, "/events/more", "floor = x down {vx = -0.8*vx} most 3");
    assert.deepEqual(await statuses(page), ["completed", "completed"], "three bounces, then it ends");
    assert.match(await pane(page, "A").locator(".messages .events").textContent(), /^3 floor/);
    const other = await context.newPage();
    await other.goto(page.url());
    await settled(other);
    assert.match(await pane(other, "A").locator(".messages .events").textContent(), /^3 floor/);
    await other.close();
  });

pageTest("no study leaves out what acts: the service refuses it by name", { hash: "#problem=pendulum&until.t=20&A=leapfrog&events.more=wall=q+down+%7Bp=-p%7D", expected: /status of 422/ },
  async (page) => {
    for (const study of ["section", "sweep", "stability"]) {
      await page.click(`#measure-${study}`);
      await page.locator(`#${study}-status`, { hasText: /^\/events: / }).waitFor();
    }
  });

pageTest("the way back of a lesson stands beside the way forth in the workbench", { hash: "#lesson=backward", ready: "#lesson[aria-busy=false]", reducedMotion: "reduce" },
  async (page) => {
    await page.click("#to-bench");
    await settled(page);
    assert.match(page.url(), /until\.back=true/);
    assert.equal(await page.locator(".pane").count(), 2, "the way back is no run of its own");
    const [kept, lost] = [await number(page, "missed", "A"), await number(page, "missed", "B")];
    assert.ok(kept < 1e-12 && lost > 0.1, `${kept} and ${lost}`);
    const ink = (await drawn(page, plane("A"), "--ink")).count;
    await fieldAt(page, "/until/back").uncheck();
    await settled(page);
    assert.equal(await page.locator("#numbers tr[data-row=missed]").count(), 0);
    assert.doesNotMatch(page.url(), /back/);
    assert.ok((await drawn(page, plane("A"), "--ink")).count < ink - 200, "it was drawn over the way forth");
  });

pageTest("the clock of a run backward in time goes from its start, and the run goes on from its end", { hash: "#problem=kepler&until.t=-20", reducedMotion: "reduce" }, async (page) => {
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
  assert.match(await page.textContent("#motion .player output"), /t = −20/);
  await page.locator("#motion .time input").fill("250");
  assert.match(await page.textContent("#motion .player output"), /t = −5/);
  const { final } = await (await fetch(`${origin}/v1/simulate`, { method: "POST", body: JSON.stringify({ problem: "kepler", scheme: { id: "leapfrog", step: 0.01 }, until: { t: -20 } }) })).json();
  await page.click("#continue");
  await settled(page);
  assert.equal(Number(await fieldAt(page, "/initial/x").inputValue()), final.x);
  assert.equal(await fieldAt(page, "/until/t").inputValue(), "-40");
});

const alone = "#problem=custom&problem.variables=x&problem.potential=x%5E2/2&initial.x=1&until.t=-20&A=leapfrog&A.step=0.5&axes.x=t";
pageTest("the energy of one run backward stands over ascending times", { hash: alone }, async (page) => {
  await page.locator("#energy canvas").scrollIntoViewIfNeeded();
  const box = await page.locator("#energy .u-over").boundingBox(), told = () => page.locator("#energy .u-legend .u-value").first().textContent();
  await page.mouse.move(box.x + 0.25 * box.width, box.y + box.height / 2);
  const early = Number((await told()).replace("−", "-"));
  await page.mouse.move(box.x + 0.75 * box.width, box.y + box.height / 2);
  const late = Number((await told()).replace("−", "-"));
  assert.ok(Math.abs(early + 15) < 1.1 && Math.abs(late + 5) < 1.1, `${early}, ${late}`);
});

pageTest("a way back that is refused is told, the way forth stays", { hash: "#problem=van_der_pol&until.t=10&until.back=true&A=contact_splitting&B=taylor", expected: /status of 422/ }, async (page) => {
  assert.deepEqual(await statuses(page), ["completed", "completed"]);
  assert.match((await all(page, ".pane[data-run=A] .messages .fault", "textContent")).join(), /^The way back: contact_splitting runs van_der_pol forward in time alone/);
  assert.equal(await page.locator(".pane[data-run=B] .messages .fault").count(), 0);
});
