// A lesson that measures: error over cost, its points as they come.
import { text } from "../language/texts.js";
import { workPrecision } from "../service/api.js";
import { element, faultText } from "../forms/forms.js";
import { title } from "../catalogue/card.js";
import { PrecisionPlot } from "../drawing/precision.js";

export class Study {
  #schemes;
  #plot;
  #said = element("p", { className: "note" });
  outcome = null; // the curves: `[{title, points}]`

  constructor(figures, schemes) {
    const container = element("div", { className: "precision", role: "img", ariaLabel: text("lesson.costs") });
    figures.replaceChildren(element("figure", { className: "of-all" }, container, this.#said));
    this.#schemes = schemes;
    this.#plot = new PrecisionPlot(container);
  }

  /** Measures; rejects when it was stopped. `seen()` hears when every scheme has a stretch of its curve. */
  async run(request, signal, seen) {
    let head = null, drawn = false;
    const take = (line) => {
      if (line.point) {
        this.#plot.add(line.curve, { ...line.point, setting: line.setting });
        this.outcome[line.curve].points.push(line.point);
        if (drawn || this.outcome.some(({ points }) => points.length < 2)) return;
        drawn = true;
        seen();
      } else if (!head) {
        head = line;
        this.outcome = line.schemes.map(({ step: _, sigma: __, ...scheme }) => (
          { title: title(this.#schemes.find(({ id }) => id === scheme.id), scheme), points: [] }));
        this.#plot.start(this.outcome.map((curve) => curve.title), line.floor);
      }
    };
    const { faults = [] } = await workPrecision(request, signal, take);
    this.#said.textContent = faults.map(faultText)[0] ?? "";
  }

  /** The runs that a workbench begins with. */
  requests({ schemes, ...scene }) {
    return schemes.map((scheme) => ({ ...scene, scheme }));
  }

  draw() {
    this.#plot.draw();
  }
}
