// What is in sight as files: trajectories as a table, pictures, and the buttons for them.
import { element } from "../forms/forms.js";

/** The trajectories of runs `[{name, trajectory}]` as a table: a line for each sample, the run first. */
function csvOf(runs) {
  const columns = [...new Set(runs.flatMap(({ trajectory }) => Object.keys(trajectory)))];
  const lines = runs.flatMap(({ name, trajectory }) => trajectory.t.map((_, i) =>
    [name, ...columns.map((column) => trajectory[column]?.[i] ?? "")].join(",")));
  return [["run", ...columns].join(","), ...lines].join("\n") + "\n";
}

/** Offers a file to the reader. */
function download(name, blob) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A canvas as a picture on the page's ground. */
function pngOf(canvas) {
  const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
  const pen = copy.getContext("2d");
  pen.fillStyle = getComputedStyle(canvas).getPropertyValue("--paper");
  pen.fillRect(0, 0, copy.width, copy.height);
  pen.drawImage(canvas, 0, 0);
  return new Promise((resolve) => copy.toBlob(resolve, "image/png"));
}

export class FileButtons {
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
