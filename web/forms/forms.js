// Forms made from the catalogue's cards: fields, their values, and the service's faults at the field they point to.
import { known, listed, text, typed } from "../language/texts.js";
import { rangeOf, scaleOf, tidy } from "./ranges.js";

export const element = (tag, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

/** An id of the service as words. */
export const words = (id) => known(`service.name.${id}`) ?? id.replaceAll("_", " ");

/** A text of the catalogue, its powers, `e^{−αt}`, raised. */
export const prose = (said) => said.split(/\^\{([^}]*)\}/).map((part, i) => (i % 2 ? element("sup", { textContent: part }) : part));

/** A symbol of the catalogue, `p_y` with its index below. */
export function symbol(name) {
  const [letter, index] = name.split("_");
  return element("i", {}, letter, ...(index ? [element("sub", { textContent: index })] : []));
}

/** Fills a select with `[{id, title}]` and picks `id`, or what stands first. */
export function choose(select, options, id) {
  select.replaceChildren(...options.map((o) => element("option", { value: o.id, textContent: o.title })));
  if (options.some((o) => o.id === id)) select.value = id;
}

/**
 * Fills `container` with one field per card. `pointer` is where the values stand in a request; `values` (by name, also
 * as text) win over the cards' defaults.
 */
export function build(container, cards, pointer, values = {}) {
  container.replaceChildren(...cards.map((card) => field(card, `${pointer}/${card.name}`, values[card.name])));
}

/** A number for a narrow field: 2e-6, because of 0.000002 only zeros would be visible. */
const brief = (value) => {
  const plain = String(value ?? ""), power = typeof value === "number" ? value.toExponential() : plain;
  return plain.length > 7 && power.length < plain.length ? power : plain;
};

function field(card, pointer, value = card.default) {
  const input = control(card, value);
  Object.assign(input.dataset, { pointer, name: card.name, kind: card.type ?? "number", usual: brief(card.default) });
  if (card.nullable) input.dataset.nullable = card.word ?? "";
  if (card.optional) input.dataset.optional = "";
  const unit = card.unit && card.unit !== "1" ? text("field.unit", { unit: card.unit.replace(/[a-z]+/gi, words) }) : "";
  const empty = text(card.nullable ? "field.empty" : card.optional ? "field.follows" : "", { word: card.word ?? text("field.off") });
  input.title = [card.doc, unit, range(card), empty].filter(Boolean).join("; ");
  const name = element("span", { className: "name", textContent: card.label ?? words(card.name) });
  if (card.symbol && card.symbol !== card.name) name.append(" ", symbol(card.symbol));
  const label = element("label", { className: `field ${input.dataset.kind}` }, name, input);
  return card.slides ? element("div", { className: "sliding" }, label, track(input, card, name.textContent)) : label;
}

/** A slider that sets the number of a field; the field dispatches "slide" on every move, and "change" at the end. */
function track(input, card, label) {
  const range = rangeOf(card), scale = scaleOf(range);
  const made = element("input", { type: "range", min: 0, max: 1000, step: 1, ariaLabel: label });
  const follow = () => {
    const value = Number(input.value);
    if (Number.isFinite(value)) made.value = scale.of(value);
  };
  made.addEventListener("input", () => {
    input.value = tidy(scale.at(Number(made.value)), range);
    input.dispatchEvent(new CustomEvent("slide", { bubbles: true }));
  });
  input.addEventListener("input", follow);
  follow();
  return made;
}

function control(card, value) {
  if (card.type === "flag") return element("input", { type: "checkbox", checked: String(value) === "true" });
  if (card.type === "choice") {
    const select = element("select");
    const known = card.choices.includes(value) ? value : card.default;
    choose(select, card.choices.map((id) => ({ id, title: card.words?.[id] ?? words(id) })), known);
    return select;
  }
  if (card.type === "list") {
    const select = element("select", { multiple: true, size: card.choices.length });
    choose(select, card.choices.map((id) => ({ id, title: words(id) })));
    const chosen = Array.isArray(value) ? value : String(value ?? "").split(",");
    for (const option of select.options) option.selected = chosen.includes(option.value);
    return select;
  }
  return element("input", { type: "text", inputMode: card.type === "text" ? "text" : "decimal", spellcheck: false, value: brief(value),
                            placeholder: card.hint ?? (card.nullable ? card.word ?? text("field.off")
                              : brief(card.default ?? text(card.optional ? "field.auto" : "field.off"))) });
}

function range(card) {
  if (card.minimum === undefined) return "";
  const open = card.exclusive_minimum ? "(" : "[", close = card.exclusive_maximum ? ")" : "]";
  return open + listed([card.minimum ?? "−∞", card.maximum ?? "∞"]) + close;
}

const shown = (input) => (input.type === "checkbox" ? String(input.checked)
  : input.multiple ? [...input.selectedOptions].map((option) => option.value).join(",") : input.value.trim());

/** The number that is typed into a field; a comma in a list of numbers is no decimal sign. */
const numberIn = ({ value, dataset }) => (dataset.usual.includes(",") ? Number(value) : typed(value));

/**
 * The values of a container by name. A text that is not a number is passed on, because the service tells what is wrong. An
 * optional value is left out if it is the default; with `changed` any value is.
 */
export function values(container, changed = false) {
  const read = {};
  for (const input of container.querySelectorAll("[data-name]")) {
    const { name, kind } = input.dataset, said = input.value.trim();
    if (changed && shown(input) === input.dataset.usual) continue;
    if ("optional" in input.dataset && said === input.placeholder) continue;
    if (kind === "flag") read[name] = input.checked;
    else if (kind === "list") read[name] = [...input.selectedOptions].map((option) => option.value);
    else if (kind === "choice") read[name] = input.value;
    else if (kind === "text" && said !== "") read[name] = said;
    else if (said !== "") read[name] = Number.isFinite(numberIn(input)) ? numberIn(input) : said;
    else if ("nullable" in input.dataset) read[name] = input.dataset.nullable || null;
  }
  return read;
}

export function clearFaults(container) {
  for (const note of container.querySelectorAll(".field > .fault")) note.remove();
  for (const input of container.querySelectorAll("[aria-invalid]")) {
    input.removeAttribute("aria-invalid");
    input.removeAttribute("aria-describedby");
  }
}

/** Shows a fault `{pointer, detail, allowed}` at its field in one of the containers; the field, or null. */
export function showFault(containers, fault) {
  for (const container of containers) {
    const input = fault.pointer && container.querySelector(`[data-pointer="${CSS.escape(fault.pointer)}"]`);
    if (!input) continue;
    if (input.hasAttribute("aria-invalid")) return input;
    const note = element("span", { className: "fault", id: `fault-${document.querySelectorAll(".fault").length}`,
                                   textContent: faultText(fault) });
    input.closest(".field").append(note);
    input.setAttribute("aria-invalid", "true");
    input.setAttribute("aria-describedby", note.id);
    return input;
  }
  return null;
}

/** Moves the focus to a refused field, unless another field has it. */
export function leadTo(input) {
  if (document.activeElement?.matches("input, textarea, select")) return;
  input.closest("details:not([open])")?.setAttribute("open", "");
  input.focus();
}

export const faultText = ({ detail, allowed }) => (allowed ? text("field.allowed", { detail, allowed }) : detail);
