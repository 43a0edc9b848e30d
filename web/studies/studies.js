// The studies of a scene, each asked for by a button: what a digit costs with each scheme, how long a step may be, and those that
// stand by themselves, of many runs or of the neighbours of one.
import { known, text } from "../language/texts.js";
import * as api from "../service/api.js";
import { element, faultText, words } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { title } from "../catalogue/card.js";
import { PrecisionPlot } from "../drawing/precision.js";
import { Basins } from "./basins.js";
import { Closed } from "./closed.js";
import { Section } from "./section.js";
import { Sweep } from "./sweep.js";
import { Tangent } from "./tangent.js";

const find = (selector) => document.querySelector(selector);

const choices = ["measured", "measure", "cost", "budget"];
const usual = (select) => ([...select.options].find((option) => option.defaultSelected) ?? select.options[0]).value;

export class Studies {
  #schemes = [];
  #ask; // → {problem, initial, until} of a request, and the schemes of the panes
  #scene = "";
  #underWay = {};
  #plot = new PrecisionPlot(find("#precision"));
  #others; // by name: what each of them has in a link, too

  /**
   * `ask()` gives `{scene: {problem, initial, until}, events, schemes}` as the forms stand; `picked(values, section)`: a member is
   * to be run, which differs in these values of its "initial", its "problem" or its "until"; `over([{trajectory, colour, dash}])`
   * is to be drawn over the runs.
   */
  constructor(schemes, ask, picked, over) {
    const run = (values, section = "initial") => {
      picked(values, section);
      this.#scene = JSON.stringify(this.#ask().scene); // what was found stays
    };
    this.#others = { section: new Section(run), basins: new Basins(run), tangent: new Tangent(), sweep: new Sweep(run), closed: new Closed(run, over) };
    this.#schemes = schemes;
    this.#ask = ask;
    find("#measure-precision").addEventListener("click", () => this.#start("precision", () => this.#measure()));
    find("#measure-stability").addEventListener("click", () => this.#start("stability", () => this.#search()));
    for (const [study, runs] of Object.entries(this.#others))
      find(`#measure-${study}`).addEventListener("click", () => this.#start(study, () =>
        runs.measure(this.#ask(), this.#schemes, this.#underWay[study].signal, (said) => this.#tell(study, said))));
    find("#cost").addEventListener("change", (event) => this.#plot.over(event.target.value));
    find("#close-orbit").addEventListener("click", () => find("#measure-closed").click());
  }

  /** The results belong to one scene: for another scene they are removed, and studies under way are ended. */
  follow() {
    const scene = JSON.stringify(this.#ask().scene);
    if (scene === this.#scene) return;
    this.#scene = scene;
    for (const study of ["precision", "stability", ...Object.keys(this.#others)]) {
      this.#stop(study);
      this.#tell(study, "");
    }
    this.#plot.start([]);
    for (const study of Object.values(this.#others)) study.clear();
    find("#stability").replaceChildren();
    find("#precision-notes").replaceChildren();
  }

  draw() {
    this.#plot.draw();
    for (const study of Object.values(this.#others)) study.draw();
  }

  /** The studies in a link: their choices, and the values set for those of a problem. */
  offer(problem, { study = {}, ...wanted }) {
    this.choices = study;
    for (const [name, other] of Object.entries(this.#others)) other.offer(problem, wanted[name]);
  }
  chosen(changed) {
    return { study: this.choices, ...Object.fromEntries(Object.entries(this.#others).map(([name, other]) => [name, other.chosen(changed)])) };
  }

  /** The choices of what to measure that differ from the default. */
  get choices() {
    return Object.fromEntries(choices.map((id) => find(`#${id}`)).filter((select) => select.value !== usual(select))
      .map((select) => [select.id, select.value]));
  }
  set choices(wanted) {
    for (const select of choices.map((id) => find(`#${id}`))) {
      const known = [...select.options].some(({ value }) => value === wanted[select.id]);
      select.value = known ? wanted[select.id] : usual(select);
    }
    this.#plot.over(find("#cost").value);
  }

  /** The button begins a study, or ends the one under way. */
  async #start(study, begin) {
    if (this.#stop(study)) return this.#tell(study, text("stopped"));
    this.#scene = JSON.stringify(this.#ask().scene);
    const mine = (this.#underWay[study] = new AbortController());
    const button = find(`#measure-${study}`), name = button.textContent;
    button.textContent = text("stop");
    try {
      const { faults = [], said = "" } = await begin();
      this.#tell(study, faults.length ? faults.map(fault).join(" ") : said, faults.length > 0);
    } catch (error) {
      if (!mine.signal.aborted) throw error;
    } finally {
      button.textContent = name;
      if (this.#underWay[study] === mine) delete this.#underWay[study];
    }
  }

  #stop(study) {
    const under = this.#underWay[study];
    delete this.#underWay[study];
    under?.abort();
    return Boolean(under);
  }

  #tell(study, said, bad = false) {
    const line = find(`#${study}-status`);
    line.textContent = said;
    line.classList.toggle("fault", bad);
  }

  #title(scheme, varied) {
    const { [varied]: _, ...settings } = scheme;
    if (varied === "theta") delete settings.step;
    return title(this.#schemes.find(({ id }) => id === scheme.id), settings);
  }

  async #measure() {
    const { scene, schemes } = this.#ask();
    const request = { ...scene, schemes: find("#measured").value === "all" ? "all" : schemes, error: find("#measure").value,
                      budget_seconds: Number(find("#budget").value) };
    this.#plot.start([]);
    this.#tell("precision", text("precision.truth"));
    find("#precision-notes").replaceChildren();
    let head = null, end = null, points = 0;
    const take = (line) => {
      if (line.point) {
        this.#plot.add(line.curve, { ...line.point, setting: line.setting });
        this.#tell("precision", text("precision.so_far", { n: ++points }));
      } else if (head) {
        end = line;
      } else {
        head = line;
        this.#plot.start(head.schemes.map((scheme) => this.#title(scheme, varied(scheme))), head.floor);
      }
    };
    const { faults } = await api.workPrecision(request, this.#underWay.precision.signal, take);
    if (faults) return { faults };
    const notes = [...concerning(head), ...end.curves.flatMap((curve) => this.#ordered(curve)), ...end.left_out];
    const listed = (some) => element("ul", { className: "messages" }, ...some.map((textContent) => element("li", { textContent })));
    const [first, ...more] = notes;
    find("#precision-notes").replaceChildren(listed([first]), ...(more.length ? [
      element("details", {}, element("summary", { textContent: text("precision.notes", { n: more.length }) }), listed(more))] : []));
    return { said: text("precision.done", { n: points }) + (end.status === "stopped" ? ` ${text("precision.cut")}` : "") };
  }

  /** A note on a curve whose order is not the declared one, or could not be measured. */
  #ordered({ scheme, setting, observed_order: observed, expected_order: expected, why }) {
    const name = this.#title(scheme, setting);
    if (observed === null) return why ? [`${name}: ${why}`] : [];
    if (expected === null || Math.abs(observed - expected) < 0.3) return [];
    return [text("precision.order", { name, observed: format(observed), expected })];
  }

  async #search() {
    const { until: _, ...scene } = this.#ask().scene;
    this.#tell("stability", text("stability.searching"));
    find("#stability").replaceChildren();
    const { outcome, faults } = await api.stability({ ...scene, schemes: "all" }, this.#underWay.stability.signal);
    if (faults) return { faults };
    const cells = (tag, ...texts) => texts.map((textContent) => element(tag, { textContent }));
    const rows = outcome.limits.map(({ scheme, step, failure, theory, why = "" }) => {
      const beyond = failure ? known(`failure.${failure}`) ?? words(failure) : why;
      return element("tr", {}, element("th", { scope: "row", textContent: this.#title(scheme, varied(scheme)) }),
                     ...cells("td", format(step), format(theory), beyond));
    });
    find("#stability").replaceChildren(
      element("thead", {}, element("tr", {}, ...cells("th", ...["scheme", "step", "theory", "beyond"].map((name) => text(`stability.${name}`))))),
      element("tbody", {}, ...rows));
    return { said: outcome.left_out.join("; ") };
  }
}

const fault = ({ pointer, ...rest }) => `${pointer ? `${pointer}: ` : ""}${faultText(rest)}`;

/** The setting that a study varies. */
const varied = (scheme) => ["tolerance", "theta", "sigma", "step"].find((name) => name in scheme);

/** The words about the reference solution and the scene. */
function concerning({ reference, floor, chaotic, end, until }) {
  return [
    text("precision.reference", { what: known(`precision.how.${reference.how.replaceAll(" ", "_")}`) ?? reference.how,
                                  uncertainty: format(reference.uncertainty, 1), floor: format(floor, 1) }),
    ...(chaotic ? [text("precision.chaotic")] : []),
    ...(end < until.t ? [text("precision.ends", { t: format(end, 5) })] : []),
  ];
}
