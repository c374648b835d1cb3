// Values over time: parameters that have changed, and the numbers of sensors. A figure has the series of one element or
// sensor that have the same unit, with axes, the time that the view shows, and the values under the pointer.
import { limitsOf, short } from "simvis/color_ramp.js";

const LONGEST = 4000; // points of a series of a running simulation
const WIDTH = 300, // of a figure, in the units of its picture
  HEIGHT = 110,
  LEFT = 44,
  RIGHT = 6,
  TOP = 6,
  BOTTOM = 18,
  MARGIN = 0.06, // of the values' reach, above and below
  LEAST_SPAN = 1e-7, // of an axis, in any unit: what differs by less is rounding, and is drawn as a line
  LEAST_SHARE = 1e-9, // of an axis, as a share of its values
  MOST_TICKS = 20;
const COLORS = ["var(--accent)", "#c77d1a", "#2a9d62", "#b04ac4", "#cf4640", "#7a828f"];
const SVG = "http://www.w3.org/2000/svg";

const shape = (name, attributes, text) => {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
};

/** Limits around a least and a greatest value. They are never so near that numbers between them could not be told apart. */
export function limitsAround(low, high) {
  const reach = Math.max(high - low || 1, LEAST_SPAN, LEAST_SHARE * Math.max(Math.abs(low), Math.abs(high))),
    margin = (reach - (high - low)) / 2 + MARGIN * reach;
  return [low - margin, high + margin];
}

/** Round numbers within the limits, about `count` of them. */
export function ticksOf([low, high], count) {
  const rough = (high - low) / count,
    power = 10 ** Math.floor(Math.log10(rough)),
    step = [1, 2, 5, 10].find((each) => each * power >= rough) * power;
  const first = Math.ceil(low / step - 1e-9),
    last = Math.floor(high / step + 1e-9);
  const ticks = Array.from({ length: Math.min(last - first + 1, MOST_TICKS) }, (_, i) => (first + i) * step);
  return [...new Set(ticks.map((tick) => Number(tick.toPrecision(12))))];
}

/** The value of a series at a time: that of the last point before it; undefined before the first. */
export function valueAt({ times, values }, time_s) {
  let low = 0,
    high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time_s) low = middle + 1;
    else high = middle;
  }
  return low > 0 ? values[low - 1] : undefined;
}

/** One line for each time at which any series has a point. A value of steps holds until its next one. */
export function csvOf(all) {
  const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const times = [...new Set(all.flatMap(({ times }) => times))].sort((a, b) => a - b);
  const heads = all.map(({ owner, name, unit }) => quoted(`${owner}.${name}${unit ? ` (${unit})` : ""}`));
  const at = new Map();
  for (const [i, series] of all.entries()) series.times.forEach((time, k) => at.set(`${i} ${time}`, series.values[k]));
  const cell = (series, i, time) => {
    const value = series.steps ? valueAt(series, time) : at.get(`${i} ${time}`);
    return value === undefined || Number.isNaN(value) ? "" : String(value);
  };
  const rows = times.map((time) => [time, ...all.map((series, i) => cell(series, i, time))].join(","));
  return [["time_s", ...heads].join(","), ...rows, ""].join("\n");
}

export class Graphs {
  /** `onSeek(time_s)` is called for a click into a figure. */
  constructor(root, onSeek) {
    this.root = root;
    this.onSeek = onSeek;
    this.hidden = new Set(); // titles of series
    this.now = 0;
    this.clear();
  }

  clear() {
    this.series = new Map(); // "OWNER.NAME": { owner, name, unit, steps, times, values }
    this.figures = new Map(); // "OWNER (UNIT)"
    this.complete = false;
    this.root.innerHTML = '<p class="weak">Nothing has changed yet.</p>';
  }

  /** All series of a recording. */
  setAll(all) {
    this.clear();
    for (const { owner, name, unit, steps, points } of all) {
      const series = this.find(owner, name, unit, steps);
      series.times = points.map(([time]) => time);
      series.values = points.map(([, value]) => value ?? NaN);
    }
    this.complete = true;
  }

  find(owner, name, unit, steps) {
    const title = `${owner}.${name}`;
    if (!this.series.has(title)) this.series.set(title, { owner, name, unit, steps, times: [], values: [] });
    return this.series.get(title);
  }

  add(owner, name, unit, steps, time_s, value) {
    if (this.complete) return;
    const { times, values } = this.find(owner, name, unit, steps);
    const last = times[times.length - 1];
    if (last === time_s) values[values.length - 1] = value;
    if (last !== undefined && last >= time_s) return;
    times.push(time_s);
    values.push(value);
    if (times.length <= LONGEST) return;
    times.shift();
    values.shift();
  }

  /** Shows the series up to this time with it as the cursor. */
  draw(now = this.now) {
    this.now = now;
    if (!this.root.closest("details").open) return;
    const groups = new Map();
    for (const series of this.series.values()) {
      const title = `${series.owner}${series.unit ? ` (${series.unit})` : ""}`;
      if (!groups.has(title)) groups.set(title, []);
      groups.get(title).push(series);
    }
    for (const [title, all] of groups) {
      const changing = all.filter(({ values }) =>
        values.some((value) => Number.isFinite(value) && value !== values[0]),
      );
      if (changing.length === 0 && !this.figures.has(title)) continue;
      if (!this.figures.has(title)) this.addFigure(title);
      this.figures.get(title).draw(changing, this.reach(), now);
    }
  }

  /** First and last time of all series. */
  reach() {
    let first = Infinity,
      last = this.now;
    for (const { times } of this.series.values()) {
      if (times.length === 0) continue;
      first = Math.min(first, times[0]);
      last = Math.max(last, times[times.length - 1]);
    }
    return first < last ? [first, last] : [last - 1, last];
  }

  addFigure(title) {
    if (this.figures.size === 0) {
      const save = document.createElement("button");
      save.textContent = "Save as CSV";
      save.addEventListener("click", () => this.save());
      this.root.replaceChildren(save);
    }
    this.figures.set(title, new Figure(title, this));
    this.root.append(this.figures.get(title).root);
  }

  save() {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([this.csv()], { type: "text/csv" }));
    link.download = "graphs.csv";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  }

  csv() {
    return csvOf([...this.series.values()].filter(({ times }) => times.length > 0));
  }
}

class Figure {
  constructor(title, graphs) {
    this.title = title;
    this.graphs = graphs;
    this.root = document.createElement("div");
    this.root.className = "graph";
    this.root.dataset.title = title;
    const heading = document.createElement("p");
    heading.textContent = title;
    this.svg = shape("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img" });
    this.legend = document.createElement("div");
    this.legend.className = "series";
    this.root.append(heading, this.svg, this.legend);
    this.pointer = null; // the time under it
    this.buttons = new Map();
    this.svg.addEventListener("pointermove", (event) => this.point(this.timeOf(event)));
    this.svg.addEventListener("pointerleave", () => this.point(null));
    this.svg.addEventListener("click", (event) => graphs.onSeek?.(this.timeOf(event)));
  }

  timeOf(event) {
    const area = this.svg.getBoundingClientRect(),
      share = (((event.clientX - area.left) / area.width) * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT);
    const [first, last] = this.reach;
    return first + Math.max(0, Math.min(1, share)) * (last - first);
  }

  point(time) {
    this.pointer = time;
    this.draw(this.all, this.reach, this.graphs.now);
  }

  draw(all, reach, now) {
    Object.assign(this, { all, reach });
    const time = this.pointer ?? now,
      shown = all.filter((series) => !this.graphs.hidden.has(`${series.owner}.${series.name}`));
    const limits = limitsAround(...limitsOf(shown.flatMap(({ values }) => values)));
    const x = (t) => LEFT + ((WIDTH - LEFT - RIGHT) * (t - reach[0])) / (reach[1] - reach[0]),
      y = (value) => HEIGHT - BOTTOM - ((HEIGHT - TOP - BOTTOM) * (value - limits[0])) / (limits[1] - limits[0]);
    const parts = [];
    for (const tick of ticksOf(limits, 3)) {
      parts.push(shape("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: y(tick), y2: y(tick) }));
      parts.push(shape("text", { x: LEFT - 4, y: y(tick) + 3, "text-anchor": "end" }, short(tick)));
    }
    for (const tick of ticksOf(reach, 4)) {
      parts.push(shape("line", { class: "grid", x1: x(tick), x2: x(tick), y1: TOP, y2: HEIGHT - BOTTOM }));
      const anchor = x(tick) > WIDTH - 25 ? "end" : "middle";
      parts.push(shape("text", { x: x(tick), y: HEIGHT - 5, "text-anchor": anchor }, `${short(tick)} s`));
    }
    shown.forEach((series) => {
      const path = this.pathOf(series, x, y, reach[1]);
      parts.push(shape("path", { d: path, style: `stroke: ${this.colorOf(series)}` }));
    });
    parts.push(shape("line", { class: "cursor", x1: x(time), x2: x(time), y1: TOP, y2: HEIGHT - BOTTOM }));
    this.svg.replaceChildren(...parts);
    this.svg.setAttribute("aria-label", `${this.title}: ${all.map((series) => this.textOf(series, time)).join(", ")}`);
    this.write(time);
  }

  colorOf(series) {
    return COLORS[this.all.indexOf(series) % COLORS.length];
  }

  pathOf({ times, values, steps }, x, y, end) {
    let path = "",
      on = false;
    times.forEach((time, i) => {
      const at = `${x(time).toFixed(2)} ${y(values[i]).toFixed(2)}`;
      if (!Number.isFinite(values[i])) on = false;
      else if (!on) path += `M${at}`;
      else path += steps ? `H${x(time).toFixed(2)}V${y(values[i]).toFixed(2)}` : `L${at}`;
      on = Number.isFinite(values[i]);
    });
    return steps && on ? `${path}H${x(end).toFixed(2)}` : path;
  }

  textOf(series, time) {
    const value = valueAt(series, time);
    return `${series.name} ${value === undefined ? "–" : short(value)}`;
  }

  write(time) {
    let isNew = false; // a series that has not changed before
    for (const series of this.all) {
      const title = `${series.owner}.${series.name}`;
      if (!this.buttons.has(title)) {
        const button = document.createElement("button");
        button.innerHTML = "<i></i><span></span>";
        button.addEventListener("click", () => {
          if (!this.graphs.hidden.delete(title)) this.graphs.hidden.add(title);
          this.draw(this.all, this.reach, this.graphs.now);
        });
        this.buttons.set(title, button);
        isNew = true;
      }
      const button = this.buttons.get(title);
      button.setAttribute("aria-pressed", String(!this.graphs.hidden.has(title)));
      button.querySelector("i").style.background = this.colorOf(series);
      button.querySelector("span").textContent = this.textOf(series, time);
      button.title = `${valueAt(series, time) ?? "no value yet"}; click to show it or not`;
    }
    if (isNew) this.legend.append(...this.all.map(({ owner, name }) => this.buttons.get(`${owner}.${name}`)));
    this.root.querySelector("p").textContent = `${this.title} at ${time.toFixed(3)} s`;
  }
}
