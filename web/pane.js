// One run of the comparison: its scheme and the form for it, its request, its picture and what went wrong.
import { curl, simulate } from "./api.js";
import { build, choose, clearFaults, element, faultText, showFault, values, words } from "./forms.js";
import { format } from "./numbers.js";
import { Plane } from "./plane.js";

export class Pane {
  #schemes = [];
  #problem = null;
  #part;

  /** `name` is A or B; `refine` divides the suggested step. */
  constructor(name, refine) {
    this.name = name;
    this.refine = refine;
    this.colour = `--run-${name.toLowerCase()}`;
    this.node = document.querySelector("#pane").content.cloneNode(true).firstElementChild;
    this.node.dataset.run = name;
    const find = (selector) => this.node.querySelector(selector);
    this.#part = { scheme: find(".scheme"), fields: find(".parameters"), traits: find(".traits"),
                   messages: find(".messages"), caption: find("figcaption .title"), canvas: find("canvas"),
                   about: find(".about div"), curl: find(".curl pre") };
    find(".badge").textContent = name;
    find(".badge").setAttribute("aria-label", `Run ${name}`);
    this.plane = new Plane(this.#part.canvas);
    this.#part.scheme.addEventListener("change", () => this.#rebuild(this.chosen()));
    find(".curl button").addEventListener("click", (event) => this.#copy(event.target));
  }

  /** Offers the schemes that fit the problem; `chosen` (`{id, …}`) wins over the usual comparison. */
  offer(problem, schemes, chosen = {}) {
    this.#problem = problem;
    this.#schemes = schemes.filter((scheme) => problem.schemes.includes(scheme.id));
    const named = (id) => this.#schemes.find((s) => s.id === id);
    const usual = named("leapfrog") ?? this.#schemes.find((s) => s.structure !== "none") ?? named("runge_kutta_4");
    const { id = usual?.id } = chosen;
    const fits = named(id) !== undefined;
    choose(this.#part.scheme, this.#schemes, fits ? id : usual?.id);
    this.#rebuild(fits ? chosen : {});
  }

  get #scheme() {
    return this.#schemes.find((scheme) => scheme.id === this.#part.scheme.value);
  }

  /** The scheme as it stands in a request. */
  chosen() {
    return { id: this.#part.scheme.value, ...values(this.#part.fields) };
  }

  #rebuild(chosen) {
    const scheme = this.#scheme, { suggested = {} } = this.#problem;
    const cards = scheme.parameters.map((card) => {
      if (!(card.suggested in suggested)) return card;
      const value = suggested[card.suggested];
      return { ...card, default: card.suggested === "step" ? value / this.refine : value };
    });
    build(this.#part.fields, cards, "/scheme", chosen);
    const say = (title, text) => (text ? element("p", {}, element("b", { textContent: `${title} ` }), text) : "");
    const composed = scheme.recommended ? words(Object.values(scheme.recommended).join(", ")) : "";
    this.#part.about.replaceChildren(
      element("p", { textContent: scheme.summary }), say("Good for:", scheme.good_for), say("Fails when:", scheme.fails_when),
      say("Order:", orders(scheme.order)), say("Recommended composition:", composed),
      say("Source:", (scheme.references ?? []).join("; ")));
  }

  /** Runs `request`; the outcome, or null when the service refused it. */
  async run(request, sceneFields, signal) {
    this.title = title(request.scheme);
    this.#part.traits.textContent = traits(this.#scheme, request.scheme.composition);
    this.#part.curl.textContent = curl(request);
    this.#part.caption.replaceChildren(element("b", { textContent: this.name }), ` ${this.title}`);
    const { outcome, faults = [] } = await simulate(request, signal);
    const notes = faults.map((fault) => this.#fault(fault, [this.#part.fields, ...sceneFields]));
    if (outcome?.stop) notes.push(note("stop", stopped(outcome.stop)));
    for (const warning of outcome?.warnings ?? []) notes.push(note("warning", warning.detail || warning.code));
    this.#part.messages.replaceChildren(...(notes.length ? [element("ul", {}, ...notes)] : []));
    return outcome ?? null;
  }

  /** An entry of the list of faults that leads to the field, where there is one. */
  #fault(fault, containers) {
    const input = showFault(containers, fault);
    if (!input) return note("fault", `${fault.pointer ? `${fault.pointer}: ` : ""}${faultText(fault)}`);
    const lead = element("button", { type: "button", textContent: words(input.dataset.name) });
    lead.addEventListener("click", () => input.focus());
    return element("li", { className: "fault" }, lead, ` ${faultText(fault)}`);
  }

  clearFaults() {
    clearFaults(this.#part.fields);
  }

  /** Shows the curve `{x, y}` with the labels `[x, y]` in a view, or nothing. */
  show(curve, [x, y], view) {
    this.#part.canvas.setAttribute("aria-label", curve
      ? `${y} over ${x} of run ${this.name}: ${this.title}` : `Run ${this.name}: nothing to show`);
    this.plane.show(curve && { curve, view, labels: [x, y], colour: this.colour });
  }

  async #copy(button) {
    const selection = getSelection();
    selection.selectAllChildren(this.#part.curl);
    try {
      await navigator.clipboard.writeText(this.#part.curl.textContent);
      button.textContent = "Copied";
    } catch {
      button.textContent = "Selected: press Ctrl+C";
    }
    setTimeout(() => (button.textContent = "Copy"), 2000);
  }
}

const note = (className, textContent) => element("li", { className, textContent });
const stopped = ({ reason, t, detail, singular_at: singularity = null }) =>
  `Stopped (${words(reason)}) at t = ${format(t, 5)}: ${detail}` +
  (singularity === null ? "" : ` (singular at t = ${format(singularity, 5)})`);

const orders = (order) => (typeof order === "object"
  ? Object.entries(order).map(([name, p]) => `${p} (${words(name)})`).join(", ") : String(order));

/** A few words that tell a run from the other. */
function title({ id, step, composition = "none" }) {
  const composed = composition === "none" ? "" : ` (${words(composition)})`;
  return words(id) + composed + (step === undefined ? "" : `, h = ${step}`);
}

function traits({ order, implicit, symmetric, structure }, composition) {
  const p = typeof order === "object" ? order[composition] ?? Object.values(order)[0] : order;
  return [`order ${p}`, implicit ? "implicit" : "explicit", symmetric ? "symmetric" : "not symmetric",
          structure === "none" ? "keeps no structure" : structure].join(" · ");
}
