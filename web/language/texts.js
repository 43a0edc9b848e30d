// The texts of the page in the language that is spoken. Each stands in a table under its key, `{name}` where a value goes; a text
// that counts, `{n}`, has a form for one and one for any other number.

/** The languages that there are, each under its own name. */
export const languages = { en: "English", de: "Deutsch" };

let spoken = "en", table = {}, decimal = ".", plural = new Intl.PluralRules(spoken);

/** From now on texts are those of the `table` and numbers are written as in this language. */
export function speak(language, texts) {
  spoken = language;
  table = texts;
  decimal = new Intl.NumberFormat(language).formatToParts(0.5).find(({ type }) => type === "decimal").value;
  plural = new Intl.PluralRules(language);
}
/** Texts that come later, beside those that there are. */
export const learn = (texts) => Object.assign(table, texts);
export const language = () => spoken;

/** A count: 1 234 567. */
export const count = (n) => (n === undefined ? "–" : n.toLocaleString("en").replaceAll(",", "\u202f").replace("-", "−"));
/** A number, or a formula, with its digits as they are: with the decimal sign of the language. */
export const spelled = (value) => String(value).replace(/-(?=[\d.])/g, "−").replace(/(\d)\.(?=\d)/g, `$1${decimal}`);
/** Numbers beside each other: not with a comma where that is the decimal sign. */
export const listed = (values) => values.join(decimal === "," ? "; " : ", ");
/** A number as it is typed, also with the decimal sign of the language; NaN where it is none. */
export const typed = (text) => Number(decimal === "," && /^[^,]*\d,\d[^,]*$/.test(text) ? text.replace(",", ".") : text);

/** The text under a key as it stands, undefined where there is none. */
export const known = (key) => table[key];

/** The text under a key, with values in their places. */
export function text(key, values = {}) {
  const found = table[key] ?? key, said = typeof found === "string" ? found : found[plural.select(values.n)] ?? found.other;
  const shown = (value) => (typeof value !== "number" ? value : Number.isInteger(value) ? count(value) : spelled(value));
  return said.replace(/\{(\w+)\}/g, (whole, name) => (name in values ? shown(values[name]) : whole));
}

/** A name that may have a text under a `prefix`, also with values, `[name, values]`; else it is a formula, and shown as such. */
export function named(prefix, name) {
  const [key, values] = [name].flat();
  return known(`${prefix}.${key}`) === undefined ? spelled(key) : text(`${prefix}.${key}`, values);
}

/** The language that a link asks for, undefined where for none that there is. */
export const languageOf = (hash) => {
  const asked = new URLSearchParams(hash.replace(/^#/, "")).get("lang");
  return Object.hasOwn(languages, asked) ? asked : undefined;
};
/** A link that asks for a language, or for none. */
export function inLanguage(hash, asked) {
  const parts = hash.replace(/^#/, "").split("&").filter((part) => part && !/^lang(=|$)/.test(part));
  return [...parts, ...(asked ? [`lang=${asked}`] : [])].map((part, i) => (i ? "&" : "#") + part).join("");
}
