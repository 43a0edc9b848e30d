// A study as a part of the page: its heading, its form, its button, a picture and what is said of it.
import { text } from "../language/texts.js";
import { element } from "../forms/forms.js";

/**
 * Makes the part `id` at the end of the studies and returns `find(selector)` within it. Its texts are those under
 * `study.ID`. The button is `#measure-ID`, what is said `#ID-status`; `more` stands after the picture.
 */
export function partOf(id, ...more) {
  const own = (name) => text(`study.${id}.${name}`);
  const heading = element("h2", { id: `${id}-title`, textContent: own("title") });
  const canvas = element("canvas", { className: "plane", role: "img", ariaLabel: own("picture") });
  const said = element("p", { className: "note", id: `${id}-status`, role: "status", ariaLive: "polite" });
  const section = element("section", { id }, heading, element("p", { className: "note", textContent: own("doc") }),
    element("div", { className: "fields" }),
    element("div", { className: "choices" }, element("button", { type: "button", id: `measure-${id}`, textContent: own("button") })),
    said, element("figure", { hidden: true }, element("figcaption"), canvas), ...more);
  section.setAttribute("aria-labelledby", heading.id);
  document.querySelector("#studies").append(section);
  return (selector) => section.querySelector(selector);
}

/** A table of texts: `heads` above, rows `[name, …cells]`, the name a heading of its own; it scrolls by itself. */
export function tableOf(label, heads, rows) {
  const cells = (tag, texts, more) => texts.map((textContent) => element(tag, { textContent, ...more }));
  const body = rows.map(([name, ...texts]) => element("tr", {}, ...cells("th", [name], { scope: "row" }), ...cells("td", texts)));
  const table = element("table", { ariaLabel: label }, element("thead", {}, element("tr", {}, ...cells("th", heads, { scope: "col" }))),
                        element("tbody", {}, ...body));
  return element("div", { className: "scroll derived", tabIndex: 0, role: "group", ariaLabel: label }, table);
}
