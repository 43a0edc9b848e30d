// The pictures of a lesson: those of its views, each run's or all runs', the bodies, and the one of a presentation.
import { named, text } from "../language/texts.js";
import { element } from "../forms/forms.js";
import { Bodies } from "../drawing/bodies.js";
import { Plane } from "../drawing/plane.js";
import { begin, turnedBy } from "../drawing/space.js";
import { pictureOf } from "./views.js";

export class Figures {
  #node;
  #hovered;
  #pictures = []; // [{plane, caption, view, runs?: those that it shows}]
  #one = null;
  #bodies = [];
  #angles = begin;
  #again = () => {};

  /** `hovered(t)` hears at which time of a run a hand points. */
  constructor(node, hovered) {
    this.#node = node;
    this.#hovered = hovered;
  }

  /** Empty pictures for a lesson; `titles` of its runs. */
  build({ views = [], apart, layout, one = views.find(({ body }) => !body) }, titles) {
    this.#pictures = [];
    this.#bodies = [];
    this.#node.className = [...(apart ? ["apart"] : []), ...(layout ? [layout] : [])].join(" ");
    this.#node.dataset.views = apart ? titles.length : views.length || 1;
    this.#node.replaceChildren(
      ...(apart ? titles.map((_, i) => this.#plane("of-run", views[0], titles, i))
        : views.map((view) => (view.body ? this.#body(view) : this.#plane(view.run === undefined ? "of-all" : "of-run", view, titles, view.run)))),
      ...(one ? [this.#plane("one", one, titles)] : []));
    this.#one = one ? this.#pictures.pop() : null;
  }

  #plane(name, view, titles, run) {
    const canvas = element("canvas", { className: "plane", role: "img" }), caption = element("figcaption", { textContent: titles[run] ?? "" });
    const figure = element("figure", { className: name }, caption, canvas);
    this.#pictures.push({ plane: new Plane(canvas, this.#hovered), caption, view, run });
    return figure;
  }

  #body({ body }) {
    const canvas = element("canvas", { className: "body", role: "img", ariaLabel: text(typeof body === "string" ? "bodies.each" : "bodies.scene") });
    this.#bodies.push([body, new Bodies(canvas)]);
    return element("figure", { className: "of-body" }, canvas);
  }

  /** Shows runs `[{title, colour, trajectory, outcome, parameters}]` of a lesson; `symbol(name)` of a column. */
  show(lesson, runs, symbol) {
    this.#again = () => this.show(lesson, runs, symbol);
    const settings = { angles: this.#angles, symbol, pace: lesson.pace };
    const seen = ({ run }) => (run === undefined ? runs : runs.slice(run, run + 1));
    const shown = this.#pictures.map((picture) => pictureOf({ ...picture.view, run: undefined }, seen(picture), settings));
    if (lesson.apart && lesson.views[0].x !== "t") { // one view for all
      const views = shown.filter(Boolean).map(({ view }) => view);
      const box = (axis) => [Math.min(...views.map((v) => v[axis][0])), Math.max(...views.map((v) => v[axis][1]))];
      for (const picture of shown) if (picture) picture.view = { ...picture.view, x: box("x"), y: box("y") };
    }
    this.#pictures.forEach((picture, i) => this.#fill(picture, shown[i], runs[picture.run]));
    if (this.#one) this.#fill(this.#one, pictureOf(this.#one.view, runs, settings));
    for (const [body, bodies] of this.#bodies) bodies.show(body, runs);
  }

  #fill({ plane, caption }, picture, run) {
    if (picture?.bare) picture.turn = (right, down) => this.#turn(right, down);
    plane.show(picture);
    plane.canvas.setAttribute("aria-label", picture
      ? text("picture.over", { x: picture.labels[0], y: picture.labels[1], what: picture.curves.map((curve) => curve.title).join(", ") }) : text("picture.none"));
    if (run) caption.textContent = text("lesson.of_run", { title: run.title, count: run.outcome.cost.force_evaluations });
  }

  #turn(right, down) {
    this.#angles = turnedBy(this.#angles, right, down);
    this.#again();
  }

  get #parts() {
    return [...this.#pictures.map(({ plane }) => plane), ...(this.#one ? [this.#one.plane] : []), ...this.#bodies.map(([, bodies]) => bodies)];
  }

  /** The runs as they are at a time; `told`: with the values there. */
  at(t, told) {
    this.#parts.forEach((part) => part.at(t, told));
  }

  draw() {
    this.#parts.forEach((part) => part.draw());
  }
}
