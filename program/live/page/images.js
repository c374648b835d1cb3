// A panel for each image of each sensor. Colour is the PNG as it came, whole numbers have a colour each, other numbers
// are shown by a ramp; of several channels the ramp shows the length, and of whole numbers the first that is not 0. The
// value under the pointer stands beside the name. Boxes of objects are drawn on colour.
import { boxOverlay, drawBoxes } from "simvis/boxes.js";
import { isWhole, labelPixels, limitsOf, rampCss, rampPixels, short } from "simvis/color_ramp.js";

const isLabel = ({ form }) => isWhole(form);

/** One number for each pixel. */
function lengthsOf({ values, channels }) {
  if (channels === 1) return values;
  const lengths = new Float64Array(values.length / channels);
  for (let i = 0; i < lengths.length; ++i)
    lengths[i] = Math.hypot(...values.subarray(i * channels, (i + 1) * channels));
  return lengths;
}

/** One whole number for each pixel: that of the nearest layer, or 1 within a silhouette. */
function firstOf({ values, channels }) {
  if (channels === 1) return values;
  const first = new values.constructor(values.length / channels);
  for (let i = 0; i < first.length; ++i)
    first[i] = values.subarray(i * channels, (i + 1) * channels).find((value) => value !== 0) ?? 0;
  return first;
}

class Picture {
  /** `onPick(x, y)` is called for a click on a pixel. */
  constructor(title, message, names, onPick) {
    this.names = names;
    this.isColor = message.form === "png";
    this.pointer = null; // the last event of one that is over the picture
    this.figure = document.createElement("figure");
    this.figure.className = "picture";
    this.figure.innerHTML = '<figcaption><span></span><output></output></figcaption><div class="frame"></div>';
    this.figure.querySelector("span").textContent = title;
    this.output = this.figure.querySelector("output");
    this.shown = document.createElement(this.isColor ? "img" : "canvas");
    this.figure.querySelector(".frame").append(this.shown);
    if (this.isColor) {
      this.shown.alt = title;
    } else {
      this.shown.setAttribute("role", "img");
      this.shown.setAttribute("aria-label", title);
      if (!isLabel(message)) this.addScale();
    }
    this.shown.addEventListener("pointermove", (event) => this.point(event));
    this.shown.addEventListener("pointerleave", () => this.point(null));
    this.shown.addEventListener("load", () => this.point(this.pointer));
    this.shown.addEventListener("click", (event) => this.message && onPick(...this.pixelOf(event)));
  }

  addScale() {
    this.scale = document.createElement("div");
    this.scale.innerHTML = '<div class="ramp"></div><div class="scale"><span></span><span></span></div>';
    this.scale.firstChild.style.background = rampCss();
    this.figure.append(this.scale);
  }

  /** `table` is one of boxes. Only colour shows them. */
  showBoxes(table) {
    if (!this.isColor) return;
    if (!this.boxes) {
      this.boxes = boxOverlay();
      this.shown.after(this.boxes);
    }
    drawBoxes(this.boxes, [this.message.width, this.message.height], table, this.message.name);
  }

  // The place under the pointer; it keeps its value up to date while new pictures come.
  point(pointer) {
    this.pointer = pointer;
    if (pointer) this.read(pointer);
    else this.output.textContent = this.size();
  }

  size() {
    return this.message ? `${this.message.width} × ${this.message.height}` : "";
  }

  show(message) {
    this.message = message;
    if (this.isColor) {
      URL.revokeObjectURL(this.shown.src);
      this.pixels = null;
      this.shown.src = URL.createObjectURL(new Blob([message.png], { type: "image/png" }));
      return;
    }
    this.shown.width = message.width;
    this.shown.height = message.height;
    const pixels = isLabel(message) ? labelPixels(firstOf(message)) : this.rampOf(message);
    const image = new ImageData(new Uint8ClampedArray(pixels.buffer), message.width, message.height);
    this.shown.getContext("2d").putImageData(image, 0, 0);
    this.point(this.pointer);
  }

  rampOf(message) {
    const values = lengthsOf(message),
      limits = limitsOf(values),
      [low, high] = this.scale.querySelectorAll("span");
    low.textContent = `${short(limits[0])} ${message.unit}`;
    high.textContent = `${short(limits[1])} ${message.unit}`;
    return rampPixels(values, limits);
  }

  read(event) {
    if (!this.message) return;
    const [x, y] = this.pixelOf(event);
    this.output.textContent = `(${x}, ${y}) ${this.textAt(x, y)}`;
  }

  pixelOf(event) {
    const area = this.shown.getBoundingClientRect(),
      { width, height } = this.message;
    const place = (offset, length, count) => Math.max(0, Math.min(count - 1, Math.floor((offset / length) * count)));
    return [place(event.clientX - area.left, area.width, width), place(event.clientY - area.top, area.height, height)];
  }

  textAt(x, y) {
    if (this.isColor) return `sRGB ${[...this.codes(x, y).subarray(0, 3)].join(" ")}`;
    const { name, values, width, channels, unit } = this.message,
      numbers = [...values.subarray((y * width + x) * channels, (y * width + x + 1) * channels)];
    if (!isLabel(this.message)) return `${numbers.map((value) => short(value)).join(" ")} ${unit}`;
    return numbers.map((number) => `${number} ${this.names.of(name, number)}`.trim()).join(", ");
  }

  codes(x, y) {
    if (!this.pixels) {
      const canvas = document.createElement("canvas");
      canvas.width = this.message.width;
      canvas.height = this.message.height;
      this.pixels = canvas.getContext("2d", { willReadFrequently: true });
      this.pixels.drawImage(this.shown, 0, 0);
    }
    return this.pixels.getImageData(x, y, 1, 1).data;
  }
}

export class Images {
  /** `onSight` is called when panels come into sight or go out of it, `onPick(sensor, x, y)` for a click. */
  constructor(root, names, onSight, onPick) {
    Object.assign(this, { root, names, onPick });
    this.sight = new IntersectionObserver(
      (changes) => {
        for (const { target, isIntersecting } of changes) target.dataset.hidden = String(!isIntersecting);
        onSight();
      },
      { root: root.closest("aside"), rootMargin: "50%" }, // what the next turn of the wheel shows is up to date
    );
    this.clear();
  }

  /** Whether any image of the camera is in sight, or none has come yet. */
  shows(sensor) {
    const figures = [...this.root.querySelectorAll(`[data-sensor="${CSS.escape(sensor)}"]`)];
    return figures.length === 0 || figures.some((figure) => figure.dataset.hidden !== "true");
  }

  clear() {
    this.sight.disconnect();
    this.pictures = new Map();
    this.root.innerHTML = '<p class="weak">No camera has measured yet.</p>';
  }

  show(message, sensor) {
    const title = `${sensor} · ${message.name}`;
    if (this.pictures.size === 0) this.root.replaceChildren();
    if (!this.pictures.has(title)) {
      this.pictures.set(title, new Picture(title, message, this.names, (x, y) => this.onPick(sensor, x, y)));
      this.pictures.get(title).figure.dataset.sensor = sensor;
      this.sight.observe(this.pictures.get(title).figure);
      this.root.append(...[...this.pictures.keys()].sort().map((key) => this.pictures.get(key).figure));
    }
    this.pictures.get(title).show(message);
  }

  /** Draws a table of boxes on the images of its sensor. */
  showBoxes(sensor, table) {
    for (const picture of this.pictures.values()) {
      if (picture.figure.dataset.sensor === sensor) picture.showBoxes(table);
    }
  }

  /** Pairs of an output and what it has at a pixel, of all images of a sensor. */
  factsAt(sensor, x, y) {
    return [...this.pictures.values()]
      .filter(({ figure, message }) => figure.dataset.sensor === sensor && x < message.width && y < message.height)
      .map((picture) => [picture.message.name, picture.textAt(x, y)]);
  }

  /** Width and height of the images of a sensor. */
  sizeOf(sensor) {
    const first = [...this.pictures.values()].find(({ figure }) => figure.dataset.sensor === sensor);
    return first ? [first.message.width, first.message.height] : null;
  }

  reveal(sensor) {
    this.root.querySelector(`[data-sensor="${CSS.escape(sensor)}"]`)?.scrollIntoView({ block: "nearest" });
  }
}
