// A slider and a number for each live parameter, in the unit and within the limits of its element.
import { short } from "simvis/color_ramp.js";
import { DrivePad } from "simvis/drive_pad.js";

const OPEN_REACH = 5, // a parameter without limits: the slider reaches so far on either side of its value
  DIGITS = 5; // of a number in a field

/** The ends of the slider: the limits, or soft ends around the value, at least `reach` away from it. */
function rangeOf({ min, max, full_turn }, value, reach = Math.max(OPEN_REACH, 2 * Math.abs(value))) {
  if (full_turn) return [-180, 180];
  const bounded = (limit, open) => (limit === null || Math.abs(limit) > 1e4 ? open : limit);
  return [
    bounded(min, Math.max(min ?? -Infinity, value - reach)),
    bounded(max, Math.min(max ?? Infinity, value + reach)),
  ];
}

function limitsText({ min, max, unit }) {
  return min === null && max === null ? "" : `; from ${min ?? "any"} to ${max ?? "any"} ${unit}`;
}

const COLOR = ["red", "green", "blue"];
/** From linear light to the codes of sRGB and back, both from 0 to 1. */
const encoded = (linear) => (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);
const decoded = (code) => (code <= 0.04045 ? code / 12.92 : ((code + 0.055) / 1.055) ** 2.4);

/** "#rrggbb" of three linear numbers; those above 1 are shown in the same hue. */
export function codesOf(linear) {
  const most = Math.max(1, ...linear);
  return `#${linear
    .map((value) =>
      Math.round(255 * encoded(Math.max(0, value) / most))
        .toString(16)
        .padStart(2, "0"),
    )
    .join("")}`;
}

/** Three linear numbers of "#rrggbb". */
export const linearOf = (codes) =>
  [1, 3, 5].map((at) => Number(decoded(parseInt(codes.slice(at, at + 2), 16) / 255).toPrecision(4)));

export class ParameterPanel {
  /** `set(index, value)` asks the simulation; `canSet` is false for a recording. */
  constructor(root, canSet, set) {
    this.root = root;
    this.canSet = canSet;
    this.set = set;
    this.rows = []; // by index
    this.pads = [];
  }

  build(parameters) {
    for (const pad of this.pads.splice(0)) pad.releaseAll();
    this.rows = [];
    this.values = [];
    this.colors = new Map(); // index of red, green or blue: the field and the three indices
    const groups = new Map();
    parameters.forEach((parameter, index) => {
      if (!parameter) return;
      if (!groups.has(parameter.element)) groups.set(parameter.element, this.group(parameter));
      groups.get(parameter.element).append(this.row(parameter, index));
      this.values[index] = parameter.value;
    });
    for (const [element, section] of groups) {
      this.addColor(parameters, element, section);
      this.addPad(parameters, element, section);
    }
    this.root.replaceChildren(...groups.values());
    if (groups.size === 0) this.root.innerHTML = '<p class="weak">This scene has no live parameters.</p>';
  }

  group({ element, type, insert_at }) {
    const section = document.createElement("section");
    section.dataset.element = element;
    const title = document.createElement("h3"),
      what = document.createElement("small");
    title.textContent = `${element} `;
    what.textContent = `${type} at ${insert_at}`;
    title.append(what);
    section.append(title);
    return section;
  }

  /** A field that picks a colour, for an element that has one. */
  addColor(parameters, element, section) {
    const indices = COLOR.map((name) =>
      parameters.findIndex((each) => each?.element === element && each.name === name),
    );
    if (indices.some((index) => index < 0)) return;
    const label = document.createElement("label"),
      field = Object.assign(document.createElement("input"), { type: "color", disabled: !this.canSet });
    label.className = "parameter";
    label.append(Object.assign(document.createElement("span"), { textContent: "colour" }), field);
    field.setAttribute("aria-label", `${element} colour`);
    field.addEventListener("input", () => {
      linearOf(field.value).forEach((value, i) => this.set(indices[i], value));
    });
    section.querySelector("h3").after(label);
    for (const index of indices) this.colors.set(index, { field, indices });
    this.showColor(indices[0]);
  }

  /** Buttons that drive, for an element velocity_command. */
  addPad(parameters, element, section) {
    const indexOf = (name) => parameters.findIndex((each) => each?.element === element && each.name === name),
      [forward, turn, command] = ["forward", "turn", "command"].map(indexOf);
    if (!this.canSet || parameters.find((each) => each?.element === element).type !== "velocity_command") return;
    const pad = new DrivePad(element, (speed, rate) => {
      this.set(forward, speed);
      this.set(turn, rate);
      this.set(command, ++this.values[command]);
    });
    this.pads.push(pad);
    section.append(pad.root);
  }

  showColor(index) {
    const color = this.colors.get(index);
    if (color && document.activeElement !== color.field)
      color.field.value = codesOf(color.indices.map((each) => this.values[each]));
  }

  row(parameter, index) {
    const row = document.createElement("div"),
      [low, high] = rangeOf(parameter, parameter.value);
    row.className = "parameter";
    row.title = `${parameter.summary}${limitsText(parameter)}`;
    const name = document.createElement("span"),
      unit = document.createElement("span");
    name.textContent = parameter.name;
    unit.textContent = parameter.unit;
    unit.className = "unit";
    const slider = document.createElement("input"),
      field = document.createElement("input");
    Object.assign(slider, { type: "range", min: low, max: high, step: "any", disabled: !this.canSet });
    Object.assign(field, { type: "number", step: "any", disabled: !this.canSet });
    if (parameter.min !== null) field.min = parameter.min;
    if (parameter.max !== null) field.max = parameter.max;
    for (const input of [slider, field]) {
      input.setAttribute(
        "aria-label",
        `${parameter.element} ${parameter.name}${parameter.unit ? ` in ${parameter.unit}` : ""}`,
      );
      input.addEventListener(input === slider ? "input" : "change", () => {
        this.refuse(index, "");
        if (input === slider) this.showNumber(index, Number(slider.value));
        this.set(index, Number(input.value));
      });
    }
    slider.addEventListener("change", () => this.widen(index));
    row.append(name, slider, field, unit);
    this.rows[index] = { row, slider, field, parameter };
    this.write(index, parameter.value);
    return row;
  }

  write(index, value) {
    const row = this.rows[index];
    if (!row) return;
    this.values[index] = value;
    this.showColor(index);
    if (document.activeElement !== row.slider) this.slide(row, value);
    if (document.activeElement !== row.field) this.showNumber(index, value);
  }

  /** A value beyond the soft ends of a slider moves them. */
  slide({ slider, parameter }, value) {
    if (value < Number(slider.min) || value > Number(slider.max)) {
      const [low, high] = rangeOf(parameter, value);
      Object.assign(slider, { min: low, max: high });
    }
    slider.value = value;
  }

  /** A slider that is let go at a soft end reaches twice as far. */
  widen(index) {
    const { slider, parameter } = this.rows[index],
      value = Number(slider.value);
    if (value > Number(slider.min) && value < Number(slider.max)) return;
    const [low, high] = rangeOf(parameter, value, Number(slider.max) - Number(slider.min));
    Object.assign(slider, { min: low, max: high, value });
  }

  showNumber(index, value) {
    const { field, parameter } = this.rows[index],
      text = short(value, DIGITS);
    field.value = text;
    field.title = `${value} ${parameter.unit}`.trim();
  }

  refuse(index, message) {
    const row = this.rows[index];
    if (!row) return;
    row.row.querySelector(".wrong")?.remove();
    row.field.setAttribute("aria-invalid", String(message !== ""));
    if (message === "") return;
    const line = document.createElement("span");
    line.className = "wrong";
    line.setAttribute("role", "alert");
    line.textContent = message;
    row.row.append(line);
  }

  reveal(element) {
    this.root.querySelector(`[data-element="${CSS.escape(element)}"]`)?.scrollIntoView({ block: "nearest" });
  }
}
