// The buttons that take what is in sight away as files.
import { element } from "./forms.js";
import { csvOf, download, pngOf } from "./take.js";

export class Takeaway {
  /** `seen()`: `{planes: [[name, plane]], runs: [{name, trajectory}], problem}`. */
  constructor(seen) {
    const save = {
      CSV: ({ runs, problem }) => download(`${problem}.csv`, new Blob([csvOf(runs)], { type: "text/csv" })),
      PNG: async ({ planes, problem }) => {
        for (const [name, plane] of planes) download(`${problem}-${name}.png`, await pngOf(plane.canvas));
      },
      SVG: ({ planes, problem }) => {
        for (const [name, plane] of planes) download(`${problem}-${name}.svg`, new Blob([plane.svg()], { type: "image/svg+xml" }));
      },
    };
    document.querySelector("#take").append(...Object.entries(save).map(([kind, act]) => {
      const button = element("button", { type: "button", textContent: kind });
      button.addEventListener("click", () => act(seen()));
      return button;
    }));
  }
}
