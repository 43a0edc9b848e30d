// A slider with its number.
import { spelled, typed as read } from "../language/texts.js";
import { element } from "./forms.js";
import { scaleOf, tidy } from "./ranges.js";

/**
 * `label` with a slider and a field for its number. `moved(value, done)` hears of each change; `done` is false while the
 * hand is on it. `set(value)` moves it from outside.
 */
export function slider(label, range, value, moved) {
  const scale = scaleOf(range);
  const track = element("input", { type: "range", min: 0, max: 1000, step: 1, ariaLabel: label });
  const number = element("input", { type: "text", inputMode: "decimal", spellcheck: false });
  const node = element("div", { className: "slider" },
                       element("label", { className: "field" }, element("span", { className: "name", textContent: label }), number), track);
  const set = (to, shown = String(Number(to.toPrecision(6)))) => { // of 1/12 as many digits as there is room for
    number.value = shown;
    track.value = scale.of(to);
    track.setAttribute("aria-valuetext", spelled(to));
  };
  const slide = (done) => {
    const to = tidy(scale.at(Number(track.value)), range);
    set(to);
    moved(to, done);
  };
  track.addEventListener("input", () => slide(false));
  track.addEventListener("change", () => slide(true));
  number.addEventListener("change", () => {
    const typed = read(number.value);
    if (number.value.trim() === "" || !Number.isFinite(typed)) return set(value);
    set((value = typed), String(typed));
    moved(typed, true);
  });
  set(value);
  return { node, set };
}
