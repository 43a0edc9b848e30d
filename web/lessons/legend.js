// The runs of a lesson in words and numbers, the work beside each.
import { count, named, text } from "../language/texts.js";
import { colourOf } from "../catalogue/card.js";
import { element } from "../forms/forms.js";
import { format } from "../forms/numbers.js";
import { told } from "./requests.js";

/**
 * Fills `table` with runs `[{title, colour, outcome}]` and what a lesson tells of each, `[[name, path]]`: each run is a body, with
 * its name above the numbers, or before the only one.
 */
export function fill(table, runs, { tells = [], views }) {
  const names = [text("lesson.forces"), ...tells.map(([name]) => named("term", name))], single = names.length === 1;
  const head = element("tr", {}, ...(single ? [text("lesson.run"), ...names] : names).map((textContent) => element("th", { scope: "col", textContent })));
  const cell = (value, textContent) => element("td", {}, element("data", { value: value ?? "", textContent }));
  const bodies = runs.map(({ title, colour, outcome }) => {
    const swatch = element("span", { className: "swatch" });
    swatch.style.background = `var(${colour})`;
    const name = element("th", single ? { scope: "row" } : { scope: "rowgroup", colSpan: names.length }, swatch, ` ${title.replaceAll(" = ", "\u00a0=\u00a0")}`);
    const numbers = [cell(outcome.cost.force_evaluations, count(outcome.cost.force_evaluations)),
                     ...tells.map(([, path]) => cell(told(outcome, path), format(told(outcome, path), 4)))];
    const rows = single ? [[name, ...numbers]] : [[name], numbers];
    return element("tbody", {}, ...rows.map((cells) => element("tr", {}, ...cells)));
  });
  const known = [...new Set(views.flatMap(({ exact = [] }) => exact.map(([name]) => named("term", name))))];
  const marked = runs.some(({ trajectory }) => trajectory?.mode?.includes("jacobi_maupertuis"));
  const several = views.find((view) => view.several)?.several ?? [];
  const said = [...several.map(([, name], i) => ["", named("term", name), colourOf(i)]), ...(known.length ? [["dashed", known.join(", ")]] : []), ...(marked ? [["", text("jacobi")]] : [])];
  const caption = said.length ? [element("caption", {}, ...said.map(([kind, name, colour]) => {
    const key = element("span", { className: `swatch ${kind}` });
    if (colour) key.style.background = `var(${colour})`;
    return element("div", {}, key, ` ${name}`);
  }))] : [];
  table.replaceChildren(...caption, element("thead", {}, head), ...bodies);
}
