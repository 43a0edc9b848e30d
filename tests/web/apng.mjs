// Joins screenshots to an animation: it reads PNG and writes APNG with a palette. Only what has changed since the frame before
// is in a frame.
import * as zlib from "node:zlib";

const signature = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);

/** A PNG of 8 bits a channel, not interlaced, as `{width, height, pixels}`, a pixel 0xRRGGBB. */
export function decode(png) {
  const [width, height, kind] = [png.readUInt32BE(16), png.readUInt32BE(20), png[25]], parts = [], n = { 2: 3, 6: 4 }[kind];
  if (!n || png[24] !== 8 || png[28]) throw new Error("a PNG of another kind than a browser's");
  for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at)) {
    if (png.toString("latin1", at + 4, at + 8) === "IDAT") parts.push(png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
  }
  const raw = zlib.inflateSync(Buffer.concat(parts)), line = width * n, pixels = new Uint32Array(width * height);
  let above = new Uint8Array(line);
  for (let y = 0; y < height; y++) {
    const filter = raw[y * (line + 1)], row = raw.subarray(y * (line + 1) + 1, (y + 1) * (line + 1));
    for (let i = 0; i < line; i++) {
      const a = i < n ? 0 : row[i - n], b = above[i], c = i < n ? 0 : above[i - n];
      row[i] += [0, a, b, (a + b) >> 1, paeth(a, b, c)][filter];
    }
    for (let x = 0; x < width; x++) pixels[y * width + x] = (row[x * n] << 16) | (row[x * n + 1] << 8) | row[x * n + 2];
    above = row;
  }
  return { width, height, pixels };
}

function paeth(a, b, c) {
  const [u, v, w] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return u <= v && u <= w ? a : v <= w ? b : c;
}

/** The most frequent colours, at most 255, and the index for every colour of the frames; the next index means "unchanged". */
function paletteOf(frames) {
  const often = new Map();
  for (const { pixels } of frames) for (const pixel of pixels) often.set(pixel, (often.get(pixel) ?? 0) + 1);
  const colours = [...often].sort(([, m], [, n]) => n - m).slice(0, 255).map(([colour]) => colour);
  const far = (p, q) => [16, 8, 0].reduce((sum, bits) => sum + (((p >> bits) & 255) - ((q >> bits) & 255)) ** 2, 0);
  const nearest = (p) => colours.reduce((best, q, i) => (far(p, q) < far(p, colours[best]) ? i : best), 0);
  return { colours, at: new Map([...often.keys()].map((colour) => [colour, nearest(colour)])) };
}

function chunk(name, data) {
  const body = Buffer.concat([Buffer.from(name, "latin1"), data]), made = Buffer.alloc(body.length + 8);
  made.writeUInt32BE(data.length);
  body.copy(made, 4);
  made.writeUInt32BE(crc(body), body.length + 4);
  return made;
}

const crc = zlib.crc32 ?? ((bytes) => { // zlib has it since Node 20.15
  let sum = ~0;
  for (const byte of bytes) {
    sum ^= byte;
    for (let k = 0; k < 8; k++) sum = (sum >>> 1) ^ (sum & 1 ? 0xedb88320 : 0);
  }
  return ~sum >>> 0;
});

const numbers = (...values) => Buffer.concat(values.map(([value, size]) => {
  const made = Buffer.alloc(size);
  made.writeUIntBE(value, 0, size);
  return made;
}));

/** The box of what has changed from one list of indices to the next. */
function changed(before, now, width, height) {
  let [left, right, top, bottom] = [width, -1, height, -1];
  for (let i = 0; i < now.length; i++) {
    if (before && before[i] === now[i]) continue;
    const x = i % width, y = (i - x) / width;
    [left, right, top, bottom] = [Math.min(left, x), Math.max(right, x), Math.min(top, y), Math.max(bottom, y)];
  }
  return right < 0 ? { left: 0, top: 0, wide: 1, high: 1 } : { left, top, wide: right - left + 1, high: bottom - top + 1 };
}

/** Frames, each shown for `milliseconds`, over and over. */
export function encode(frames, milliseconds) {
  const [{ width, height }] = frames, { colours, at } = paletteOf(frames), chunks = [];
  let before = null, number = 0;
  for (const { pixels } of frames) {
    const now = Uint8Array.from(pixels, (pixel) => at.get(pixel)), { left, top, wide, high } = changed(before, now, width, height);
    const lines = Buffer.alloc(high * (wide + 1)); // each begins with filter 0: none
    for (let y = 0; y < high; y++) {
      for (let x = 0; x < wide; x++) {
        const i = (top + y) * width + left + x;
        lines[y * (wide + 1) + 1 + x] = before && before[i] === now[i] ? colours.length : now[i];
      }
    }
    const data = zlib.deflateSync(lines, { level: 9 });
    chunks.push(chunk("fcTL", numbers([number++, 4], [wide, 4], [high, 4], [left, 4], [top, 4], [milliseconds, 2], [1000, 2], [0, 1], [before ? 1 : 0, 1])));
    chunks.push(before ? chunk("fdAT", Buffer.concat([numbers([number++, 4]), data])) : chunk("IDAT", data));
    before = now;
  }
  const palette = Buffer.concat([...colours, 0].map((colour) => numbers([colour, 3])));
  const clear = Buffer.alloc(colours.length + 1, 255);
  clear[colours.length] = 0;
  return Buffer.concat([signature, chunk("IHDR", numbers([width, 4], [height, 4], [8, 1], [3, 1], [0, 3])),
                        chunk("acTL", numbers([frames.length, 4], [0, 4])), chunk("PLTE", palette), chunk("tRNS", clear), ...chunks,
                        chunk("IEND", Buffer.alloc(0))]);
}
