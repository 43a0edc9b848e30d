// The texts of the page in its language. A table has each under its key, with `{name}` for a value; a text with a number `{n}`
// has a form for one and one for any other number.

/** The languages of the page, each with its own name. */
export const languages = { en: "English", de: "Deutsch" };

let spoken = "en", table = {}, decimal = ".", plural = new Intl.PluralRules(spoken);

/** Sets the language: the table of texts, and the form of numbers. */
export function speak(language, texts) {
  spoken = language;
  table = texts;
  decimal = new Intl.NumberFormat(language).formatToParts(0.5).find(({ type }) => type === "decimal").value;
  plural = new Intl.PluralRules(language);
}
/** Adds texts to the table. */
export const learn = (texts) => Object.assign(table, texts);
export const language = () => spoken;

/** A count: 1 234 567. */
export const count = (n) => (n === undefined ? "–" : n.toLocaleString("en").replaceAll(",", "\u202f").replace("-", "−"));
/** A number or a formula with all its digits, and the decimal sign of the language. */
export const spelled = (value) => String(value).replace(/-(?=[\d.])/g, "−").replace(/(\d)\.(?=\d)/g, `$1${decimal}`);
/** A list of numbers, separated by commas, or by semicolons if the comma is the decimal sign. */
export const listed = (values) => values.join(decimal === "," ? "; " : ", ");
/** A typed number, also with the decimal sign of the language; NaN if it is none. */
export const typed = (text) => Number(decimal === "," && /^[^,]*\d,\d[^,]*$/.test(text) ? text.replace(",", ".") : text);

/** The entry of a key in the table, undefined if there is none. */
export const known = (key) => table[key];

/** The text under a key, with values in their places. */
export function text(key, values = {}) {
  const found = table[key] ?? key, said = typeof found === "string" ? found : found[plural.select(values.n)] ?? found.other;
  const shown = (value) => (typeof value !== "number" ? value : Number.isInteger(value) ? count(value) : spelled(value));
  return said.replace(/\{(\w+)\}/g, (whole, name) => (name in values ? shown(values[name]) : whole));
}

/** The text of a name, or of `[name, values]`, under a `prefix`; a name without text is a formula and shown as it is. */
export function named(prefix, name) {
  const [key, values] = [name].flat();
  return known(`${prefix}.${key}`) === undefined ? spelled(key) : text(`${prefix}.${key}`, values);
}

/** The language that a link asks for, undefined if the page does not have it. */
export const languageOf = (hash) => {
  const asked = new URLSearchParams(hash.replace(/^#/, "")).get("lang");
  return Object.hasOwn(languages, asked) ? asked : undefined;
};
/** A link that asks for a language, or for none. */
export function inLanguage(hash, asked) {
  const parts = hash.replace(/^#/, "").split("&").filter((part) => part && !/^lang(=|$)/.test(part));
  return [...parts, ...(asked ? [`lang=${asked}`] : [])].map((part, i) => (i ? "&" : "#") + part).join("");
}
