// The frames of a running simulation that the page keeps, so that it can look back: those of the last minute of
// simulated time, within a limit of memory. A frame holds what its messages said together, not the differences.

const LONGEST_S = 60,
  MOST_FRAMES = 3600,
  MOST_BYTES = 256 * 1024 * 1024,
  ENTRY_BYTES = 300; // of a map, with twelve numbers

const UNDEFORMED = { op: "shapes", shapes: [] };

const sizeOf = ({ png, values, columns, points, origins }) =>
  (png?.byteLength ?? values?.byteLength ?? 0) +
  (points?.byteLength ?? 0) +
  (origins?.byteLength ?? 0) +
  [...(columns?.values() ?? [])].reduce((sum, column) => sum + column.values.byteLength, 0);

/** Bytes that a frame holds and the one before it does not, about. */
function bytesOf(kept, before) {
  let bytes = kept.physics ? kept.physics.poses.length * 96 + kept.physics.contacts.length * 72 : 0;
  if (kept.shapes !== before?.shapes)
    for (const { position } of kept.shapes.shapes) bytes += 2 * position.byteLength;
  for (const [key, message] of kept.measured) if (before?.measured.get(key) !== message) bytes += sizeOf(message);
  for (const state of ["transforms", "values", "materials"])
    if (kept[state] !== before?.[state]) bytes += kept[state].size * ENTRY_BYTES;
  return bytes;
}

/** A map that frames share until it changes. */
class Shared {
  constructor() {
    this.map = new Map();
    this.isShared = false;
  }

  set(key, value) {
    if (this.isShared) this.map = new Map(this.map);
    this.isShared = false;
    this.map.set(key, value);
  }

  share() {
    this.isShared = true;
    return this.map;
  }
}

export class KeptFrames {
  /** `show(message)` shows a message; a promise is waited for. */
  constructor(show) {
    this.show = show;
    this.clear();
  }

  clear() {
    this.state = { transforms: new Shared(), values: new Shared(), materials: new Shared(), measured: new Shared() };
    this.lights = null;
    this.hidden = null;
    this.environment = null;
    this.shapes = UNDEFORMED;
    this.physics = null;
    this.frames = [];
    this.bytes = 0;
    this.shown = null; // a frame that is looked back at; null: the page follows the simulation
    this.wanted = null;
  }

  get looksBack() {
    return this.shown !== null || this.wanted !== null;
  }

  /** Notes a message. */
  note(message) {
    const notes = {
      scene: () => this.clear(),
      transforms: () => message.transforms.forEach(([index, rows]) => this.state.transforms.set(index, [index, rows])),
      values: () => message.values.forEach((pair) => this.state.values.set(pair[0], pair)),
      materials: () => message.materials.forEach((each) => this.state.materials.set(each[0], each)),
      lights: () => {
        this.lights = message;
      },
      hidden: () => {
        this.hidden = message;
      },
      environment: () => {
        this.environment = message;
      },
      shapes: () => {
        this.shapes = message;
      },
      physics: () => {
        this.physics = message;
      },
      scan: () => this.state.measured.set(`scan ${message.sensor}`, message),
      image: () => this.state.measured.set(`image ${message.sensor} ${message.name}`, message),
      frame: () => this.noteFrame(message),
    };
    notes[message.op]?.();
  }

  noteFrame(message) {
    const { transforms, values, materials, measured } = this.state;
    const kept = {
      frame: message,
      transforms: transforms.share(),
      values: values.share(),
      materials: materials.share(),
      measured: measured.share(),
      lights: this.lights,
      hidden: this.hidden,
      environment: this.environment,
      shapes: this.shapes,
      physics: this.physics,
    };
    this.physics = null;
    const last = this.frames[this.frames.length - 1];
    // A frame that comes again has other measurements, or says that the simulation is paused.
    if (last?.frame.frame === message.frame) {
      kept.physics ??= last.physics;
      this.bytes -= this.frames.pop().bytes;
    } else if (last && message.time_s < last.frame.time_s) {
      this.frames = [];
      this.bytes = 0;
    }
    kept.bytes = bytesOf(kept, this.frames[this.frames.length - 1]);
    this.bytes += kept.bytes;
    this.frames.push(kept);
    while (this.frames.length > 1 && this.isTooMuch()) this.bytes -= this.frames.shift().bytes;
  }

  isTooMuch() {
    const [first, last] = [this.frames[0], this.frames[this.frames.length - 1]];
    return (
      this.bytes > MOST_BYTES ||
      this.frames.length > MOST_FRAMES ||
      (last.frame.time_s - first.frame.time_s > LONGEST_S && first !== this.shown)
    );
  }

  /** Where the frame that is shown stands among those that are kept. */
  place() {
    const number = this.shown === null ? this.frames.length - 1 : this.frames.indexOf(this.shown);
    return { number: Math.max(0, number), count: this.frames.length };
  }

  /** Shows the kept frame of this number; the last one, and the page follows the simulation again. */
  async seek(number) {
    const busy = this.wanted !== null;
    if (this.frames.length === 0) return;
    this.wanted = Math.max(0, Math.min(this.frames.length - 1, number));
    if (busy) return;
    while (this.wanted !== null) {
      const kept = this.frames[Math.min(this.wanted, this.frames.length - 1)],
        wanted = this.wanted;
      this.shown = kept === this.frames[this.frames.length - 1] ? null : kept;
      await this.showFrame(kept);
      if (this.wanted === wanted) this.wanted = null;
    }
  }

  /** The number of the kept frame at this time, or the last one before it. */
  numberAt(time_s) {
    const after = this.frames.findIndex(({ frame }) => frame.time_s > time_s);
    return after < 0 ? this.frames.length - 1 : Math.max(0, after - 1);
  }

  async showFrame({ frame, transforms, shapes, values, materials, measured, lights, hidden, environment, physics }) {
    await this.show({ op: "transforms", transforms: [...transforms.values()] });
    await this.show(shapes);
    await this.show({ op: "materials", materials: [...materials.values()] });
    if (lights) await this.show(lights);
    if (hidden) await this.show(hidden);
    if (environment) await this.show(environment);
    await this.show({ op: "values", values: [...values.values()] });
    await this.show(physics ?? { op: "physics", poses: [], contacts: [] });
    for (const message of measured.values()) await this.show(message);
    await this.show(frame);
  }
}
