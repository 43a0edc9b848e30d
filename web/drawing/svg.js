// A pen that writes SVG: as much of a canvas's as pictures are drawn with.

const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
const short = (v) => String(Math.round(v * 100) / 100);

export class SvgPen {
  #parts = [];
  #path = "";
  #open = 0; // groups
  #saved = [];
  #clips = 0;
  strokeStyle = "#000";
  fillStyle = "#000";
  lineWidth = 1;
  lineJoin = "miter";
  globalAlpha = 1;
  font = "13px sans-serif";
  textAlign = "left";
  textBaseline = "alphabetic";
  #dash = "";

  setLineDash(dash) {
    this.#dash = dash.join(" ");
  }
  beginPath() {
    this.#path = "";
  }
  moveTo(x, y) {
    this.#path += `M${short(x)} ${short(y)}`;
  }
  lineTo(x, y) {
    this.#path += `L${short(x)} ${short(y)}`;
  }
  rect(x, y, width, height) {
    this.#path += `M${short(x)} ${short(y)}h${short(width)}v${short(height)}h${short(-width)}z`;
  }
  /** Circles only. */
  arc(x, y, r) {
    this.#path += `M${short(x - r)} ${short(y)}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;
  }
  #draw(style) {
    if (this.#path) this.#parts.push(`<path d="${this.#path}" ${style}${this.globalAlpha < 1 ? ` opacity="${this.globalAlpha}"` : ""}/>`);
  }
  stroke() {
    const dash = this.#dash ? ` stroke-dasharray="${this.#dash}"` : "";
    this.#draw(`fill="none" stroke="${escaped(this.strokeStyle)}" stroke-width="${short(this.lineWidth)}" stroke-linejoin="${this.lineJoin}"${dash}`);
  }
  fill() {
    this.#draw(`fill="${escaped(this.fillStyle)}"`);
  }
  strokeRect(...box) {
    this.beginPath();
    this.rect(...box);
    this.stroke();
  }
  fillText(text, x, y) {
    const anchor = { center: "middle", right: "end" }[this.textAlign] ?? "start";
    const base = { top: "hanging", middle: "central" }[this.textBaseline] ?? "auto";
    this.#parts.push(`<text x="${short(x)}" y="${short(y)}" text-anchor="${anchor}" dominant-baseline="${base}" ` +
                     `fill="${escaped(this.fillStyle)}" style="font:${escaped(this.font)}">${escaped(text)}</text>`);
  }
  #group(attributes) {
    this.#parts.push(`<g ${attributes}>`);
    this.#open++;
  }
  clip() {
    this.#parts.push(`<clipPath id="c${++this.#clips}"><path d="${this.#path}"/></clipPath>`);
    this.#group(`clip-path="url(#c${this.#clips})"`);
  }
  translate(x, y) {
    this.#group(`transform="translate(${short(x)} ${short(y)})"`);
  }
  rotate(angle) {
    this.#group(`transform="rotate(${short((angle * 180) / Math.PI)})"`);
  }
  save() {
    this.#saved.push(this.#open);
  }
  restore() {
    const before = this.#saved.pop();
    for (; this.#open > before; this.#open--) this.#parts.push("</g>");
  }

  document(width, height, ground) {
    return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}">` +
           `<rect width="100%" height="100%" fill="${escaped(ground)}"/>${this.#parts.join("\n")}</svg>\n`;
  }
}
