// The last rows of sensors that measure several: detections, contacts, beacons.
import { short } from "simvis/color_ramp.js";

const cell = (tag, text) => Object.assign(document.createElement(tag), { textContent: text });

const rowOf = (cells) => {
  const row = document.createElement("tr");
  row.append(...cells);
  return row;
};

/** A short number, with the full one as tooltip. */
const numberCell = (value) => Object.assign(cell("td", short(value)), { title: value ?? "" });

export class Tables {
  constructor(root) {
    this.root = root;
    this.clear();
  }

  clear() {
    this.shown = new Map();
    this.root.innerHTML = '<p class="weak">No sensor has measured several rows yet.</p>';
  }

  show(sensor, { columns, rows }) {
    if (!this.root.closest("details").open) return;
    if (this.shown.size === 0) this.root.replaceChildren();
    if (!this.shown.has(sensor)) {
      this.shown.set(sensor, document.createElement("table"));
      this.root.append(this.shown.get(sensor));
    }
    const heading = rowOf(columns.map(([name, unit]) => cell("th", unit ? `${name} (${unit})` : name)));
    this.shown.get(sensor).replaceChildren(
      cell("caption", `${sensor}: ${rows.length}`),
      heading,
      ...rows.map((row) => rowOf(row.map(numberCell))),
    );
  }
}
