// Records the animation as a film: the visible pictures beside each other, frame by frame as they are drawn.

const kind = "video/webm";
export const canFilm = () => Boolean(globalThis.MediaRecorder?.isTypeSupported(kind));

export class Film {
  #parts; // [{width, height, copyTo(pen, left, top)}], of one height or less
  #pen;
  #recorder;
  #bytes = [];

  /** Films `parts` on a `ground`, from now on; `made(blob)` hears of the film at its end. */
  constructor(parts, ground, made) {
    this.#parts = parts;
    const canvas = Object.assign(document.createElement("canvas"), {
      width: parts.reduce((sum, { width }) => sum + width, 0), height: Math.max(...parts.map(({ height }) => height)) });
    this.#pen = canvas.getContext("2d");
    this.#pen.fillStyle = ground;
    this.#recorder = new MediaRecorder(canvas.captureStream(), { mimeType: kind, videoBitsPerSecond: 8e6 });
    this.#recorder.addEventListener("dataavailable", ({ data }) => this.#bytes.push(data));
    this.#recorder.addEventListener("stop", () => made(new Blob(this.#bytes, { type: kind })));
    this.frame();
    this.#recorder.start();
  }

  frame() {
    const { canvas } = this.#pen;
    this.#pen.fillRect(0, 0, canvas.width, canvas.height);
    let left = 0;
    for (const part of this.#parts) {
      part.copyTo(this.#pen, left, 0);
      left += part.width;
    }
  }

  end() {
    if (this.#recorder.state !== "inactive") this.#recorder.stop();
  }
}
