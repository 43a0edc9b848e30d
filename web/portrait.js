// A lesson of many runs at once: the points where they cross a plane, or where a clock finds them.
import { ensemble } from "./api.js";
import { Crossings } from "./crossings.js";
import { element, faultText } from "./forms.js";

export class Portrait {
  #crossings;
  #said = element("p", { className: "note" });
  #labels;
  #underWay = null;
  outcome = null; // the points: `{member, x, y}`

  constructor(stage, labels) {
    const canvas = element("canvas", { className: "plane", role: "img", ariaLabel: `${labels[1]} over ${labels[0]} of many runs` });
    stage.replaceChildren(element("figure", { className: "of-all" }, canvas, this.#said));
    this.#crossings = new Crossings(canvas);
    this.#labels = labels;
  }

  /** Runs all members; resolves at the end, or when it was stopped: to whether it is still the newest. */
  async run(request) {
    this.stop();
    const mine = (this.#underWay = new AbortController()), [x, y] = request.columns, [{ grid }] = Object.values(request.members.vary);
    let begun = false;
    try {
      const { faults = [] } = await ensemble(request, mine.signal, (line) => {
        if (line.kind !== "block") return;
        if (!begun) this.#crossings.start(grid[2], x, y, this.#labels); // until then the last picture stays
        begun = true;
        this.#crossings.add(line);
      });
      this.#said.textContent = faults.map(faultText)[0] ?? "";
    } catch (error) {
      if (!mine.signal.aborted) throw error;
    }
    if (mine !== this.#underWay) return false;
    const all = (name) => this.#crossings.blocks.flatMap((block) => block[name]);
    this.outcome = { member: all("member"), x: all("x"), y: all("y") };
    return true;
  }

  /** The runs that a workbench begins with. */
  requests({ problem, initial, until, scheme }) {
    return [{ problem, initial, until, scheme }];
  }

  stop() {
    this.#underWay?.abort();
  }

  draw() {
    this.#crossings.draw();
  }
}
