// The form of a scene: its problem with parameters, its start, its span.
import { known, text } from "../language/texts.js";
import { columnsOf, eventsOf } from "../service/happenings.js";
import { linked, overrides } from "../service/text.js";
import { build, choose, clearFaults, element, prose, values, words } from "../forms/forms.js";
import { formulaOf } from "../forms/formula.js";
import { axes, cards, presetOf, spanOf, usualAxes } from "../catalogue/card.js";
import { arrangementOf, index, kindsOf } from "../catalogue/kinds.js";
import { statedColumns, statedViews } from "../catalogue/stated.js";

const find = (selector) => document.querySelector(selector);
const forms = { problem: find("#parameters"), initial: find("#initial"), until: find("#until"), record: find("#record"),
                columns: find("#columns"), events: find("#events") };
export const samples = { name: "samples", label: text("scene.samples"), default: 10000, doc: text("scene.samples.doc") };
const more = { name: "more", label: text("scene.columns"), type: "text", default: "", hint: "r = sqrt(x^2 + y^2)", doc: text("scene.columns.doc") };
const happenings = { ...more, label: text("scene.events"), hint: "apsis = x*px + y*py", doc: text("scene.events.doc") };
const back = { name: "back", label: text("scene.back"), type: "flag", default: false, doc: text("scene.back.doc") };
const axis = { x: find("#axes [name=x]"), y: find("#axes [name=y]"), z: find("#axes [name=z]") };
const view = find("#axes [name=view]"); // one of those that the scene states
const logs = { x: find("#axes [name=logx]"), y: find("#axes [name=logy]") };

const typed = (form) => values(form).more ?? "";

export class Scene {
  problem = null;
  preset = undefined;
  definition = null; // of a scene as text, as a request holds it
  fields = Object.values(forms);
  span = 0; // of a run, where none is set

  /** Sets every form to an experiment as a link holds it; what it leaves out takes its default. */
  load(problem, experiment, definition = null) {
    this.problem = problem;
    this.definition = definition;
    const preset = (this.preset = this.#offerPresets(experiment.preset?.id));
    const { parameters, initial } = cards(problem, preset);
    this.span = spanOf(problem, preset);
    build(forms.problem, parameters, "/problem", experiment.problem);
    build(forms.initial, initial, "/initial", experiment.initial);
    const until = { name: "t", label: text("scene.until"), default: this.start + this.span, doc: text("scene.until.doc") };
    build(forms.until, [until, back], "/until", experiment.until);
    build(forms.record, [samples], "/record", experiment.record);
    build(forms.columns, [more], "/columns", experiment.columns);
    build(forms.events, [happenings], "/events", experiment.events);
    forms.problem.parentElement.hidden = problem.parameters.length === 0;
    this.offerAxes(experiment.axes ?? {});
    find("#formula").replaceChildren(...(definition ? [] : formulaOf(problem.formula, Boolean(problem.form))));
    find("#summary").replaceChildren(...prose(known(`problem.${problem.id}.summary`) ?? problem.summary));
    find("#references ul").replaceChildren(...problem.references.map((textContent) => element("li", { textContent })));
  }

  /** Offers the problem's presets and picks one by name; the preset, or undefined for the problem's own values. */
  #offerPresets(name) {
    const preset = presetOf(this.problem, name);
    const options = this.problem.presets.map((offered) => ({ id: offered.name, title: words(offered.name) }));
    choose(find("#preset"), [{ id: "", title: text("preset.default") }, ...options], preset?.name);
    find("#presets").hidden = options.length === 0;
    find("#preset-doc").replaceChildren(...prose(preset?.doc ?? ""));
    return preset;
  }

  /** The typed columns and events in the form of a request. */
  get columns() {
    return columnsOf(typed(forms.columns));
  }
  get events() {
    return eventsOf(typed(forms.events));
  }

  offerAxes(chosen = { ...this.#chosen, log: this.log }) {
    const kinds = [...kindsOf(this.problem).keys()].map((id) => ({ id, title: text("axes.of_all", { name: id.slice(0, -1) }) }));
    const stated = statedColumns(this.problem).map(({ name, expression }) => ({ id: name, title: expression }));
    const options = [...axes(this.problem, this.columns), ...stated, ...kinds], known = (id) => options.some((option) => option.id === id);
    const usual = this.#usual(chosen.z);
    const across = [...options, ...(kinds.length ? [{ id: index, title: text("axes.index") }] : [])];
    choose(axis.x, across, known(chosen.x) || chosen.x === index ? chosen.x : usual.x);
    choose(axis.y, options, known(chosen.y) ? chosen.y : usual.y);
    choose(axis.z, [{ id: "", title: "–" }, ...options], chosen.z ?? usual.z);
    for (const name of ["x", "y"]) logs[name].checked = (chosen.log ?? "").includes(name);
    const views = (this.problem.views ?? []).map((view, i) => ({ id: String(i), title: view.toReversed().join(` ${text("axes.x")} `) }));
    choose(view, [{ id: "", title: text("axes.own") }, ...views], this.#viewNow());
    view.parentElement.hidden = views.length < 2;
  }

  /** Which of the views of the scene is shown. */
  #viewNow() {
    const at = statedViews(this.problem).findIndex((axes) => String(axes) === String(this.axes));
    return at < 0 ? "" : String(at);
  }

  /** Follows a change of the field `name` of the axes; choosing a view of the scene sets all axes. */
  turn(name) {
    const [x, y, z = ""] = statedViews(this.problem)[name === "view" ? view.value : -1] ?? this.axes;
    if (name === "view") this.offerAxes({ x, y, z });
    view.value = this.#viewNow();
  }

  /** The axes of the first picture, `z` the third of them that is chosen. */
  #usual(z) {
    const arranged = arrangementOf(this.problem), [x, y, third = ""] = arranged ?? [];
    return arranged ? { x, y, z: third } : usualAxes(this.problem, axes(this.problem).map(({ id }) => id), z);
  }

  get #chosen() {
    return Object.fromEntries(Object.entries(axis).map(([name, select]) => [name, select.value]));
  }

  /** The time of the start in the form, or its default. */
  get start() {
    const field = forms.initial.querySelector("[data-name=t]"), given = Number(field.value.trim() || field.placeholder);
    return Number.isFinite(given) ? given : 0;
  }

  /** Moves the default end with the start; an end that was set stays. */
  moveEnd() {
    const field = forms.until.querySelector("[data-name=t]"), own = "t" in this.ownEnd;
    field.placeholder = field.dataset.usual = String(this.start + this.span);
    if (!own) field.value = field.placeholder;
  }

  /** The settings of the end: its time, if not the default, and whether runs go back from it. */
  get ownEnd() {
    return values(forms.until, true);
  }

  /** The columns on the axes, `[x, y]` or in space `[x, y, z]`; their labels; the logarithmic ones. */
  get axes() {
    return Object.values(this.#chosen).filter(Boolean);
  }
  get labels() {
    return Object.values(axis).filter(({ value }) => value).map((select) => select.selectedOptions[0].textContent.replace(text("axes.of_all", { name: "" }), ""));
  }
  get log() {
    return ["x", "y"].filter((name) => logs[name].checked).join("");
  }

  /** The sections of an experiment as the forms stand; of `changed` ones, only what has not its default. */
  values(changed = false) {
    const { problem, ...rest } = Object.fromEntries(Object.entries(forms).map(([name, form]) => [name, values(form, changed)]));
    const preset = find("#preset").value, [x, y, z = ""] = this.axes, log = this.log;
    const usual = this.#usual(z), own = (name, value) => (changed && value === usual[name] ? {} : { [name]: value });
    const seen = { ...own("x", x), ...own("y", y), ...own("z", z), ...(log ? { log } : {}) };
    const problemOf = this.definition ? linked(this.definition) : { id: this.problem.id };
    return { problem: { ...problemOf, ...problem }, ...(preset ? { preset: { id: preset } } : {}), ...rest, axes: seen };
  }

  /** The problem as a request holds it. */
  asked({ id, ...parameters }, preset) {
    if (this.definition) return { ...this.definition, ...overrides(this.definition, values(forms.problem)) };
    return { id, ...(preset ? { preset: preset.id } : {}), ...parameters };
  }

  /** Moves the start to values by name, or the parameters of the problem. */
  begin(at, section = "initial") {
    for (const [name, value] of Object.entries(at)) {
      const field = forms[section].querySelector(`[data-name="${CSS.escape(name)}"]`);
      if (!field) continue;
      field.value = String(value ?? "");
      field.dispatchEvent(new Event("input"));
    }
    if (section === "initial" && "t" in at) this.moveEnd();
  }

  /** Starts where a run ended, for as long again. */
  goOn(final) {
    const end = forms.until.querySelector("[data-name=t]"), span = Number(end.value) - this.start;
    this.begin(final);
    end.value = String(final.t + span);
  }

  clearFaults() {
    this.fields.forEach(clearFaults);
  }
}
