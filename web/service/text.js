// Scenes as text: what is typed, as it stands in a request, in the fields and in a link; where in a text a fault is.

export const custom = "custom";
export const kinds = ["lagrangian", "hamiltonian", "potential", "equations"];
const lists = ["parameters", "masses", "equations", "invariants"]; // each a `name = value` to a line
const ofPotentials = ["masses", "damping", "action_curvature", "offset"];
/** The keys of a scene as text beside its parameters. */
const keys = ["title", "variables", ...kinds, ...lists, ...ofPotentials];

/** The parts of a text with their places: `[{name, at, value, from}]`, of a list of names with `value` null. */
export function entries(text) {
  return [...text.matchAll(/[^\n;,]+/g)].filter(([part]) => part.trim()).map(({ 0: part, index }) => {
    const sign = part.indexOf("="), blank = (from) => index + from + part.slice(from).search(/\S|$/);
    const name = (sign < 0 ? part : part.slice(0, sign)).trim();
    return { name, at: blank(0), value: sign < 0 ? null : part.slice(sign + 1).trim(), from: sign < 0 ? blank(0) : blank(sign + 1) };
  });
}

const numbered = (text) => (text !== "" && Number.isFinite(Number(text)) ? Number(text) : text);

/** `{kind, variables, parameters, formula, masses, …}`, all texts, as `{problem, faults}`: a request's, and what no object holds. */
export function definitionOf({ kind, formula, ...texts }) {
  const problem = { id: custom }, faults = [], given = { ...texts, [kind]: formula };
  for (const key of keys) {
    const text = given[key]?.trim() ?? "";
    if (kinds.includes(key) ? key !== kind : !text && key !== "variables") continue;
    if (ofPotentials.includes(key) && kind !== "potential") continue;
    if (key === "variables") problem[key] = entries(text).map(({ name }) => name);
    else if (lists.includes(key)) problem[key] = listed(key, text, faults);
    else problem[key] = text;
  }
  return { problem, faults };
}

function listed(key, text, faults) {
  const list = {};
  for (const { name, value } of entries(text)) {
    if (Object.hasOwn(list, name)) {
      faults.push({ pointer: `/problem/${key}/${escaped(name)}`, detail: `${name} stands here twice`, again: true });
    }
    Object.defineProperty(list, name, { value: key === "parameters" ? numbered(value ?? "") : value ?? "", enumerable: true, configurable: true });
  }
  return list;
}

/** The texts of a problem of a request: lines for the fields, `brief` for a link. */
export function textsOf(problem, brief = false) {
  const kind = kinds.find((name) => name in problem) ?? kinds[0];
  const lines = (list) => Object.entries(list).map(([name, value]) => `${name}${brief ? "=" : " = "}${value}`).join(brief ? "," : "\n");
  const text = (key) => (key === "variables" ? problem[key].join(brief ? "," : ", ")
    : lists.includes(key) ? lines(problem[key]) : String(problem[key]));
  return { kind, ...Object.fromEntries(keys.filter((key) => key in problem).map((key) => [key === kind ? "formula" : key, text(key)])) };
}

/** A problem of a request as the section of a link, and back; parameters stand flat in both. */
export function linked({ id, ...problem }) {
  if (id !== custom) return { id, ...problem };
  const { kind, formula, ...texts } = textsOf(problem, true), flat = Object.entries(problem).filter(([key]) => !keys.includes(key));
  return { id, ...texts, [kind]: formula, ...Object.fromEntries(flat) };
}
export function unlinked(section) {
  const kind = kinds.find((name) => name in section), texts = Object.entries(section).filter(([key]) => keys.includes(key));
  return kind ? { kind, ...Object.fromEntries(texts), formula: section[kind] } : null;
}

/** What is set by hand beside a text: values that are not those of the text. */
export const overrides = (definition, values) =>
  Object.fromEntries(Object.entries(values).filter(([name, value]) => value !== definition.parameters?.[name]));

/** Of the values that are `set` by hand beside a text, those of parameters that another text gives alike. */
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
  const known = [...variables, ...rates, "t"];
  const start = Object.entries(initial).filter(([name, value]) => known.includes(name) && numbered(value) === Number(value));
  return start.length ? Object.fromEntries(start.map(([name, value]) => [name, Number(value)])) : undefined;
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
