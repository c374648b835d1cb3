// One ramp of colours for ranges, depths, intensities and bounds: lightness grows evenly, so it reads in grey as well.
const STOPS = [[38, 22, 74], [52, 60, 138], [40, 104, 152], [34, 144, 140], [70, 182, 104], [160, 210, 70], [250, 230, 60]];

/** `share` from 0 to 1; what is no number is grey. Returns three numbers from 0 to 255. */
export function colorOf(share) {
  if (!Number.isFinite(share)) return [120, 120, 128];
  const place = Math.max(0, Math.min(1, share)) * (STOPS.length - 1);
  const low = Math.min(STOPS.length - 2, Math.floor(place)), part = place - low;
  return STOPS[low].map((value, i) => value + part * (STOPS[low + 1][i] - value));
}

export const rampCss = () => `linear-gradient(to right, ${STOPS.map((stop) => `rgb(${stop})`).join(", ")})`;

/** Smallest and largest finite number; [0, 1] without any. */
export function limitsOf(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : [0, 1];
}

export const shareOf = (value, [low, high]) => (high > low ? (value - low) / (high - low) : value >= low ? 0.5 : NaN);

/** At most four digits, as people read them. */
export function short(value) {
  if (value === null || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  return Math.abs(value) >= 1e5 || (value !== 0 && Math.abs(value) < 1e-3) ? value.toExponential(2) : String(Number(value.toPrecision(4)));
}
