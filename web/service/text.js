// Scenes as text: conversions between the typed fields, a request and a link; and the place of a fault in a text.
import { text as message } from "../language/texts.js";

export const custom = "custom";
export const kinds = ["lagrangian", "hamiltonian", "potential", "equations"];
const lists = ["parameters", "masses", "equations", "definitions", "invariants", "forces"]; // each a `name = value` to a line
const ofPotentials = ["masses", "damping", "action_curvature", "offset"], ofMechanics = ["forces", "dissipation"];
const data = ["views", "bodies"]; // JSON, as in a request
/** The keys of a scene as text beside its parameters. */
const keys = ["title", "note", "variables", ...kinds, ...lists, ...ofPotentials, "dissipation", ...data];

/** The parts of a text, at commas and semicolons outside of brackets and at ends of lines: `[[part, index]]`. */
function split(text) {
  const parts = [];
  let from = 0, depth = 0;
  for (let i = 0; i <= text.length; i++) {
    const c = text[i] ?? "\n";
    if ("([{".includes(c)) depth++;
    else if (")]}".includes(c)) depth--;
    if (c !== "\n" && !(",;".includes(c) && depth <= 0)) continue;
    parts.push([text.slice(from, i), from]);
    from = i + 1;
    depth = 0;
  }
  return parts;
}

/** The parts of a text, `[{name, at, value, from}]`: `name = value` with the places of both; `value` is null for a name alone. */
export function entries(text) {
  return split(text).filter(([part]) => part.trim()).map(([part, index]) => {
    const sign = part.indexOf("="), blank = (from) => index + from + part.slice(from).search(/\S|$/);
    const name = (sign < 0 ? part : part.slice(0, sign)).trim();
    return { name, at: blank(0), value: sign < 0 ? null : part.slice(sign + 1).trim(), from: sign < 0 ? blank(0) : blank(sign + 1) };
  });
}

/** A text as a number or a list of numbers, if it is one; else the text. */
function numbered(text) {
  if (text !== "" && Number.isFinite(Number(text))) return Number(text);
  const list = /^\[(.*)\]$/s.exec(text)?.[1].split(",").map((part) => numbered(part.trim()));
  return list?.every((value) => typeof value === "number") ? list : text;
}

/** The texts `{kind, variables, parameters, formula, masses, …}` as a problem of a request, with the faults of its lists. */
export function definitionOf({ kind, formula, ...texts }) {
  const problem = { id: custom }, faults = [], given = { ...texts, [kind]: formula };
  for (const key of keys) {
    const text = given[key]?.trim() ?? "";
    if (kinds.includes(key) ? key !== kind : !text && key !== "variables") continue;
    if (ofPotentials.includes(key) && kind !== "potential" || ofMechanics.includes(key) && kind === "equations") continue;
    if (key === "variables") problem[key] = entries(text).map(({ name }) => name);
    else if (lists.includes(key)) problem[key] = listed(key, text, faults);
    else if (data.includes(key)) problem[key] = read(text);
    else problem[key] = text;
  }
  return { problem, faults };
}

/** The value of a JSON text; any other text stays a text, which the service refuses. */
function read(text) {
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

function listed(key, text, faults) {
  const list = {};
  for (const { name, value } of entries(text)) {
    if (Object.hasOwn(list, name)) {
      faults.push({ pointer: `/problem/${key}/${escaped(name)}`, detail: message("own.twice", { name }), again: true });
    }
    Object.defineProperty(list, name, { value: key === "parameters" ? numbered(value ?? "") : value ?? "", enumerable: true, configurable: true });
  }
  return list;
}

/** A list as JSON, an entry to a line. */
const written = (list, brief) => (brief || !Array.isArray(list) ? JSON.stringify(list)
  : `[${list.map((entry) => JSON.stringify(entry).replace(/([,:])(?=[["{\d-])/g, "$1 ")).join(",\n ")}]`);

/** The texts of a problem of a request: lines for the fields, `brief` for a link. */
export function textsOf(problem, brief = false) {
  const kind = kinds.find((name) => name in problem) ?? kinds[0];
  const spelled = (value) => (Array.isArray(value) ? `[${value.join(brief ? "," : ", ")}]` : value);
  const lines = (list) => Object.entries(list).map(([name, value]) => `${name}${brief ? "=" : " = "}${spelled(value)}`).join(brief ? "," : "\n");
  const text = (key) => (key === "variables" ? problem[key].join(brief ? "," : ", ")
    : lists.includes(key) ? lines(problem[key]) : data.includes(key) ? written(problem[key], brief) : String(problem[key]));
  const texts = keys.filter((key) => key in problem).map((key) => [key === kind ? "formula" : key, text(key)]);
  return { kind, ...Object.fromEntries(texts.filter(([, said]) => said !== "")) };
}

/** A problem of a request as the section of a link, and back; in both, parameters are entries beside the others. */
export function linked({ id, ...problem }) {
  if (id !== custom) return { id, ...problem };
  const { kind, formula, ...texts } = textsOf(problem, true), flat = Object.entries(problem).filter(([key]) => !keys.includes(key));
  return { id, ...texts, [kind]: formula, ...Object.fromEntries(flat) };
}
export function unlinked(section) {
  const kind = kinds.find((name) => name in section), texts = Object.entries(section).filter(([key]) => keys.includes(key));
  return kind ? { kind, ...Object.fromEntries(texts), formula: section[kind] } : null;
}

/** The values set by hand beside a text that differ from those of the text. */
export const overrides = ({ parameters = {} }, values) => Object.fromEntries(Object.entries(values).filter(([name, value]) => {
  const [, list, i] = /^(.+)\[(\d+)\]$/.exec(name) ?? [];
  return value !== (list ? parameters[list]?.[i - 1] : parameters[name]);
}));

/** Those of the values `set` by hand beside a text whose parameters have the same value in the new text as `before`. */
export function kept(before, { parameters = {} }, set) {
  const same = Object.entries(parameters).filter(([name, value]) => name in set && before?.parameters?.[name] === value);
  return Object.fromEntries(same.map(([name]) => [name, set[name]]));
}

/**
 * Of a start `{x, vx, …}`, numbers also as text, what a problem of a request has: what belonged to another text is left out.
 * Undefined where nothing is left: no text is refused for a start that nobody chose.
 */
export function startIn({ variables = [], lagrangian, equations }, initial) {
  const rates = equations ? [] : variables.flatMap((q) => (lagrangian === undefined ? ["p"] : ["p", "v"]).map((letter) => letter + q.replace(/^q/, "")));
  const known = [...variables, ...rates, "t"].flatMap(spelledOut);
  const start = Object.entries(initial).map(([name, value]) => [name, startValue(value)]);
  const fitting = start.filter(([name, value]) => known.includes(name) && [value].flat().every(Number.isFinite));
  return fitting.length ? Object.fromEntries(fitting) : undefined;
}

/** The names declared by `x[3]`: x[1] to x[3], and x for the list of all. */
function spelledOut(name) {
  const [, letter, n] = /^(\w+)\[(\d+)\]$/.exec(name) ?? [];
  return letter ? [letter, ...Array.from({ length: Math.min(n, 2048) }, (_, i) => `${letter}[${i + 1}]`)] : [name];
}

/** A value of a start in a link: a number, or a list of numbers. */
export function startValue(value) {
  const numbers = String(value).split(",").map((part) => (part.trim() === "" ? NaN : Number(part)));
  return Array.isArray(value) || numbers.length > 1 ? numbers : numbers[0];
}

const escaped = (name) => name.replaceAll("~", "~0").replaceAll("/", "~1");
const unescaped = (name) => name.replaceAll("~1", "/").replaceAll("~0", "~");

/**
 * Where the fault `{pointer, position}` stands in `texts`: `{key, from, to}`, the key that of a field, the characters those
 * of a word or a sign; `from` null where it concerns the whole. Null where the fault concerns no text.
 */
export function placeOf(texts, { pointer = "", position, again = false }) {
  const [, top, member, part] = pointer.split("/"), key = member === texts.kind ? "formula" : member;
  if (top !== "problem" || !(kinds.includes(member) || keys.includes(member))) return null;
  if (kinds.includes(member) && member !== texts.kind) return null;
  const text = texts[key] ?? "";
  const word = (from) => ({ key, from, to: from + /^(\w+(\.\w*)?|[^]|)/.exec(text.slice(from))[0].length });
  if (part === undefined) return position === undefined ? { key, from: null } : word(text.search(/\S|$/) + position);
  const all = entries(text), name = unescaped(part);
  const entry = key === "variables" ? all[Number(part)] : all[again ? "findLast" : "find"]((one) => one.name === name);
  if (!entry) return { key, from: null };
  return word(position === undefined || key === "variables" ? entry.at : entry.from + position);
}
