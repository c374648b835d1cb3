// The layout of the page in its link behind "#": the place of the camera, layers, open sections, what is selected. A link
// that is sent to others shows them the same. Keys that describe() does not give stay as they are.

const WAIT_MS = 300; // after the last change

const read = () => new URLSearchParams(location.hash.slice(1));

export class Layout {
  /** `describe()` gives an object of texts; null values are left out of the link. */
  constructor(describe) {
    this.describe = describe;
    this.first = read();
    this.timer = 0;
  }

  /** The text of a key in the link with which the page was opened; null without it. */
  get(key) {
    return this.first.get(key);
  }

  /** Numbers of the link; null if there are not exactly so many. */
  numbers(key, count) {
    const numbers = (this.first.get(key) ?? "").split(",").map(Number);
    return this.first.has(key) && numbers.length === count && numbers.every(Number.isFinite) ? numbers : null;
  }

  /** A list of names; null: the link does not say. */
  names(key) {
    return this.first.has(key) ? this.first.get(key).split(",").filter(Boolean) : null;
  }

  /** Writes the link some time later. */
  note() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.write(), WAIT_MS);
  }

  write() {
    const link = read();
    for (const [key, value] of Object.entries(this.describe())) {
      if (value === null || value === undefined) link.delete(key);
      else link.set(key, value);
    }
    const text = link.toString().replaceAll("%2C", ",").replaceAll("%3A", ":");
    if (`#${text}` !== location.hash) history.replaceState(history.state, "", `#${text}`);
  }
}
