// Finds the points of a curve that need no corner of their own: those visibly on the straight line between others.

const eye = 0.3; // pixels that nobody sees

export class Straight {
  #left = 0; // the last corner
  #top = 0;
  #far = 0; // how far the way has come from there, squared
  // The straight lines from the corner that pass all later points lie between two directions, the right one and the left one.
  #rightX = 0;
  #rightY = 0;
  #leftX = 0;
  #leftY = 0;

  /** Sets the corner from which the next straight line begins. */
  from(left, top) {
    this.#left = left;
    this.#top = top;
    this.#far = 0;
  }

  /** Whether the curve, now at (a, b), needs a corner at the point before. */
  turns(a, b) {
    const x = a - this.#left, y = b - this.#top, square = x * x + y * y, first = this.#far === 0;
    if (square < eye * eye) return !first; // it came back, or has not left yet
    if (!first && (square < this.#far || this.#rightX * y < this.#rightY * x || x * this.#leftY < y * this.#leftX)) return true;
    const by = eye / Math.sqrt(square), [u, v] = [by * x, by * y];
    this.#far = square;
    if (first || this.#rightX * (y - u) > this.#rightY * (x + v)) [this.#rightX, this.#rightY] = [x + v, y - u];
    if (first || (x - v) * this.#leftY > (y + u) * this.#leftX) [this.#leftX, this.#leftY] = [x - v, y + u];
    return false;
  }
}
