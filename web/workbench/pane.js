// One run of the comparison: its scheme and the form for it, its request, its picture and what went wrong.
import { count, known, text } from "../language/texts.js";
import { follow } from "../service/api.js";
import { names } from "../service/link.js";
import { workSetting } from "../service/work.js";
import { build, choose, clearFaults, element, faultText, leadTo, prose, showFault, values, words } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { colourOf, fineness, presetOf, schemeCards, schemePresets, title, usualScheme } from "../catalogue/card.js";
import { Plane } from "../drawing/plane.js";
import { programs } from "./programs.js";

export class Pane {
  #schemes = [];
  #problem = null;
  #part;
  #request = null;

  /**
   * `name` is A to F; `refine` divides the suggested step, of whatever kind it is; `hovered(t)` hears at which time of the
   * run a hand points.
   */
  constructor(name, refine, hovered) {
    this.name = name;
    this.refine = refine;
    this.colour = colourOf(names.indexOf(name));
    this.node = document.querySelector("#pane").content.cloneNode(true).firstElementChild;
    this.node.dataset.run = name;
    const find = (selector) => this.node.querySelector(selector);
    this.#part = { scheme: find(".scheme"), preset: find(".preset"), fields: find(".parameters"), traits: find(".traits"),
                   messages: find(".messages"), caption: find("figcaption .title"), canvas: find("canvas"),
                   stretches: find("figcaption .stretches"), happened: find("figcaption .happened"), work: find("figcaption .work"),
                   about: find(".about div"), curl: find(".curl pre"),
                   language: find(".curl select") };
    find(".badge").textContent = name;
    find(".badge").setAttribute("aria-label", text("pane.run", { name }));
    choose(this.#part.language, Object.keys(programs).map((id) => ({ id, title: id })));
    this.#part.language.addEventListener("change", () => this.#spell());
    this.plane = new Plane(this.#part.canvas, hovered);
    this.#part.scheme.addEventListener("change", () => this.#rebuild(this.chosen()));
    this.#part.preset.addEventListener("change", () => this.#rebuild(this.#keptBeside(this.#part.preset.value)));
    find(".curl button").addEventListener("click", (event) => this.#copy(event.target));
  }

  /** Offers the schemes that fit the problem; `chosen` (`{id, …}`) wins over the usual comparison. */
  offer(problem, schemes, chosen = {}) {
    this.#problem = problem;
    this.#schemes = schemes.filter((scheme) => problem.schemes.includes(scheme.id));
    const named = (id) => this.#schemes.find((s) => s.id === id);
    const usual = named(usualScheme(problem)) ?? this.#schemes.find((s) => s.structure !== "none") ?? named("runge_kutta_4");
    const { id = usual?.id } = chosen;
    const fits = named(id) !== undefined;
    choose(this.#part.scheme, this.#schemes, fits ? id : usual?.id);
    this.#rebuild(fits ? chosen : {});
  }

  get #scheme() {
    return this.#schemes.find((scheme) => scheme.id === this.#part.scheme.value);
  }

  /** The scheme as it stands in a request. */
  chosen(changed = false) {
    const preset = this.#part.preset.value, usual = schemePresets(this.#scheme)[0].id;
    return { id: this.#part.scheme.value, ...(preset && !(changed && preset === usual) ? { preset } : {}),
             ...values(this.#part.fields, changed) };
  }

  /** Sets how fine the run is, by the setting to which its work is inversely proportional. */
  refineTo(value) {
    this.#part.fields.querySelector(`[data-name=${workSetting(this.chosen())}]`).value = String(value);
  }

  /** The settings that stay when another preset is chosen: only those for how fine the run is, unless the preset has them. */
  #keptBeside(preset) {
    const { parameters = {} } = presetOf(this.#scheme, preset) ?? {};
    const kept = Object.entries(this.chosen()).filter(([name]) => fineness.includes(name) && !(name in parameters));
    return { ...Object.fromEntries(kept), preset };
  }

  #rebuild(chosen) {
    const scheme = this.#scheme, preset = presetOf(scheme, chosen.preset);
    choose(this.#part.preset, schemePresets(scheme), preset?.name);
    this.#part.preset.title = preset?.doc ?? "";
    this.#part.preset.parentElement.hidden = scheme.presets.length === 0;
    build(this.#part.fields, schemeCards(scheme, this.#problem, preset, this.refine), "/scheme", chosen);
    const say = (key, said) => (said ? element("p", {}, element("b", { textContent: `${text(`about.${key}`)} ` }), ...prose(said)) : "");
    const composed = scheme.recommended ? words(Object.values(scheme.recommended).join(", ")) : "";
    this.#part.about.replaceChildren(
      element("p", {}, ...prose(scheme.summary)), say("good", scheme.good_for), say("fails", scheme.fails_when),
      say("order", orders(scheme.order)), say("composition", composed),
      say("source", (scheme.references ?? []).join("; ")));
  }

  /** Runs `request`: `{outcome}`, null when the service refused it, and whether it is `lost`; `take(outcome)` on the way. */
  async run(request, sceneFields, signal, take) {
    this.#entitle(request.scheme);
    this.#request = request;
    this.#spell();
    const { outcome = null, faults = [] } = await follow(request, signal, take);
    if (outcome?.choice) this.#entitle(outcome.scheme, "auto: ");
    this.tell(outcome, faults.map((fault) => this.#fault(fault, [this.#part.fields, ...sceneFields])));
    return { outcome, lost: faults.some(({ lost }) => lost) };
  }

  /** What there is to say of an outcome, after other `notes`. */
  tell(outcome, notes = []) {
    if (outcome) this.#part.work.textContent = text("pane.forces", { n: outcome.cost.force_evaluations });
    if (outcome?.choice) notes.push(this.#told(outcome.choice));
    if (outcome?.stop) notes.push(note("stop", stopped(outcome.stop)));
    if (outcome?.events?.length) notes.push(note("events", counted(outcome.events)));
    for (const warning of outcome?.warnings ?? []) notes.push(note("warning", warning.detail || warning.code));
    this.#part.messages.replaceChildren(...(notes.length ? [element("ul", {}, ...notes)] : []));
  }

  /** Adds messages about the run back from the end, given the answer of the service. */
  tellBack({ outcome, faults = [] }) {
    const said = outcome?.stop ? [note("stop", text("pane.back", { what: stopped(outcome.stop) }))]
      : faults.map((fault) => note("fault", text("pane.back", { what: faultText(fault) })));
    if (!said.length) return;
    if (!this.#part.messages.firstChild) this.#part.messages.append(element("ul"));
    this.#part.messages.firstChild.append(...said);
  }

  #spell() {
    if (this.#request) this.#part.curl.textContent = programs[this.#part.language.value](this.#request);
  }

  /** Sets the title from the scheme in the form of a request. */
  #entitle(scheme, who = "") {
    const card = this.#schemes.find(({ id }) => id === scheme.id);
    this.title = who + title(card, scheme);
    this.#part.traits.textContent = traits(card, scheme, this.#problem);
    this.#part.caption.replaceChildren(element("b", { textContent: this.name }), ` ${this.title}`);
  }

  /** Why a scheme was chosen and what else there was, in words. */
  #told({ reason, met, alternatives }) {
    const said = note(met ? "choice" : "choice missed", sentence(reason));
    if (alternatives.length) {
      const others = alternatives.map(({ scheme, force_evaluations: forces, estimated_error: e }) => element("li", {
        textContent: text("pane.alternative", { title: title(this.#schemes.find(({ id }) => id === scheme.id), scheme), forces, error: format(e, 2) }) }));
      said.append(element("details", {}, element("summary", { textContent: text("pane.alternatives") }), element("ul", {}, ...others)));
    }
    return said;
  }

  /** An entry of the list of faults that leads to the field, where there is one. */
  #fault(fault, containers) {
    const [, own] = /^\/(columns|events)\/\d+/.exec(fault.pointer ?? "") ?? [];
    // A formula that could be read is refused because of the start, so the fault leads there.
    const start = /^\/problem\/(lagrangian|hamiltonian|potential|equations)\b/.test(fault.pointer ?? "") &&
      containers.map((form) => form.querySelector("[data-pointer^='/initial/']")).find(Boolean);
    const at = own ? `/${own}/more` : start ? start.dataset.pointer : fault.pointer;
    const input = showFault(containers, { ...fault, pointer: at });
    if (!input) return note("fault", `${fault.pointer ? `${fault.pointer}: ` : ""}${faultText(fault)}`);
    const lead = element("button", { type: "button", textContent: words(input.dataset.name) });
    lead.addEventListener("click", () => input.focus());
    if (at.startsWith("/initial/")) leadTo(input);
    return element("li", { className: "fault" }, lead, ` ${faultText(fault)}`);
  }

  clearFaults() {
    clearFaults(this.#part.fields);
  }

  /** Shows a picture of the run's curve, or nothing. */
  show(picture) {
    const curve = picture?.curves[0];
    this.#part.canvas.setAttribute("aria-label", curve
      ? text("pane.picture", { x: picture.labels[0], y: picture.labels[1], name: this.name, title: this.title }) : text("pane.empty", { name: this.name }));
    this.#part.stretches.hidden = !curve?.stretched || !curve.x.some((_, i) => curve.stretched(i));
    this.#part.happened.hidden = !curve?.events.length;
    this.plane.show(picture);
  }

  async #copy(button) {
    const selection = getSelection();
    selection.selectAllChildren(this.#part.curl);
    try {
      await navigator.clipboard.writeText(this.#part.curl.textContent);
      button.textContent = text("pane.copied");
    } catch {
      button.textContent = text("pane.selected");
    }
    setTimeout(() => (button.textContent = text("pane.copy")), 2000);
  }
}

const sentence = (said) => said + (/[.!?]$/.test(said) ? "" : ".");
const note = (className, textContent) => element("li", { className, textContent });
const stopped = ({ reason, t, detail, singular_at: singularity = null }) =>
  text("pane.stopped", { reason: words(reason), t: format(t, 5), detail }) +
  (singularity === null ? "" : ` (${text("pane.singular", { t: format(singularity, 5) })})`);

const orders = (order) => (order !== null && typeof order === "object"
  ? Object.entries(order).map(([name, p]) => (name === String(p) ? name : `${p} (${words(name)})`)).join(", ")
  : String(order ?? ""));

/** The numbers of events of each kind; those of the request are counted by name. */
function counted(events) {
  const called = ({ kind, name = kind }) => (kind === "event" ? name : kind), kinds = [...new Set(events.map(called))];
  return kinds.map((kind) => {
    const n = events.filter((event) => called(event) === kind).length;
    return known(`happened.${kind}`) ? text(`happened.${kind}`, { n }) : `${count(n)} ${words(kind)}`;
  }).join(", ");
}

/** The traits of a scheme. If its order depends on choices (a composition) or on numbers (of stages), it is the highest of theirs. */
function traits({ id, order, implicit, symmetric, structure, keeps_volume: volume, parameters }, scheme, { diagnostics }) {
  if (id === "auto") return text("trait.chosen");
  const byChoice = order !== null && typeof order === "object";
  const said = byChoice ? parameters.filter(({ type }) => type === "choice" || type === "integer")
    .map(({ name }) => order[scheme[name]] ?? scheme[name]?.order).filter(Number.isFinite) : [];
  const p = byChoice ? (said.length ? Math.max(...said) : Object.values(order)[0]) : order;
  return [p === null ? "adaptive" : "order", implicit ? "implicit" : "explicit", symmetric ? "symmetric" : "not_symmetric",
          ...(!diagnostics.includes("structure") && structure !== "none" ? [] : [`keeps_${volume ? "volume" : structure}`])]
    .map((trait) => text(`trait.${trait}`, { p })).join(" · ");
}
