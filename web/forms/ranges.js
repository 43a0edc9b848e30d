// The scale of a slider, positions 0 to 1000, and the range that a number of the catalogue is moved in.

const whole = 1000;

/** The map of a range `{low, high, log}`: `{at(position), of(value)}`. */
export function scaleOf({ low, high, log = false }) {
  if (log) {
    return { at: (p) => low * (high / low) ** (p / whole), of: (v) => (whole * Math.log(v / low)) / Math.log(high / low) };
  }
  return { at: (p) => low + ((high - low) * p) / whole, of: (v) => (whole * (v - low)) / (high - low) };
}

/** A value rounded to the digits that one step of a slider changes. */
export const tidy = (value, { low, high, log }) => {
  if (log) return Number(value.toPrecision(3));
  const unit = 10 ** Math.floor(Math.log10((high - low) / 500));
  return Number((Math.round(value / unit) * unit).toPrecision(12));
};

/**
 * The range of a card: some decades about a positive default whose bounds lie far apart, else twice the default below and above zero;
 * within what the service allows.
 */
export function rangeOf({ default: usual, minimum, maximum }) {
  const least = minimum ?? -Infinity, most = maximum ?? Infinity, size = Math.abs(usual) || 1;
  const high = Math.min(2 * size, most);
  if (least > 0) return { low: Math.max(usual / 10, least), high: Math.min(usual * 10, most), log: true };
  return { low: Math.max(least === 0 ? 0 : -2 * size, least), high };
}
