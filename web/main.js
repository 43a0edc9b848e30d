// The page: one scene, two runs of it. Any change makes new requests and drops those under way.
import * as api from "./api.js";
import { EnergyPlot } from "./energy.js";
import { build, choose, clearFaults, element, values } from "./forms.js";
import { fromHash, toHash } from "./link.js";
import { Pane } from "./pane.js";
import { box, commonView } from "./plane.js";
import { fill } from "./table.js";

// What the page shows first: five revolutions of the orbit of Nair, Ober-Blöbaum & Marsden.
const opening = "#problem=kepler&until.t=95";

const find = (selector) => document.querySelector(selector);
const scene = { problem: find("#parameters"), initial: find("#initial"), until: find("#until"), record: find("#record") };
const panes = [new Pane("A", 1), new Pane("B", 2)];
const energy = new EnergyPlot(find("#energy"));
const samples = { name: "samples", label: "points drawn", default: 10000,
                  doc: "how many points of each run are drawn, at most" };
const end = ({ until }) => until.t ?? until; // the default span, as a part of a request or as a bare time
let catalogue, problem, underWay = null, scheduled = 0;

/** Sets every form to an experiment as a link holds it; what it leaves out takes its default. */
function load(experiment) {
  const known = (id) => catalogue.problems.find((candidate) => candidate.id === id);
  problem = known(experiment.problem?.id) ?? catalogue.problems[0];
  choose(find("#problem"), catalogue.problems, problem.id);
  const until = { name: "t", label: "until t", default: end(problem), doc: "when the run ends" };
  const cards = { problem: problem.parameters, initial: problem.variables, until: [until], record: [samples] };
  for (const section in cards) build(scene[section], cards[section], `/${section}`, experiment[section]);
  scene.problem.parentElement.hidden = problem.parameters.length === 0;
  const formula = new DOMParser().parseFromString(problem.formula, "text/html").querySelector("math");
  formula?.setAttribute("display", "block");
  find("#formula").replaceChildren(...(formula ? [document.importNode(formula, true)] : []));
  find("#formula").classList.toggle("long", formula?.textContent.length > 30);
  find("#summary").textContent = problem.summary;
  find("#references ul").replaceChildren(...problem.references.map((textContent) => element("li", { textContent })));
  for (const pane of panes) pane.offer(problem, catalogue.schemes, experiment[pane.name]);
  request();
}

/** The experiment as the forms stand. */
function experiment() {
  const sections = Object.entries(scene).map(([section, form]) => [section, values(form)]);
  const { problem: parameters, ...rest } = Object.fromEntries(sections);
  const runs = Object.fromEntries(panes.map((pane) => [pane.name, pane.chosen()]));
  return { problem: { id: problem.id, ...parameters }, ...rest, ...runs };
}

/** The request for one run: every N-th step, so that drawn points are states the scheme was in. */
function requestFor({ problem: mechanics, initial, until, record }, scheme) {
  const { samples: most = samples.default } = record;
  const every = Math.max(1, Math.ceil((until.t ?? end(problem)) / scheme.step / most));
  const wanted = ["energy", "momenta", "orbit"].filter((kind) => problem.diagnostics.includes(kind));
  return { problem: mechanics, initial, scheme, until,
           record: most >= 2 && Number.isSafeInteger(every) ? { every } : { samples: most },
           columns: ["t", ...problem.variables.map((variable) => variable.name), "energy"], diagnostics: wanted };
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
  find("#status").textContent = "Running…";
  Object.values(scene).forEach(clearFaults);
  panes.forEach((pane) => pane.clearFaults());
  try {
    const outcomes = await Promise.all(panes.map((pane) =>
      pane.run(requestFor(now, now[pane.name]), Object.values(scene), mine.signal)));
    if (mine === underWay) show(outcomes);
  } catch (error) {
    if (mine.signal.aborted) return;
    find("#status").textContent = `The page has a fault: ${error.message}`;
    find("#results").setAttribute("aria-busy", "false");
    throw error;
  }
}

function show(outcomes) {
  const runs = panes.map(({ name, title, colour }, i) => ({ name, title: `${name}: ${title}`, colour, outcome: outcomes[i],
                                                           trajectory: outcomes[i]?.trajectory }));
  const done = runs.filter((run) => run.outcome);
  const axes = problem.variables.slice(0, 2);
  const curves = outcomes.map((outcome) => (outcome?.trajectory.t.length
    ? { x: outcome.trajectory[axes[0].name], y: outcome.trajectory[axes[1].name] } : null));
  const view = commonView(curves.filter(Boolean).map(box));
  panes.forEach((pane, i) => pane.show(curves[i], axes, view));
  const { what, note } = energy.show(done.filter((run) => run.trajectory.t.length));
  find("#energy-what").textContent = what;
  find("#energy-note").textContent = note;
  fill(find("#numbers"), done, problem);
  const refused = "refused: see the marked fields";
  find("#status").textContent = runs.map(({ name, outcome }) => `${name} ${outcome?.status ?? refused}`).join(", ");
  find("#results").setAttribute("aria-busy", "false");
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
  find("#experiment").addEventListener("change", (event) => {
    if (event.target.id !== "problem") request();
  });
  addEventListener("hashchange", () => load(fromHash(location.hash || opening)));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    panes.forEach((pane) => pane.plane.draw());
    energy.draw();
  });
}

try {
  catalogue = await api.catalogue();
  find("#panes").replaceChildren(...panes.map((pane) => pane.node));
  listen();
  load(fromHash(location.hash || opening));
} catch (error) {
  find("#status").textContent = `The page could not start: ${error.message}`;
}
