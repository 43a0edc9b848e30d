// The page: lessons, and the workbench behind them. The address says which is shown, and the browser's "back" undoes.
import * as api from "./service/api.js";
import { fromHash, lessonHash, lessonOf, presenting, presents } from "./service/link.js";
import { custom } from "./service/text.js";
import { element } from "./forms/forms.js";
import { translated } from "./catalogue/translated.js";
import { fill, learnCatalogue, offer, ready } from "./language/spoken.js";
import { inLanguage, known, language, languageOf, text } from "./language/texts.js";
import { Lesson } from "./lessons/lesson.js";
import { lessons } from "./lessons/lessons.js";

const find = (selector) => document.querySelector(selector);
let bench = null, coming = null, lesson = null, shown = null, at = "";

/** The workbench, fetched when first needed, so that a lesson, with which most readers begin, is shown sooner. */
function workbench(catalogue) {
  coming ??= Promise.all([import("./workbench/bench.js"), learnCatalogue()]).then(([{ Bench }]) => (bench = new Bench(translated(catalogue), note)));
  return coming;
}

/**
 * Puts `hash` into the address, as a step that can be undone unless `quietly`, for the same state written out. An address that
 * has changed meanwhile stays, because its state is about to be shown.
 */
function note(asked, quietly) {
  const hash = inLanguage(presenting(asked, isPresenting()), languageOf(at));
  if (hash === location.hash || location.hash !== at) return;
  if (quietly) history.replaceState(history.state, "", hash);
  else history.pushState({ steps: steps() + 1 }, "", hash);
  at = location.hash;
  find("#undo").disabled = steps() === 0;
}

/** Whether the page is in presentation mode, which shows only the scene, its pictures and the controls. */
const isPresenting = () => document.documentElement.classList.contains("present");

function present(on) {
  document.documentElement.classList.toggle("present", on);
  for (const button of document.querySelectorAll("[data-presents]")) button.textContent = text(on ? "leave" : "present");
  at = presenting(location.hash || first, on);
  if (at !== location.hash) history.replaceState(history.state, "", at);
  shown?.draw();
}

/** The first lesson, which an address without any opens. */
const first = lessonHash(lessons[0].id);

/** By a hand: of a browser that can, the whole screen. */
async function turnPresenting(on) {
  present(on);
  if (on) find(shown === lesson ? "#claim" : "#present-bench").focus();
  if (on) await document.documentElement.requestFullscreen?.().catch(() => {}); // a page in a frame may not
  else if (document.fullscreenElement) await document.exitFullscreen().catch(() => {});
}

/** The number of steps of this page that can be undone. */
const steps = () => history.state?.steps ?? 0;

/** Ctrl+Z where it does not belong to a text that is being typed; the step to go back to stands in the address. */
function undoes(event) {
  const { key, ctrlKey, metaKey, shiftKey, target } = event;
  if (key !== "z" || !(ctrlKey || metaKey) || shiftKey || target.closest("input[type=text], textarea") || !steps()) return false;
  event.preventDefault();
  return true;
}

function tell(text) {
  find("#notice").textContent = text;
  find("#notice").hidden = !text;
}

function openLesson(id, state, moved = false) {
  note(lessonHash(id, state), moved);
  if (moved) return;
  show(lesson, "#lesson");
  tell(lesson.open(id, state) ? "" : text("lesson.unknown", { id }));
}

function show(part, selector) {
  if (shown !== part) shown?.close();
  shown = part; // null while the workbench is still to come
  for (const section of ["#lesson", "#experiment"]) find(section).hidden = section !== selector;
  find("#to-lessons").ariaCurrent = selector === "#lesson" ? "page" : null;
  find("#to-workbench").ariaCurrent = selector === "#lesson" ? null : "page";
}

/** Shows what the address says; a step back, which has a state, leads neither into a presentation nor out of it. */
async function route(catalogue, opened = false) {
  const spoken = languageOf(at); // stays, where a link within the page does not say it again
  if (spoken && !languageOf(location.hash)) history.replaceState(history.state, "", inLanguage(location.hash || first, spoken));
  at = location.hash;
  if ((languageOf(at) ?? language()) !== language()) return location.reload();
  present(opened || history.state === null ? presents(at) : isPresenting());
  if (history.state === null) history.replaceState({ steps: 0 }, "", at || location.href);
  find("#undo").disabled = steps() === 0;
  const asked = inLanguage(presenting(at, false)) || first, link = lessonOf(asked);
  if (link) {
    show(lesson, "#lesson");
    return tell(lesson.open(link.id, link.state) ? "" : text("lesson.unknown", { id: link.id }));
  }
  const { experiment, unread } = fromHash(asked), { id } = experiment.problem ?? {};
  const known = catalogue.problems.some((problem) => problem.id === id) || id === custom;
  const wrong = [...(id && !known ? [`problem=${id}`] : []), ...unread];
  tell(wrong.length ? text("link.unread", { what: wrong.join(", ") }) : "");
  show(bench, "#experiment");
  const asking = at;
  await workbench(catalogue);
  if (at !== asking) return; // it has changed meanwhile
  show(bench, "#experiment");
  bench.load(experiment);
}

function fail(error) {
  find("main").prepend(element("p", { className: "wrong", role: "alert", textContent: `${known("failed") ?? ""} ${error.message}` }));
  throw error;
}

try {
  const catalogue = await api.catalogue(ready);
  fill(document);
  offer(find("#language"), first);
  lesson = new Lesson(catalogue, openLesson);
  addEventListener("hashchange", () => route(catalogue).catch(fail));
  addEventListener("keydown", (event) => {
    if (undoes(event)) history.back();
    else if (event.key === "Escape" && isPresenting()) turnPresenting(false);
    else shown?.key(event);
  });
  addEventListener("fullscreenchange", () => document.fullscreenElement || !isPresenting() || present(false));
  for (const button of document.querySelectorAll("[data-presents]")) button.addEventListener("click", () => turnPresenting(!isPresenting()));
  find("#skip").addEventListener("click", () => find(shown === lesson ? "#claim" : "#problem").focus());
  find("#undo").addEventListener("click", () => history.back());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => [bench, lesson].forEach((part) => part?.draw()));
  await route(catalogue, true);
} catch (error) {
  fail(error);
}
