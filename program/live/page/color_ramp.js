// One ramp of colours for ranges, depths, intensities and bounds: lightness grows evenly, so it reads in grey as well.
const STOPS = [
  [38, 22, 74],
  [52, 60, 138],
  [40, 104, 152],
  [34, 144, 140],
  [70, 182, 104],
  [160, 210, 70],
  [250, 230, 60],
];

/** `share` from 0 to 1; what is no number is grey. Returns three numbers from 0 to 255. */
export function colorOf(share) {
  if (!Number.isFinite(share)) return [120, 120, 128];
  const place = Math.max(0, Math.min(1, share)) * (STOPS.length - 1);
  const low = Math.min(STOPS.length - 2, Math.floor(place)),
    part = place - low;
  return STOPS[low].map((value, i) => value + part * (STOPS[low + 1][i] - value));
}

// The ramp in steps that no eye can tell apart, as pixels of a canvas. Little-endian, as all machines with browsers are.
const STEPS = 1024;
const pixelOf = ([r, g, b]) => new Uint32Array(Uint8ClampedArray.of(r, g, b, 255).buffer)[0];
const PIXELS = Uint32Array.from({ length: STEPS }, (_, i) => pixelOf(colorOf(i / (STEPS - 1))));
const NO_NUMBER = pixelOf([20, 20, 24]);

/** The pixels of an image of numbers, each between the limits; what is no finite number is nearly black. */
export function rampPixels(values, [low, high]) {
  const pixels = new Uint32Array(values.length),
    scale = high > low ? (STEPS - 1) / (high - low) : 0,
    first = high > low ? 0.5 : STEPS / 2;
  for (let i = 0; i < values.length; ++i) {
    const value = values[i];
    pixels[i] = Number.isFinite(value) ? PIXELS[((value - low) * scale + first) | 0] : NO_NUMBER;
  }
  return pixels;
}

/** The pixels of an image of whole numbers: neighbours have colours far apart, and 0 is nearly black. */
export function labelPixels(values) {
  const colors = new Map([[0, NO_NUMBER]]);
  return Uint32Array.from(values, (value) => {
    if (!colors.has(value)) colors.set(value, pixelOf(colorOfLabel(value)));
    return colors.get(value);
  });
}

/** In a column of whole numbers: none. */
export const NO_WHOLE = 0xffffffff;

/** Whether numbers of a type are names of objects rather than amounts. */
export const isWhole = (type) => /^[ui]/.test(type ?? "");

/** Three numbers from 0 to 255. Multiples of the golden section lie far from each other on the circle of hues. */
export function colorOfLabel(value) {
  if (value === NO_WHOLE) return colorOf(NaN);
  const hue = (((value * 0.618033988749895) % 1) + 1) % 1,
    light = 0.4 + 0.15 * (Math.abs(value) % 3);
  const part = (shift) => {
    const place = (hue * 12 + shift) % 12;
    return 255 * (light - 0.8 * Math.min(light, 1 - light) * Math.max(-1, Math.min(place - 3, 9 - place, 1)));
  };
  return [part(0), part(8), part(4)];
}

export const rampCss = () => `linear-gradient(to right, ${STOPS.map((stop) => `rgb(${stop})`).join(", ")})`;

/** Smallest and largest finite number; [0, 1] without any. */
export function limitsOf(values) {
  let low = Infinity,
    high = -Infinity;
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : [0, 1];
}

export const shareOf = (value, [low, high]) => (high > low ? (value - low) / (high - low) : value >= low ? 0.5 : NaN);

const NEAR_ZERO = 1e-9; // in any unit: what is nearer to 0 is rounding

/** The number with at most `digits` digits; what is near zero is 0. The caller gives the full value as a tooltip. */
export function short(value, digits = 4) {
  if (value === null || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  if (Math.abs(value) < NEAR_ZERO) return "0";
  return Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3
    ? value.toExponential(digits - 2)
    : String(Number(value.toPrecision(digits)));
}
