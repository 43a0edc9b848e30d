// Saves what is shown as files: trajectories as a table, pictures, films; with the buttons for them.
import { text } from "../language/texts.js";
import { element } from "../forms/forms.js";
import { canFilm, Film } from "./film.js";

/** The trajectories of runs `[{name, trajectory, outcome}]` as a table: a line for each sample, the run first, then its way back. */
function csvOf(given) {
  const runs = given.flatMap(({ name, trajectory, outcome }) => [{ name, trajectory },
    ...(outcome?.back ? [{ name: `${name} back`, trajectory: outcome.back.trajectory }] : [])]);
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

/** A title as the name of a file. */
const named = (title) => title.toLowerCase().normalize("NFD").replace(/[\u0300-\u036f]/g, "").replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "") || "scene";

export class FileButtons {
  #film = null;

  /** `seen()`: `{planes: [[name, plane]], runs: [{name, trajectory}], title}`; `play(frame)` plays all and tells `frame(t)`. */
  constructor(seen, play) {
    const save = {
      CSV: ({ runs, title }) => download(`${named(title)}.csv`, new Blob([csvOf(runs)], { type: "text/csv" })),
      PNG: async ({ planes, title }) => {
        for (const [name, plane] of planes) download(`${named(title)}-${name}.png`, await plane.png(3));
      },
      SVG: ({ planes, title }) => {
        for (const [name, plane] of planes) download(`${named(title)}-${name}.svg`, new Blob([plane.svg()], { type: "image/svg+xml" }));
      },
      ...(canFilm() ? { WebM: (given, button) => this.#roll(given, button, play) } : {}),
    };
    document.querySelector("#take").append(...Object.entries(save).map(([kind, act]) => {
      const button = element("button", { type: "button", textContent: kind });
      button.addEventListener("click", () => act(seen(), button));
      return button;
    }));
  }

  /** Films what plays from the start to the end, or until the button is pressed again. */
  #roll({ planes, title }, button, play) {
    if (this.#film) return this.#film.end();
    const ground = getComputedStyle(planes[0][1].canvas).getPropertyValue("--paper");
    const film = (this.#film = new Film(planes.map(([, plane]) => plane), ground, (blob) => {
      this.#film = null;
      button.textContent = "WebM";
      download(`${named(title)}.webm`, blob);
    }));
    button.textContent = text("save.film");
    play((t) => {
      if (this.#film !== film) return;
      film.frame();
      if (t === null) film.end();
    });
  }
}
