// The page: one scene, two runs of it. Any change makes new requests and drops those under way.
import * as api from "./api.js";
import { axes, cards, columns, diagnostics, energyKind, presetOf } from "./card.js";
import { EnergyPlot } from "./energy.js";
import { build, choose, clearFaults, element, values, words } from "./forms.js";
import { fromHash, toHash } from "./link.js";
import { Pane } from "./pane.js";
import { commonView, curveOf } from "./plane.js";
import { Studies } from "./studies.js";
import { fill } from "./table.js";

// What the page shows first: five revolutions of the orbit of Nair, Ober-Blöbaum & Marsden.
const opening = "#problem=kepler&until.t=95";

const find = (selector) => document.querySelector(selector);
const scene = { problem: find("#parameters"), initial: find("#initial"), until: find("#until"), record: find("#record") };
const panes = [new Pane("A", 1), new Pane("B", 2)];
const energy = new EnergyPlot(find("#energy"));
const samples = { name: "samples", label: "points drawn", default: 10000,
                  doc: "how many points of each run are drawn, at most" };
const axis = { x: find("#axes [name=x]"), y: find("#axes [name=y]") };
let catalogue, problem, studies, underWay = null, scheduled = 0;
let outcomes = null; // those in sight, null while there are none of this problem

/** Sets every form to an experiment as a link holds it; what it leaves out takes its default. */
function load(experiment) {
  const known = (id) => catalogue.problems.find((candidate) => candidate.id === id);
  problem = known(experiment.problem?.id) ?? catalogue.problems[0];
  outcomes = null;
  choose(find("#problem"), catalogue.problems, problem.id);
  const preset = offerPresets(experiment.preset?.id);
  const { parameters, initial } = cards(problem, preset);
  build(scene.problem, parameters, "/problem", experiment.problem);
  build(scene.initial, initial, "/initial", experiment.initial);
  const until = { name: "t", label: "until t", default: start() + problem.until.t, doc: "when the run ends" };
  build(scene.until, [until], "/until", experiment.until);
  build(scene.record, [samples], "/record", experiment.record);
  scene.problem.parentElement.hidden = problem.parameters.length === 0;
  offerAxes(experiment.axes);
  const formula = new DOMParser().parseFromString(problem.formula, "text/html").querySelector("math");
  formula?.setAttribute("display", "block");
  find("#formula").replaceChildren(...(formula ? [document.importNode(formula, true)] : []));
  find("#formula").classList.toggle("long", formula?.textContent.length > 30);
  find("#summary").textContent = problem.summary;
  find("#references ul").replaceChildren(...problem.references.map((textContent) => element("li", { textContent })));
  for (const pane of panes) pane.offer(problem, catalogue.schemes, experiment[pane.name]);
  request();
}

/** Offers the problem's presets and picks one by name; the preset, or undefined for the problem's own values. */
function offerPresets(name) {
  const preset = presetOf(problem, name);
  const options = problem.presets.map((offered) => ({ id: offered.name, title: words(offered.name) }));
  choose(find("#preset"), [{ id: "", title: "default" }, ...options], preset?.name);
  find("#presets").hidden = options.length === 0;
  find("#preset-doc").textContent = preset?.doc ?? "";
  return preset;
}

function offerAxes(chosen = {}) {
  const options = axes(problem);
  const known = (id) => options.some((option) => option.id === id);
  choose(axis.x, options, known(chosen.x) ? chosen.x : options[0].id);
  choose(axis.y, options, known(chosen.y) ? chosen.y : options[1].id);
}

/** When the run starts, as the form says or else its default. */
function start() {
  const field = scene.initial.querySelector("[data-name=t]");
  const given = Number(field.value.trim() || field.placeholder);
  return Number.isFinite(given) ? given : 0;
}

/** The default end follows the start; an end of one's own stays. */
function moveEnd() {
  const field = scene.until.querySelector("[data-name=t]");
  const own = ownEnd();
  field.placeholder = String(start() + problem.until.t);
  if (!own) field.value = field.placeholder;
}

/** The end, where it is not the default one. */
function ownEnd() {
  const { value, placeholder } = scene.until.querySelector("[data-name=t]");
  return value.trim() === placeholder ? undefined : values(scene.until);
}

/** The experiment as the forms stand. */
function experiment() {
  const sections = Object.entries(scene).map(([section, form]) => [section, values(form)]);
  const { problem: parameters, ...rest } = Object.fromEntries(sections);
  const preset = find("#preset").value;
  const runs = Object.fromEntries(panes.map((pane) => [pane.name, pane.chosen()]));
  return { problem: { id: problem.id, ...parameters }, ...(preset ? { preset: { id: preset } } : {}), ...rest,
           axes: { x: axis.x.value, y: axis.y.value }, ...runs };
}

/** The scene as it stands in a request. */
function sceneOf({ problem: { id, ...parameters }, preset, initial, until }) {
  return { problem: { id, ...(preset ? { preset: preset.id } : {}), ...parameters }, initial, until };
}

/** What the studies ask for. */
function studied() {
  const now = experiment();
  return { scene: sceneOf(now), schemes: panes.map(({ name }) => now[name]).filter(({ id }) => id !== "auto") };
}

/**
 * The request for one run: every N-th step, so that drawn points are states the scheme was in; N cannot be said of a
 * scheme that sets its own clock.
 */
function requestFor(now, scheme) {
  const { problem: named, initial, until } = sceneOf(now);
  const { samples: most = samples.default } = now.record;
  const span = (until.t ?? start() + problem.until.t) - start();
  const card = catalogue.schemes.find((known) => known.id === scheme.id);
  const every = card?.own_clock ? NaN : Math.max(1, Math.ceil(span / scheme.step / most));
  return { problem: named, initial, scheme, until,
           record: most >= 2 && Number.isSafeInteger(every) ? { every } : { samples: most },
           columns: columns(problem, card), diagnostics: diagnostics(problem) };
}

/** Asks for a run soon; several changes at once make one. */
function request() {
  find("#results").setAttribute("aria-busy", "true");
  clearTimeout(scheduled);
  scheduled = setTimeout(run, 0);
}

async function run() {
  underWay?.abort();
  const mine = (underWay = new AbortController());
  const now = experiment();
  history.replaceState(null, "", toHash(now));
  studies.follow();
  find("#status").textContent = "Running…";
  Object.values(scene).forEach(clearFaults);
  panes.forEach((pane) => pane.clearFaults());
  try {
    const answers = await Promise.all(panes.map((pane) =>
      pane.run(requestFor(now, now[pane.name]), Object.values(scene), mine.signal)));
    if (mine === underWay) show(answers);
  } catch (error) {
    if (mine.signal.aborted) return;
    find("#status").textContent = `The page has a fault: ${error.message}`;
    find("#results").setAttribute("aria-busy", "false");
    throw error;
  }
}

function show(answers) {
  outcomes = answers;
  const runs = panes.map(({ name, title, colour }, i) => ({ name, title: `${name}: ${title}`, colour, outcome: outcomes[i],
                                                           trajectory: outcomes[i]?.trajectory }));
  const done = runs.filter((run) => run.outcome);
  showPlanes();
  const { title, what, note } = energy.show(energyKind(problem), done);
  find("#energy-name").textContent = title;
  find("#energy-what").textContent = what;
  find("#energy-note").textContent = note;
  fill(find("#numbers"), done, problem);
  const refused = "refused: see the marked fields";
  find("#status").textContent = runs.map(({ name, outcome }) => `${name} ${outcome?.status ?? refused}`).join(", ");
  find("#results").setAttribute("aria-busy", "false");
}

/** The outcomes over the chosen axes. */
function showPlanes() {
  const names = [axis.x.value, axis.y.value];
  const curves = outcomes.map((outcome) => outcome && curveOf(outcome.trajectory, ...names));
  const view = commonView(curves.filter(Boolean), ["x", "y"].filter((_, i) => names[i] === "t"));
  const labels = [axis.x, axis.y].map((select) => select.selectedOptions[0].textContent);
  panes.forEach((pane, i) => pane.show(curves[i], labels, view));
}

function listen() {
  find("#experiment").addEventListener("submit", (event) => {
    event.preventDefault();
    request();
  });
  find("#problem").addEventListener("change", (event) => {
    const kept = Object.fromEntries(panes.map((pane) => [pane.name, { id: pane.chosen().id }]));
    load({ problem: { id: event.target.value }, ...kept });
  });
  find("#preset").addEventListener("change", (event) => {
    const { record, axes: seen, A, B } = experiment();
    load({ problem: { id: problem.id }, preset: { id: event.target.value }, until: ownEnd(), record, axes: seen, A, B });
  });
  scene.initial.addEventListener("change", (event) => {
    if (event.target.dataset.name === "t") moveEnd();
  });
  find("#axes").addEventListener("change", () => {
    history.replaceState(null, "", toHash(experiment()));
    if (outcomes) showPlanes();
  });
  find("#experiment").addEventListener("change", (event) => {
    if (!event.target.closest("#problem, #preset, #axes, #studies")) request();
  });
  addEventListener("hashchange", () => load(fromHash(location.hash || opening)));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    panes.forEach((pane) => pane.plane.draw());
    energy.draw();
    studies.draw();
  });
}

try {
  catalogue = await api.catalogue();
  studies = new Studies(catalogue.schemes, studied);
  find("#panes").replaceChildren(...panes.map((pane) => pane.node));
  listen();
  load(fromHash(location.hash || opening));
} catch (error) {
  find("#status").textContent = `The page could not start: ${error.message}`;
}
