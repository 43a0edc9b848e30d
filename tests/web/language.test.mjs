// The page in every language: each has all the texts, and no other; which is spoken the link says, else the browser.
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { all, catalogue, origin, pageTest, settled, stepOf } from "./browser.mjs";
import { lessons } from "../../web/lessons/lessons.js";
import { inLanguage, language, languageOf, languages, listed, named, speak, spelled, text, typed } from "../../web/language/texts.js";

const page = process.env.LEAST_PAGE ?? fileURLToPath(new URL("../../web/", import.meta.url));
const read = (path) => readFileSync(join(page, path), "utf8");
const tables = Object.fromEntries(Object.keys(languages).map((one) => [one, JSON.parse(read(`language/${one}.json`))]));
const { en, de } = tables;
const sources = readdirSync(page, { recursive: true }).filter((name) => /^(?!node_modules).*\.(js|html)$/.test(name)).map((name) => [name, read(name)]);
const ofService = /^service\./; // names that the service says, in English by themselves

test("every language has the same texts, with the same values in them", () => {
  assert.deepEqual(Object.keys(de).filter((key) => !ofService.test(key)), Object.keys(en));
  const places = (said) => [...new Set(JSON.stringify(said).match(/\{\w+\}/g))].sort();
  for (const [key, said] of Object.entries(en)) {
    assert.deepEqual(places(de[key]), places(said), key);
    assert.equal(typeof de[key], typeof said, key);
  }
  for (const [key, said] of Object.entries({ ...en, ...de })) assert.ok(JSON.stringify(said).length > 2, `${key} is empty`);
});

/** The keys that the page uses: as they stand, and patterns of those that it puts together. */
function usedKeys() {
  const exact = new Map(), made = [];
  const pattern = (key) => new RegExp(`^${key.replaceAll(".", "\\.").replace(/\$\{[^}]*\}/g, ".+")}$`);
  for (const [file, source] of sources) {
    for (const [, key] of source.matchAll(/\bdata-text(?:-title|-label)?="([^"]+)"/g)) exact.set(key, file);
    for (const [, joined, plain] of source.matchAll(/\b(?:text|known|message)\((?:`([^`]*)`|([^`,()]*))/g)) {
      if (joined && !joined.startsWith("${")) made.push(pattern(joined));
      for (const [, compared, key] of plain?.matchAll(/(=== )?"([^"]+)"/g) ?? []) if (!compared) exact.set(key, file);
    }
    for (const [, prefix] of source.matchAll(/\bnamed\("([\w.]+)"/g)) made.push(pattern(`${prefix}.\${name}`));
  }
  return { exact, made };
}

test("every text is used, and none is missing", () => {
  const { exact, made } = usedKeys();
  for (const key of Object.keys(en)) assert.ok(exact.has(key) || made.some((one) => one.test(key)), `nobody uses ${key}`);
  for (const [key, file] of exact) assert.ok(key in en, `${file} asks for ${key}`);
});

test("names of the lessons are texts or formulas", () => {
  const found = [], collect = (name) => name !== undefined && found.push([name].flat()[0]);
  for (const { runs = [], views = [], control, tells = [], labels = [], key = [] } of lessons) {
    for (const { name } of runs) collect(name);
    for (const view of views) [...(view.labels ?? []).filter(Boolean), ...(view.places ?? []).map(([name]) => name), ...(view.exact ?? []).map(([name]) => name), ...(view.several ?? []).map(([, name]) => name)].forEach(collect);
    [control?.label, ...tells.map(([name]) => name), ...labels, ...key].forEach(collect);
  }
  assert.ok(found.length > 100);
  for (const name of found) assert.ok(`term.${name}` in en || !/[a-z]{3}/.test(name.replace(/\b(sin|cos)\b/g, "")), name);
  for (const key of Object.keys(en).filter((one) => one.startsWith("term."))) assert.ok(found.includes(key.slice(5)), `nobody uses ${key}`);
});

// A problem or scheme may lack German texts, and is then shown in the service's words; but if it has some it must have all.
pageTest("what the catalogue says has a text in every other language", { hash: "", ready: "#lesson[aria-busy=false]" }, async () => {
  const german = Object.keys(JSON.parse(read("language/de.catalogue.json")));
  const [problems, schemes] = ["problem", "scheme"].map((kind) => {
    const cards = catalogue[`${kind}s`], spoken = cards.filter(({ id }) => german.some((key) => key.startsWith(`${kind}.${id}.`)));
    assert.ok(spoken.length > 0.9 * cards.length, `German of ${spoken.length} of ${cards.length} ${kind}s`);
    return spoken;
  });
  const names = new Set(Object.keys(de).filter((key) => ofService.test(key)).map((key) => key.slice(13)));
  const parts = (kind, cards, own) => cards.flatMap(({ id, presets }) => [...own, ...presets.map(({ name }) => name)].map((part) => `${kind}.${id}.${part}`));
  const wanted = ["problem.custom.summary", ...parts("problem", problems, ["title", "summary"]), ...parts("scheme", schemes, ["title", "summary", "good_for", "fails_when"]),
                  ...JSON.parse(read("scenes.json")).flatMap(({ name }) => [`example.${name}`, `example.${name}.note`])];
  const docs = [...problems, ...schemes].flatMap(({ parameters, variables = [] }) => [...parameters, ...variables].map(({ doc }) => `doc.${doc.replace(/^(momentum of ).+/, "$1{x}")}`));
  const all = new Set([...wanted, ...docs]);
  assert.deepEqual(german.filter((key) => !all.has(key)), [], "German of what is not there");
  assert.deepEqual([...all].filter((key) => !german.includes(key)), [], "no German");
  const shown = [...schemes.flatMap(({ id, presets, parameters }) => [id, ...presets.map(({ name }) => name), ...parameters.flatMap(({ name, choices }) => [name, ...(choices ?? [])])]),
                 ...problems.flatMap(({ presets, parameters, columns }) => [...presets, ...parameters].map(({ name }) => name).concat(columns))];
  const letters = /^(.{1,2}|alpha|beta|gamma|delta|eps|epsilon|kappa|lambda|mu|omega|rho|sigma|p?theta[12]?|p?phi|\w+\[\d+\])$/;
  assert.deepEqual([...new Set(shown)].filter((name) => !names.has(name) && !letters.test(name)), [], "names without a German word");
});

test("no text stands in the document itself", () => {
  const [body] = /<body>.*<\/body>/s.exec(read("index.html").replace(/<noscript>.*?<\/noscript>/s, ""));
  const seen = body.replace(/<[^>]*>/gs, " ").match(/[A-Za-z]{2,}/g).filter((word) => word !== "leastaction");
  assert.deepEqual(seen, []);
  assert.deepEqual(body.match(/ (aria-label|title|placeholder|alt)="[^"]+"/g), null);
});

test("no text stands in the modules", () => {
  const tags = /^(, |figure|canvas|input|select|textarea|button|a|summary|ul|div|pre|\+|[.#][\w-]+| )+$/; // selectors
  const code = ["Escape", "note key", "typed wide", "scroll derived", "choice missed", "Re", "Im", ...Object.values(languages)]; // a key, classes
  for (const [file, source] of sources) {
    if (!file.endsWith(".js") || file === "workbench/programs.js") continue; // programs are English
    const bare = source.replace(/^\s*(\/\/|\/?\*).*$/gm, "").replace(/ \/\/ .*$/gm, "");
    for (const [, plain, pieces] of bare.matchAll(/"((?:[^"\\\n]|\\.)*)"|`((?:[^`\\]|\\.)*)`/g)) {
      const said = plain ?? pieces.replace(/\$\{[^}]*\}/g, "");
      if (tags.test(said) || code.includes(said) || /^<|^linear-gradient|\bpx |px sans-serif$|=> $/.test(said)) continue;
      assert.ok(!/[A-Za-z]{2,},? [a-z]{2,}/.test(said) && !/^[A-Z][a-z]+( |$|…)/.test(said), `${file}: ${said}`);
    }
  }
});

test("texts take values and count, numbers are written as the language does, and both decimal signs are read", () => {
  const before = language();
  speak("de", { runs: { one: "{n} Lauf", other: "{n} Läufe" }, "name.step": "Schritt {h}" });
  assert.equal(text("runs", { n: 1 }), "1 Lauf");
  assert.equal(text("runs", { n: 12345 }), "12\u202f345 Läufe");
  assert.equal(named("name", ["step", { h: -0.5 }]), "Schritt −0,5");
  assert.equal(named("name", "e = 0.5"), "e = 0,5");
  assert.equal(spelled("1e-5"), "1e−5");
  assert.equal(listed([spelled(0.5), 1]), "0,5; 1");
  assert.deepEqual(["0,5", "0.5", "1,2,3", "-1,5e3", "a"].map(typed), [0.5, 0.5, NaN, -1500, NaN]);
  speak("en", {});
  assert.equal(spelled(-0.5), "−0.5");
  assert.deepEqual(["0,5", "0.5"].map(typed), [NaN, 0.5]);
  speak(before, {});
});

test("a link says the language, beside what else it says", () => {
  assert.equal(languageOf("#lesson=orbit&lang=de"), "de");
  for (const hash of ["", "#lang=fr", "#lang=constructor", "#problem=lang"]) assert.equal(languageOf(hash), undefined, hash);
  assert.equal(inLanguage("#lesson=orbit&lang=de&present", "en"), "#lesson=orbit&present&lang=en");
  assert.equal(inLanguage("#lang=de"), "");
  assert.equal(inLanguage("", "de"), "#lang=de");
});

const lesson = { hash: "", ready: "#lesson[aria-busy=false]", reducedMotion: "reduce" };
const spokenIn = (opened) => opened.evaluate(() => document.documentElement.lang);

pageTest("the browser chooses the language, of those that there are", { ...lesson, locale: "de-AT" }, async (opened, context) => {
  assert.equal(await spokenIn(opened), "de");
  assert.equal(await opened.textContent("#to-workbench"), de.workbench);
  assert.equal(new URL(opened.url()).hash, "#lesson=orbit", "and no link says so");
  const fetched = await opened.evaluate(() => performance.getEntriesByType("resource").map(({ name }) => name).filter((name) => name.endsWith(".json")));
  assert.deepEqual(fetched, [`${origin}/language/de.json`], "one language is fetched");
  const other = await context.newPage();
  await other.goto(`${origin}/#lesson=orbit&lang=en`);
  await other.waitForSelector(lesson.ready);
  assert.equal(await spokenIn(other), "en", "but a link has the last word");
});

pageTest("a language that there is not is English", { ...lesson, locale: "fr-FR" }, async (opened) => {
  assert.equal(await spokenIn(opened), "en");
});

pageTest("the language is changed on the page, keeps all that is set, and stays in every link after it",
  { hash: "#problem=kepler&initial.y=-3&until.t=20&A=leapfrog&B=leapfrog&B.step=0.02" }, async (opened) => {
    assert.equal(await opened.getByRole("combobox", { name: en.language }).inputValue(), "en");
    await opened.selectOption("#language", "de");
    await opened.waitForSelector("html[lang=de]");
    await settled(opened);
    assert.equal(new URL(opened.url()).hash, "#problem=kepler&initial.y=-3&until.t=20&A=leapfrog&B=leapfrog&B.step=0.02&lang=de");
    assert.equal(await stepOf(opened, "B").inputValue(), "0.02");
    assert.equal(await opened.textContent("#go"), de.run);
    await stepOf(opened, "B").fill("0,04"); // as it is written in German
    await stepOf(opened, "B").press("Enter");
    await opened.waitForURL(/B.step=0.04&lang=de$/);
    await opened.click("#to-lessons");
    await opened.waitForSelector(lesson.ready);
    await opened.waitForURL(/#lesson=orbit&lang=de$/);
    await opened.selectOption("#language", "en");
    await opened.waitForSelector("html[lang=en]");
    await opened.waitForURL(/#lesson=orbit&lang=en$/);
    await opened.goBack(); // to a link in the other language
    await settled(opened);
    assert.equal(await spokenIn(opened), "de");
    assert.deepEqual(await all(opened, "#language option", "lang"), ["en", "de"]);
  });

const down = (answer) => async (context) => {
  await context.route("**/v1/catalogue", answer);
  await context.route("**/language/en.json", async (route) => {
    await new Promise((resolve) => setTimeout(resolve, 400)); // the texts come later than the bad news
    return route.fallback();
  });
};
for (const [how, answer, said] of [["refuses", (route) => route.fulfill({ status: 503, body: "" }), en["answer.status"].replace("{status}", "503")],
                                   ["is silent", (route) => route.abort(), en["answer.silent"]]]) {
  pageTest(`a service that ${how} at first is said in a sentence, though the texts come later`,
    { prepare: down(answer), hash: "#lesson=orbit", ready: "main > .wrong[role=alert]:not(#notice)", expected: /./ }, async (page) => {
      assert.equal(await page.textContent("main > .wrong[role=alert]:not(#notice)"), `${en.failed} ${said}`);
    });
}
