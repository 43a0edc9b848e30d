// The editor of a scene as text: its fields, what the service derived from it, and its faults with their places.
import { known, text } from "../language/texts.js";
import * as api from "../service/api.js";
import { definitionOf, entries, kinds, placeOf, startIn, startValue, textsOf } from "../service/text.js";
import { choose, element, faultText, words } from "../forms/forms.js";
import { equationsOf, formulaOf } from "../forms/formula.js";

const find = (selector) => document.querySelector(`#own ${selector}`);
const pause = 300; // ms without a key before the text is read

const mechanics = kinds.filter((kind) => kind !== "equations");
const most = 24, action = "s_"; // equations that are typeset; the name of s among them
const none = text("none");
const fields = [
  { key: "variables", hint: "x, y" },
  { key: "formula", rows: 3 },
  { key: "parameters", rows: 2, hint: "mu = 1" },
  { key: "definitions", rows: 1, hint: "r = sqrt(x^2 + y^2)" },
  { key: "masses", rows: 2, hint: text("own.each"), of: ["potential"] },
  { key: "damping", hint: none, of: ["potential"] },
  { key: "action_curvature", hint: none, of: ["potential"] },
  { key: "offset", hint: none, of: ["potential"] },
  { key: "forces", rows: 1, hint: "x = -0.1*vx*abs(vx)", of: mechanics },
  { key: "dissipation", hint: none, of: mechanics },
  { key: "invariants", rows: 1, hint: "L = x*py - y*px" },
  { key: "views", rows: 1, hint: '[["x", "y"], ["t", "x^2"]]' },
  { key: "bodies", rows: 1, hint: '[{"at": ["sin(q)", "-cos(q)"], "linked": ["pivot"]}]' },
  { key: "note", hint: none, wide: true },
  { key: "title", hint: text("own.untitled"), wide: true },
];

/** An example with its texts in the language of the page, if it has any. */
function spoken({ name, problem, ...example }) {
  const title = known(`example.${name}`) ?? example.title, note = known(`example.${name}.note`) ?? example.note;
  return { ...example, name, title, note, problem: { ...problem, ...(problem.title ? { title } : {}) } };
}

/** The left side of a formula of a kind: its name with the variables it depends on. */
function heading(kind, coordinates) {
  const q = coordinates.map(({ name }) => name), of = (letter) => q.map((name) => letter + name.replace(/^q/, ""));
  if (kind === "equations") return text("own.rates");
  if (kind === "potential") return `V(${[...q, "t"].join(", ")}) =`;
  return kind === "lagrangian" ? `L(${[...q, ...of("v"), "t", "s"].join(", ")}) =` : `H(${[...q, ...of("p"), "t", "s"].join(", ")}) =`;
}

export class Editor {
  #typed; // (card, definition) of a text that was read after it was typed
  #start;
  #others;
  #parts = new Map(); // by key: {node, input, name, spot}
  #examples = null;
  #flight = null;
  #timer = 0;
  #faulty = false;
  #derived = null; // {rates, parameters} of equations that are still to be typeset
  #said = ""; // the texts and faults that are shown
  #formulas = {}; // by kind, while another kind is tried

  /**
   * `typed(card, definition)`: a text was read, null where it cannot be; `stirred()`: a key; `picked(example)`; `start()`:
   * the start as it stands; `others`: examples beside its own.
   */
  constructor({ typed, stirred, picked, start, others }) {
    this.#others = others;
    this.#typed = typed;
    this.#start = start;
    find(".fields").append(...fields.flatMap((field) => [this.#field(field), ...(field.key === "formula" ? [find("#found")] : [])]));
    choose(find("#kind"), kinds.map((id) => ({ id, title: text(`own.kind.${id}`) })));
    find("#kind").addEventListener("change", () => this.#turn());
    document.querySelector("#own").addEventListener("input", () => {
      stirred();
      this.#busy(true);
      this.#label();
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => this.#read(), pause);
    });
    document.querySelector("#own").addEventListener("change", ({ target }) => target.closest(".typed") && this.#timer && this.#read());
    find("#derived").addEventListener("toggle", () => this.#typeset());
    find("#example").addEventListener("change", async ({ target }) => picked((await this.examples())[target.value]));
  }

  #field({ key, rows = 0, hint = "", wide = rows > 0 }) {
    const input = rows ? element("textarea", { rows }) : element("input", { type: "text" });
    Object.assign(input, { spellcheck: false, placeholder: hint, autocapitalize: "off" });
    const name = element("span", { className: "name", textContent: known(`own.field.${key}`) ?? "" }); // of the formula it depends on its kind
    const spot = element("div", { className: "spot", id: `spot-${key}` });
    const node = element("div", { className: wide ? "typed wide" : "typed" }, element("label", { className: "field" }, name, input), spot);
    node.dataset.key = key;
    this.#parts.set(key, { node, input, name, spot });
    return node;
  }

  /** The texts in the fields. */
  get texts() {
    return { kind: this.#kind, ...Object.fromEntries([...this.#parts].map(([key, { input }]) => [key, input.value])) };
  }
  get #kind() {
    return find("#kind").value;
  }

  async examples() {
    if (this.#examples) return this.#examples;
    this.#examples = [...(await api.scenes()).map(spoken), ...this.#others, blank];
    const titles = this.#examples.map(({ title, name }, i) => ({ id: String(i), title: title ?? words(name) }));
    choose(find("#example"), [{ id: "", title: text("own.begin") }, titles.at(-1), ...titles.slice(0, -1)], "");
    return this.#examples;
  }

  /** Shows a scene as a request holds it and reads it: its card, null where it cannot be read, or was left meanwhile. */
  async open(definition) {
    this.close();
    document.querySelector("#own").hidden = false;
    const texts = textsOf(definition);
    find("#kind").value = texts.kind;
    this.#formulas = {};
    for (const [key, { input }] of this.#parts) input.value = texts[key] ?? "";
    this.#label();
    this.examples().then((examples) => {
      const at = examples.findIndex(({ problem }) => JSON.stringify(textsOf(problem)) === JSON.stringify(texts));
      find("#example").value = at < 0 ? "" : String(at);
      const { note = texts.note ?? "", reference = "" } = examples[at] ?? {};
      find("#example-note").textContent = note + (reference && ` (${reference})`);
    });
    return (await this.#ask())?.card ?? null;
  }

  /** Reads a text that had faults once more: from another start it may have none. */
  again() {
    if (this.#faulty) this.#read();
  }

  close() {
    clearTimeout(this.#timer);
    this.#timer = 0;
    this.#flight?.abort();
    this.#faulty = false;
    document.querySelector("#own").hidden = true;
  }

  /** A start `{x, vx}` in the variables of a card: velocities become momenta. */
  async startOf(card, problem, initial = {}) {
    const known = [...card.variables.map(({ name }) => name), "t"];
    if (Object.keys(initial).every((name) => known.includes(name))) return initial;
    const numbers = Object.fromEntries(Object.entries(initial).map(([name, value]) => [name, startValue(value)]));
    const request = { problem, initial: numbers, scheme: card.schemes[0], until: { steps: 1 }, record: { every: 0 }, diagnostics: [] };
    const { outcome } = await api.simulate(request, new AbortController().signal);
    return outcome?.initial ?? initial;
  }

  /** Another kind: its own formula, where one was typed before. */
  #turn() {
    const { input } = this.#parts.get("formula"), { was = kinds[0] } = this.#parts.get("formula");
    this.#formulas[was] = input.value;
    input.value = this.#formulas[this.#kind] ?? input.value;
    this.#label();
  }

  #label() {
    const kind = this.#kind, formula = this.#parts.get("formula");
    formula.was = kind;
    formula.name.textContent = heading(kind, entries(this.#parts.get("variables").input.value));
    this.#parts.get("variables").name.textContent = text(kind === "equations" ? "own.variables" : "own.field.variables");
    for (const { key, of = kinds } of fields) this.#parts.get(key).node.hidden = !of.includes(kind);
    for (const { input } of this.#parts.values()) {
      if (input.localName === "textarea") input.rows = Math.max(input.value.split("\n").length, input === formula.input ? 2 : 1);
    }
  }

  /** Whether what is shown may be of other texts than those in the fields. */
  #busy(is) {
    document.querySelector("#own").ariaBusy = String(is);
  }

  async #read() {
    clearTimeout(this.#timer);
    this.#timer = 0;
    const read = await this.#ask();
    if (read) this.#typed(read.card, read.problem);
  }

  /** `{card, problem}`, the card null where the text has faults; nothing where a newer question came. */
  async #ask() {
    this.#flight?.abort();
    const mine = (this.#flight = new AbortController()), texts = this.texts, { problem, faults: doubled } = definitionOf(texts);
    const start = startIn(problem, this.#start());
    this.#busy(true);
    try {
      const from = doubled.length ? { faults: doubled } : await api.describe(problem, start, mine.signal);
      // A text that is valid except for this start is shown, because another start may do.
      const { outcome: card = null } = from.faults && start && !doubled.length ? await api.describe(problem, undefined, mine.signal) : from;
      const begun = card && !start ? regular(card) : card;
      if (mine.signal.aborted) return null;
      this.#mark(texts, from.faults ?? [], card);
      if (card) this.#tell(card, problem);
      return { card: begun, problem };
    } catch (error) {
      if (!mine.signal.aborted) throw error;
      return null;
    } finally {
      if (this.#flight === mine && !this.#timer) this.#busy(false);
    }
  }

  /** Shows faults under their fields, each with its place in the text. */
  #mark(texts, faults, card) {
    const said = JSON.stringify([texts, faults]), elsewhere = [];
    this.#faulty = faults.length > 0;
    find("#found").classList.toggle("stale", !card);
    if (!card) find("#form").textContent = text("own.stale");
    if (said === this.#said) return; // the same once more: a hand may be on it
    this.#said = said;
    for (const { input, spot } of this.#parts.values()) {
      spot.replaceChildren();
      input.removeAttribute("aria-invalid");
      input.removeAttribute("aria-describedby");
    }
    for (const fault of faults) {
      const place = placeOf(texts, fault), part = place && this.#parts.get(place.key);
      if (!part || part.node.hidden) {
        elsewhere.push(element("p", { className: "fault", textContent: (fault.pointer ? `${fault.pointer}: ` : "") + faultText(fault) }));
        continue;
      }
      part.spot.append(element("p", { className: "fault" }, ...(place.from === null ? [] : [lead(part.input, place)]), faultText(fault)));
      part.input.setAttribute("aria-invalid", "true");
      part.input.setAttribute("aria-describedby", part.spot.id);
    }
    find("#unplaced").replaceChildren(...elsewhere);
  }

  #tell({ formula, form, equations = {}, equations_note: note = "", schemes }, { parameters = {} }) {
    const traits = [known(`own.form.${form.kind}`) ?? words(form.kind), form.autonomous ? "" : text("own.timed"),
                    form.kind === "flow" ? "" : text(form.keeps_energy ? "own.keeps" : "own.loses"),
                    text("own.schemes", { n: schemes.length })].filter(Boolean).join("; ");
    find("#form").textContent = `${traits[0].toUpperCase()}${traits.slice(1)}.`;
    find("#as-read").replaceChildren(...formulaOf(formula, true));
    const rates = Object.entries(equations), spelled = rates.some(([name]) => /^d.+\/dt$/.test(name));
    find("#equations").replaceChildren(...rates.map(([name, rate]) =>
      element("li", {}, element("code", { textContent: `${spelled ? name : `d${name}/dt`} = ${rate}` }))));
    find("#equations-note").textContent = note;
    find("#derived").hidden = rates.length === 0 || form.kind === "flow";
    this.#derived = spelled || find("#derived").hidden || rates.length > most ? null : { rates, parameters };
    this.#typeset();
  }

  /** Shows the derived equations, once they are opened, as formulas, which the service makes of them as of typed equations. */
  async #typeset() {
    const derived = this.#derived;
    if (!derived || !find("#derived").open) return;
    this.#derived = null;
    const plain = (name) => name.replace(/\[(\d+)\]/g, "$1").replace(/\bs\b/g, action); // s is no variable of equations, x[1] none of its own
    const equations = Object.fromEntries(derived.rates.map(([name, rate]) => [plain(name), plain(rate)]));
    const parameters = Object.entries(derived.parameters).flatMap(([name, value]) => (
      Array.isArray(value) ? value.map((one, i) => [`${name}${i + 1}`, one]) : [[name, value]]));
    const { outcome } = await api.describe({ id: "custom", variables: Object.keys(equations), equations, parameters: Object.fromEntries(parameters) }, undefined, new AbortController().signal);
    const rows = outcome ? equationsOf(outcome.formula) : [], items = [...find("#equations").children];
    if (this.#derived || rows.length !== items.length || !items.every((item, i) => item.textContent.endsWith(` = ${derived.rates[i][1]}`))) return; // of another text
    for (const [i, row] of rows.entries()) {
      for (const letter of row.flatMap((line) => [...line.querySelectorAll("mi")])) if (letter.textContent === action) letter.textContent = "s";
      items[i].replaceChildren(...row);
    }
  }
}

/** The initial text of a scene of one's own that is not an example: the shortest that runs. */
const blank = { title: text("own.blank"), problem: { variables: ["x"], lagrangian: "vx^2/2" }, initial: { x: 0, px: 1 }, until: { t: 10 }, axes: { x: "t", y: "x" } };

/** A card with the start that the service proposes as default, if it does, because the motion is singular at 0. */
const regular = (card) => (card.start ? { ...card, variables: card.variables.map((one) => ({ ...one, default: card.start[one.name] ?? one.default })) } : card);

/** The text about a place, the place marked: a button that leads there. */
function lead(input, { from, to }) {
  const { value } = input, first = Math.max(value.lastIndexOf("\n", from - 1) + 1, from - 24);
  const end = value.indexOf("\n", to), last = Math.min(end < 0 ? value.length : end, to + 16);
  const button = element("button", { type: "button", title: text("own.go") },
    first > 0 && value[first - 1] !== "\n" ? "…" : "", value.slice(first, from),
    element("mark", { textContent: value.slice(from, to) || "\u00a0" }),
    value.slice(to, last), last < value.length && last !== end ? "…" : "");
  button.addEventListener("click", () => {
    input.focus();
    input.setSelectionRange(from, to);
  });
  return button;
}
