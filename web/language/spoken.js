// Which language is spoken, that of the link or else the first of those that the browser asks for, and the texts of the document in
// it. The document loads this module beside the others: the texts are on their way while those are still fetched.
import { inLanguage, language, languageOf, languages, learn, speak, text } from "./texts.js";

const wished = [languageOf(location.hash), ...navigator.languages.map((one) => one.split("-")[0])];
const chosen = wished.find((one) => Object.hasOwn(languages, one)) ?? "en";

async function table(name) {
  const response = await fetch(`language/${name}.json`);
  if (!response.ok) throw new Error(`language/${name}.json: ${response.status}`);
  return response.json();
}

/** Resolves when the texts are there. */
export const ready = table(chosen).then((texts) => {
  speak(chosen, texts);
  document.documentElement.lang = chosen;
});

/** Fetches what the catalogue says, which the service says in English by itself. */
export const learnCatalogue = async () => (chosen === "en" ? {} : learn(await table(`${chosen}.catalogue`)));

/** Fills what has keys for its text (`data-text`), its title (`data-text-title`) or its name (`data-text-label`), also in templates. */
export function fill(root) {
  for (const node of root.querySelectorAll("[data-text], [data-text-title], [data-text-label]")) {
    const { text: own, textTitle, textLabel } = node.dataset;
    if (own) node.textContent = text(own);
    if (textTitle) node.title = text(textTitle);
    if (textLabel) node.ariaLabel = text(textLabel);
  }
  for (const template of root.querySelectorAll("template")) fill(template.content);
}

/** Lets a reader choose by `select`: what is seen stands in the address, which is read again. `first` is what an empty one means. */
export function offer(select, first) {
  select.append(...Object.entries(languages).map(([value, title]) => (
    Object.assign(document.createElement("option"), { value, lang: value, textContent: value.toUpperCase(), title }))));
  select.value = language();
  select.addEventListener("change", () => {
    history.replaceState(history.state, "", inLanguage(location.hash || first, select.value));
    location.reload();
  });
}
