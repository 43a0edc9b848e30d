// The runs of a lesson in words and numbers, the work beside each.
import { told } from "./asked.js";
import { element } from "./forms.js";
import { count, format } from "./numbers.js";

/** Fills `table` with runs `[{title, colour, outcome}]` and what a lesson tells of each, `[[name, path]]`. */
export function fill(table, runs, tells = []) {
  const head = element("tr", {}, ...["run", "force evaluations", ...tells.map(([name]) => name)].map((textContent) =>
    element("th", { scope: "col", textContent })));
  const cell = (value, textContent) => element("td", {}, element("data", { value: value ?? "", textContent }));
  const rows = runs.map(({ title, colour, outcome }) => {
    const swatch = element("span", { className: "swatch" });
    swatch.style.background = `var(${colour})`;
    return element("tr", {}, element("th", { scope: "row" }, swatch, ` ${title}`),
                   cell(outcome.cost.force_evaluations, count(outcome.cost.force_evaluations)),
                   ...tells.map(([, path]) => cell(told(outcome, path), format(told(outcome, path), 4))));
  });
  table.replaceChildren(element("thead", {}, head), element("tbody", {}, ...rows));
}
