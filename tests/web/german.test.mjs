// The page in German: no word of it is English, nothing is cut off, axe finds nothing wrong; numbers have a comma.
import assert from "node:assert/strict";
import { axeViolations } from "./axe.mjs";
import { becomes, pageTest, pane, settled } from "./browser.mjs";
import { lessons } from "../../web/lessons/lessons.js";

const calm = { reducedMotion: "reduce", locale: "de-DE" };
const lesson = { ...calm, hash: "#lesson=orbit", ready: "#lesson[aria-busy=false]" };

// Words that do not exist in German. They may occur outside the texts of the page: in formulas, programs, references, messages of the
// service about a run.
const english = new RegExp(`(?<!\\p{L})(${("the,of,and,with,is,are,from,to,at,by,for,that,which,its,it,as,on,over,not,be,has,no,time,energy,force,forces,evaluations,error,step," +
  "steps,scheme,schemes,order,play,speed,add,remove,save,runs,start,starts,end,last,first,each,what,where,how,when,of your own,show,all,other,none,default," +
  "completed,stopped,angular,momentum,mean,explicit,implicit,symmetric,kinetic,floor,residual,converged,cycles,potential energy,copy,copied,leave,present,measure,search,compute,member").split(",").join("|")})(?!\\p{L})`, "iu");
const both = /`\w+`|\w+_\w+|(?<!\p{L})Starts?(?!\p{L})/gu; // ids, and what is German too
const others = ".curl pre, #references, .about p:last-child, #formula, #as-read, #equations, math, .messages, .spot, #unplaced, #stability td:last-child, #stability-status, #precision-notes, #language, h1, option[value=en], textarea, noscript, script, style, template";

/** What a reader sees, hears or is told when pointing at something. */
const texts = (page) => page.evaluate((beside) => {
  const found = [], walk = (node) => {
    if (node.nodeType === Node.TEXT_NODE) return node.data.trim() && found.push(node.data.trim());
    if (node.nodeType !== Node.ELEMENT_NODE || node.matches(beside)) return;
    if (node.localName !== "option" && !node.checkVisibility()) return;
    for (const name of ["aria-label", "aria-valuetext", "label"]) if (node.getAttribute(name)) found.push(node.getAttribute(name));
    if (node.matches("button, a, summary, .remove, .lens button") && node.title) found.push(node.title);
    for (const child of node.childNodes) walk(child);
  };
  walk(document.body);
  return [...new Set(found)];
}, others);

async function assertGerman(page, where) {
  const wrong = (await texts(page)).filter((said) => english.test(said.replace(both, "")) || /(?<![\d.])\d+\.\d(?!\d*\.)/.test(said) || /^[a-z]+(\.[a-z_]+)+$/.test(said));
  assert.deepEqual(wrong, [], where);
}

/** Elements wider than their place: words that are cut off, and a page that scrolls sideways. */
const cut = (page) => page.evaluate(() => {
  const { scrollWidth, clientWidth } = document.documentElement, seen = [...document.querySelectorAll("button, label > span, th, td, h2, p, legend, summary, figcaption, #look")];
  const wide = seen.filter((node) => node.checkVisibility() && !node.closest(".scroll, .lens, #comparison, #axes, .unseen") && node.scrollWidth > node.clientWidth + 2 &&
    getComputedStyle(node).display !== "inline" && node.clientWidth > 0);
  return [...(scrollWidth > clientWidth ? [`the page, ${scrollWidth} of ${clientWidth}`] : []), ...wide.map((node) => `${node.localName} ${node.textContent.slice(0, 40)}`)];
});
const sizes = [[360, 740], [1024, 768], [1280, 720]];

async function assertFits(page, where) {
  for (const [width, height] of sizes) {
    await page.setViewportSize({ width, height });
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve))));
    assert.deepEqual(await cut(page), [], `${where} at ${width} × ${height}`);
  }
}

pageTest("every lesson is German, and fits", lesson, async (page) => {
  await page.click(".all summary");
  for (const { id } of lessons) {
    await page.selectOption("#which", id);
    await becomes(() => page.evaluate(() => window.said?.lesson), (shown) => shown === id);
    await assertGerman(page, id);
    if (["portrait", "chain", "islands", "digits", "bounce"].includes(id)) await assertFits(page, id);
    await page.setViewportSize({ width: 1280, height: 720 });
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve))));
    const high = await page.locator(".all").evaluate((all) => {
      all.open = false;
      const found = document.documentElement.scrollHeight;
      all.open = true;
      return found;
    });
    assert.ok(high <= 720 || high > 745, `${id} scrolls by ${high - 720} pixels, for nothing`);
    await page.setViewportSize({ width: 1024, height: 768 });
    const low = Math.max(0, ...await page.locator("#control input").evaluateAll((found) => found.map((node) => node.getBoundingClientRect().bottom)));
    assert.ok(low <= 768, `what is moved by hand in ${id} stands in the first screen, down to ${low}`);
  }
});

const benches = {
  "the workbench": { hash: "#problem=kepler&until.t=20&B=jacobi_maupertuis" },
  "a scene with friction": { hash: "#problem=damped_oscillator&until.t=20&A=contact_splitting" },
  "six runs in space": { hash: "#problem=kepler_3d&until.t=5&C=taylor&D=contact_gauss&E=energy_momentum&F=runge_kutta_4&view.together=true" },
  "a portrait": { hash: "#problem=pendulum&until.t=20&starts.of=q,p&starts.at=0,1,0,2&view.field=both" },
  "a scene with heat": { hash: "#problem=generic_oscillator&until.t=10" },
  "a cycle": { hash: "#problem=van_der_pol&until.t=20" },
  "a star": { hash: "#problem=lane_emden&preset=plummer&until.t=3" },
  "a scene as text": { hash: "#problem=custom&problem.variables=x&problem.potential=x%5E4&problem.parameters=k=1&until.t=5" },
};
for (const [name, part] of Object.entries(benches)) {
  pageTest(`${name} is German, fits, and axe finds nothing wrong`, { ...calm, ...part }, async (page) => {
    await page.locator("details").evaluateAll((found) => found.forEach((one) => (one.open = true)));
    await assertGerman(page, name);
    assert.deepEqual(await axeViolations(page), []);
    await assertFits(page, name);
  });
}

pageTest("studies are German, while they go on and at their end", { ...calm, hash: "#problem=harmonic_oscillator&until.t=20&A.step=0.05&sweep.until=20&sweep.after=10" }, async (page) => {
  await page.selectOption("#budget", "3");
  for (const study of ["section", "basins", "tangent", "sweep", "closed", "stability", "precision"]) {
    await page.click(`#measure-${study}`);
    await assertGerman(page, study);
    await becomes(() => page.textContent(`#measure-${study}`), (said) => said !== "Anhalten");
    await assertGerman(page, `${study} at its end`);
  }
  assert.match(await page.textContent("#section-status"), /^[\d\u202f]+ Punkte von 40 Läufen mit Leapfrog\./);
  assert.match(await pane(page, "A").locator("figcaption .title").textContent(), /h = 0,05$/);
  await page.selectOption("#budget", "60"); // it is not over before it is stopped
  await page.click("#measure-precision");
  await page.click("#measure-precision");
  assert.equal(await page.textContent("#precision-status"), "Angehalten.");
});

pageTest("a presentation is German, and axe finds nothing wrong in a lesson and its gallery", { ...lesson, hash: "#lesson=bath" }, async (page) => {
  await page.click(".all summary");
  assert.deepEqual(await axeViolations(page), []);
  assert.match(await page.textContent("#legend"), /schmal, Skala 0,1/);
  await page.click("#present");
  await assertGerman(page, "presented");
  assert.equal(await page.textContent("#present"), "Beenden");
});

pageTest("what a field refuses is said in German as far as the page says it", { ...calm, hash: "#problem=pendulum&until.t=20", expected: /422/ }, async (page) => {
  await page.locator("[data-pointer='/initial/q']").fill("1,5");
  await page.locator("[data-pointer='/initial/q']").press("Enter");
  await settled(page);
  await page.waitForURL(/initial.q=1.5/);
  await page.locator("[data-pointer='/initial/q']").fill("x");
  await page.locator("[data-pointer='/initial/q']").press("Enter");
  await settled(page);
  assert.match(await page.textContent("#status"), /abgelehnt: siehe die markierten Felder/);
});
