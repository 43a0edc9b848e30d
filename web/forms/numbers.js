// Numbers for people, in the language that is spoken.
import { spelled } from "../language/texts.js";

const superscript = (n) => String(n).replace(/[-\d]/g, (c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c]));

/** `n` as 10ⁿ. */
export const powerOfTen = (n) => `10${superscript(n)}`;

/** A number to `digits` significant digits: 0.0454, 12 400, 2.56·10⁻⁵. */
export function format(x, digits = 3) {
  if (x === null || x === undefined) return "–";
  if (x === 0) return "0";
  const [mantissa, exponent] = x.toExponential(digits - 1).split("e");
  if (exponent < -3 || exponent > 5) return `${spelled(mantissa)}·${powerOfTen(+exponent)}`;
  return spelled(Number(x.toPrecision(digits)));
}

/** A round step that divides [low, high] into about `n` parts. */
export function roundStep(low, high, n) {
  const raw = (high - low) / Math.max(n, 1);
  const unit = 10 ** Math.floor(Math.log10(raw));
  return unit * ([1, 2, 5].find((m) => m * unit >= raw) ?? 10);
}

/** The multiples of `step` in [low, high]; none if there are 100 or more, which could not be told apart. */
export function multiples(low, high, step) {
  const first = Math.ceil(low / step), last = Math.floor(high / step);
  return last - first < 100 ? Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step) : [];
}

/** A mark's label, with the digits its step needs. */
export function tickLabel(x, step) {
  if (x === 0) return "0";
  const decimals = -Math.floor(Math.log10(step) + 1e-9);
  if (decimals > 4 || Math.abs(x) >= 1e5) {
    const [mantissa, exponent] = x.toExponential(2).split("e");
    return `${spelled(Number(mantissa))}·${powerOfTen(+exponent)}`;
  }
  return spelled(x.toFixed(Math.max(decimals, 0)));
}

/** Powers of ten in [low, high], at most about so `many` of them. */
export function decades(low, high, many = 8) {
  const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
  return multiples(first, last, Math.max(1, Math.ceil((last - first) / many))).map((n) => 10 ** n);
}

/** The labels of powers of ten. */
export const decadeLabels = (marks) => marks.map((v) => powerOfTen(Math.round(Math.log10(v))));
