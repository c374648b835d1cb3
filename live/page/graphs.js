// Values over time: parameters that have changed, and the numbers of sensors.
import { limitsOf, short } from "simvis/color_ramp.js";

const LONGEST = 2000;

export class Graphs {
  constructor(root) {
    this.root = root;
    this.clear();
  }

  clear() {
    this.series = new Map();  // title: { unit, points: [[time_s, value]], figure }
    this.root.innerHTML = '<p class="weak">Nothing has changed yet.</p>';
  }

  add(title, unit, time_s, value) {
    if (!this.series.has(title)) this.series.set(title, { unit, points: [] });
    const { points } = this.series.get(title);
    const at = points.findIndex(([time]) => time >= time_s);
    if (at < 0) points.push([time_s, value]);
    else points.splice(at, points[at][0] === time_s ? 1 : 0, [time_s, value]);
    if (points.length > LONGEST) points.shift();
  }

  draw() {
    if (!this.root.closest("details").open) return;
    for (const [title, series] of this.series) {
      const values = series.points.map(([, value]) => value), [low, high] = limitsOf(values);
      if (low === high && !series.figure) continue;
      if (!series.figure) {
        if (this.root.querySelector(".weak:only-child")) this.root.replaceChildren();
        series.figure = document.createElement("div");
        series.figure.className = "graph";
        series.figure.innerHTML = '<p><span></span><output></output></p><svg viewBox="0 0 100 40" preserveAspectRatio="none" role="img"><polyline/></svg>';
        series.figure.querySelector("span").textContent = title;
        this.root.append(series.figure);
      }
      const [first, last] = [series.points[0][0], series.points[series.points.length - 1][0]];
      const at = ([time, value]) => `${(100 * (time - first)) / (last - first || 1)},${38 - (36 * (value - low)) / (high - low || 1)}`;
      series.figure.querySelector("polyline").setAttribute("points", series.points.filter(([, value]) => Number.isFinite(value)).map(at).join(" "));
      const text = `${short(values[values.length - 1])} ${series.unit} (${short(low)} to ${short(high)})`;
      series.figure.querySelector("output").textContent = text;
      series.figure.querySelector("svg").setAttribute("aria-label", `${title}: ${text}`);
    }
  }
}
