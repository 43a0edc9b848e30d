// The clock of a picture: play, pause, speed, and a slider for the time. It tells `moved(t)` what to show, null for all.
import { element } from "./forms.js";
import { spelled, text } from "../language/texts.js";
import { format } from "./numbers.js";

const whole = 20; // seconds that all of a run takes at speed 1
const still = matchMedia("(prefers-reduced-motion: reduce)");

export class Player {
  #moved;
  #span = [0, 1];
  #unit = "";
  #time = null;
  #frame = 0;
  #last = 0;
  #button = element("button", { type: "button", textContent: text("player.play"), className: "play" });
  #slider = element("input", { type: "range", min: 0, max: 1000, step: 1, value: 1000 });
  #speed = element("select");
  #said = element("output");

  constructor(container, moved) {
    this.#moved = moved;
    for (const by of [0.25, 1, 4]) this.#speed.append(element("option", { value: by, textContent: `${spelled(by)} ×`, selected: by === 1 }));
    container.append(this.#button, element("label", { className: "time" }, element("span", { textContent: text("player.time") }), this.#slider),
                     this.#said, element("label", {}, `${text("player.speed")} `, this.#speed));
    this.#button.addEventListener("click", () => this.toggle());
    this.#slider.addEventListener("input", () => {
      this.pause();
      const [from, to] = this.#span, part = this.#slider.value / 1000;
      this.#set(part === 1 ? null : from + part * (to - from));
    });
  }

  get playing() {
    return this.#frame !== 0;
  }

  get time() {
    return this.#time;
  }

  /** Sets the times of the runs, in their `unit`; `to` < `from` for runs backward. The present time stays if it is among them. */
  span(from, to, unit = "") {
    this.#span = [from, to];
    this.#unit = unit && ` ${unit}`;
    const part = (this.#time - from) / (to - from);
    if (this.#time !== null && !(part >= 0 && part < 1)) this.#time = from;
    this.#set(this.#time);
  }

  /** Plays from the start, unless the user prefers reduced motion. */
  begin() {
    if (still.matches) return this.rest();
    this.#set(this.#span[0]);
    this.play();
  }

  /** Pauses, and shows whole runs. */
  rest() {
    this.pause();
    this.#set(null);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (this.playing) return;
    if (this.#time === null) this.#set(this.#span[0]);
    this.#last = performance.now();
    this.#button.textContent = text("player.pause");
    this.#frame = requestAnimationFrame((now) => this.#tick(now));
  }

  pause() {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    this.#button.textContent = text("player.play");
  }

  #tick(now) {
    const [from, to] = this.#span, passed = Math.max(0, Math.min(0.1, (now - this.#last) / 1000));
    this.#last = now;
    const time = this.#time + (passed / whole) * this.#speed.value * (to - from);
    if ((time - to) * (to - from) >= 0) return this.rest();
    this.#set(time);
    this.#frame = requestAnimationFrame((next) => this.#tick(next));
  }

  #set(time) {
    this.#time = time;
    const [from, to] = this.#span;
    this.#slider.value = time === null ? 1000 : ((time - from) / (to - from)) * 1000;
    this.#said.textContent = `t = ${format(time ?? to, 4)}${this.#unit}`;
    this.#slider.setAttribute("aria-valuetext", this.#said.textContent);
    this.#moved(time);
  }
}
