// Actions of a pointer on a picture: it drags it (or the start of a run), enlarges it, points at a place. The arrow keys drag
// the picture when one of its buttons has the focus.
import { text } from "../language/texts.js";
import { element } from "../forms/forms.js";

const reach = 16; // pixels from which a start is taken hold of

/** The time of the sample nearest to a place, of all curves of the picture; null if none is within 40 pixels. */
function timeNear(plane, { left, top }) {
  let nearest = 40 ** 2, at = null;
  for (const { t, x, y, exact } of plane.picture.curves) {
    if (exact || !t) continue;
    const every = Math.max(1, Math.floor(t.length / 4000));
    for (let i = 0; i < t.length; i += every) {
      if (x[i] === null) continue;
      const d = (plane.map.x(x[i]) - left) ** 2 + (plane.map.y(y[i]) - top) ** 2;
      if (d < nearest) [nearest, at] = [d, t[i]];
    }
  }
  return at;
}

/** The index of the curve whose start is at a place and can be dragged; −1: none. */
const onStart = (plane, { left, top }) => plane.picture.curves.findIndex(({ x, y, grab }) =>
  grab && x[0] !== null && Math.hypot(plane.map.x(x[0]) - left, plane.map.y(y[0]) - top) < reach);

/** Enlarges by a factor about a place. */
function enlarge(plane, factor, place) {
  const { map, frame } = plane, by = (plane.zoom?.by ?? 1) * factor;
  if (!map || by > 1e6 || by < 1e-3) return;
  const at = place ?? { left: frame.left + frame.width / 2, top: frame.top + frame.height / 2 };
  const { x, y } = map.at(at.left, at.top), { centre } = map;
  plane.zoom = { by, x: x + (centre.x - x) / factor, y: y + (centre.y - y) / factor };
  plane.draw();
}

function shift(plane, right, down) {
  const { map } = plane;
  if (!map) return;
  plane.zoom = { by: plane.zoom?.by ?? 1, x: map.centre.x - right / map.scale.x, y: map.centre.y + down / map.scale.y };
  plane.draw();
}

function whole(plane) {
  plane.zoom = null;
  plane.draw();
}

/** Listens to pointer and wheel over `node`, whose `canvas` shows `plane`. */
export function follow(plane, node, canvas, hovered) {
  const button = (textContent, title, act) => {
    const made = element("button", { type: "button", textContent, title, ariaLabel: title });
    made.addEventListener("click", act);
    return made;
  };
  node.append(element("div", { className: "lens" }, button("+", text("lens.enlarge"), () => enlarge(plane, 1.5)),
                       button("−", text("lens.smaller"), () => enlarge(plane, 1 / 1.5)), button("⟲", text("lens.all"), () => whole(plane))));
  node.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: [-24, 0], ArrowRight: [24, 0], ArrowUp: [0, -24], ArrowDown: [0, 24] }[event.key];
    if (!way || !plane.picture || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation(); // no other lesson
    if (plane.picture.turn) plane.picture.turn(...way);
    else shift(plane, ...way);
  });
  const placeOf = (event) => {
    const box = canvas.getBoundingClientRect();
    return { left: event.clientX - box.left, top: event.clientY - box.top };
  };
  let drag = null, tapped = null, picked = { when: -Infinity }; // the last click
  const again = ({ left, top }) => performance.now() - picked.when < 500 && Math.hypot(left - picked.left, top - picked.top) < 8;
  const pick = (from, place) => {
    if (Math.hypot(place.left - from.left, place.top - from.top) >= 4 || again(place)) return;
    picked = { ...place, when: performance.now() };
    plane.picture?.pick?.(place.left, place.top);
  };
  node.addEventListener("pointerdown", (event) => {
    if (!plane.map || event.button !== 0 || event.target.closest("button")) return;
    const place = placeOf(event);
    const start = onStart(plane, place);
    tapped = null;
    if (event.pointerType === "touch" && start < 0 && !plane.zoom && !plane.picture.turn) { // the page is scrolled, or it is a tap
      tapped = place;
      return;
    }
    drag = { ...place, start, from: place };
    node.setPointerCapture(event.pointerId);
    plane.hold(start >= 0);
    plane.hair(null);
  });
  node.addEventListener("pointermove", (event) => {
    if (!plane.map) return;
    const place = placeOf(event);
    if (!drag) {
      plane.hair(place);
      node.classList.toggle("grabbing", onStart(plane, place) >= 0);
      return hovered(timeNear(plane, place));
    }
    const { x, y } = plane.map.at(place.left, place.top);
    if (drag.start >= 0) plane.picture.curves[drag.start]?.grab(x, y, false);
    else if (plane.picture.turn) plane.picture.turn(place.left - drag.left, place.top - drag.top);
    else shift(plane, place.left - drag.left, place.top - drag.top);
    Object.assign(drag, place, { moved: true });
  });
  const release = (event) => {
    if (tapped && event.type === "pointerup") pick(tapped, placeOf(event));
    tapped = null;
    if (!drag) return;
    const { start, from, moved } = drag, { left, top } = placeOf(event);
    drag = null;
    plane.hold(false);
    if (start < 0) return void (event.type === "pointerup" && pick(from, { left, top }));
    if (!moved) return;
    const { x, y } = plane.map.at(left, top);
    plane.picture.curves[start]?.grab(x, y, true);
  };
  node.addEventListener("pointerup", release);
  node.addEventListener("pointercancel", release);
  node.addEventListener("pointerleave", () => {
    if (drag) return;
    plane.hair(null);
    hovered(null);
  });
  node.addEventListener("dblclick", (event) => {
    if (event.target.closest("button")) return;
    whole(plane);
    if (again(placeOf(event))) plane.picture?.unpick?.(); // the first of its two clicks
  });
  node.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return; // the page is scrolled
    event.preventDefault();
    enlarge(plane, Math.exp(-event.deltaY / 300), placeOf(event));
  }, { passive: false });
}
