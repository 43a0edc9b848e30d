// What studies have in common: a part of the page with a heading, a form, a button, a picture and what is said of it.
import { text } from "../language/texts.js";
import { build, element, values, words } from "../forms/forms.js";

export const patience = 60; // seconds that the service may take

/**
 * A study with the name `id`, at the end of the studies, with its texts under `study.ID` and its form from `cardsOf(problem)`.
 * The button is `#measure-ID`, what is said `#ID-status`; `more` stands after the picture.
 */
export class Study {
  #id;
  #cardsOf;
  #part;
  problem = null;

  constructor(id, cardsOf, ...more) {
    this.#id = id;
    this.#cardsOf = cardsOf;
    const own = (name) => text(`study.${id}.${name}`), heading = element("h2", { id: `${id}-title`, textContent: own("title") });
    const canvas = element("canvas", { className: "plane", role: "img", ariaLabel: own("picture") });
    const said = element("p", { className: "note", id: `${id}-status`, role: "status", ariaLive: "polite" });
    this.#part = element("section", { id }, heading, element("p", { className: "note", textContent: own("doc") }),
      element("div", { className: "fields" }),
      element("div", { className: "choices" }, element("button", { type: "button", id: `measure-${id}`, textContent: own("button") })),
      said, element("figure", { hidden: true }, element("figcaption"), canvas), ...more);
    this.#part.setAttribute("aria-labelledby", heading.id);
    document.querySelector("#studies").append(this.#part);
  }

  find(selector) {
    return this.#part.querySelector(selector);
  }

  /** The form for a problem, with `wanted` values as a link holds them. */
  offer(problem, wanted) {
    this.problem = problem;
    build(this.find(".fields"), this.#cardsOf(problem), `/${this.#id}`, wanted);
    this.clear();
  }

  /** The values of the form, or only the `changed` ones. */
  chosen(changed = false) {
    return values(this.find(".fields"), changed);
  }
}

/** The runs of a study of many, each by its number, in a part of `study` that is hidden until there are some. */
export class Members {
  #n = 0;
  #run;
  #number = element("input", { type: "number", min: 0, value: 0 });
  #node;

  constructor(study, run) {
    const button = element("button", { type: "button", textContent: text("member.run") });
    this.#run = run;
    this.#node = element("span", { className: "member", hidden: true }, element("label", {}, `${text("member")} `, this.#number), " ", button);
    button.addEventListener("click", () => this.pick(Number(this.#number.value)));
    study.find(".choices").append(this.#node);
  }

  /** Sets the number of members. */
  offer(n) {
    this.#n = n;
    this.#number.max = n - 1;
    this.#node.hidden = n === 0;
  }

  pick(member) {
    if (!(member >= 0 && member < this.#n)) return;
    this.#number.value = String(member);
    this.#run(member);
  }
}

/** The closing line to use for an answer that broke off without one. */
export const broken = () => ({ completed: 0, stopped: {}, warnings: [{ detail: text("study.broken") }] });

/** Notes on many runs from the closing line of the answer: why it ended early, why runs `stopped`, its warnings. */
export const notesOf = ({ stop, stopped, warnings }) => [
  ...(stop ? [text("ended.early", { why: words(stop.reason) })] : []),
  ...Object.entries(stopped).map(([reason, n]) => text("study.stopped", { n, why: words(reason) })),
  ...warnings.map(({ detail, code }) => detail || code)];

/** A table of texts: `heads` above, rows `[name, …cells]`, the name a heading of its own; it scrolls by itself. */
export function tableOf(label, heads, rows) {
  const cells = (tag, texts, more) => texts.map((textContent) => element(tag, { textContent, ...more }));
  const body = rows.map(([name, ...texts]) => element("tr", {}, ...cells("th", [name], { scope: "row" }), ...cells("td", texts)));
  const table = element("table", { ariaLabel: label }, element("thead", {}, element("tr", {}, ...cells("th", heads, { scope: "col" }))),
                        element("tbody", {}, ...body));
  return element("div", { className: "scroll derived", tabIndex: 0, role: "group", ariaLabel: label }, table);
}
