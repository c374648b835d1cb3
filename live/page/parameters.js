// A slider and a number for each live parameter, in the unit and within the limits of its element.

const OPEN_REACH = 5;  // a parameter without limits: the slider reaches so far on either side of its first value

function rangeOf({ min, max, value, full_turn }) {
  if (full_turn) return [-180, 180];
  const reach = Math.max(OPEN_REACH, 2 * Math.abs(value));
  const bounded = (limit, open) => (limit === null || Math.abs(limit) > 1e4 ? open : limit);
  return [bounded(min, Math.max(min ?? -Infinity, value - reach)), bounded(max, Math.min(max ?? Infinity, value + reach))];
}

export class ParameterPanel {
  /** `set(index, value)` asks the simulation; `canSet` is false for a recording. */
  constructor(root, canSet, set) {
    this.root = root;
    this.canSet = canSet;
    this.set = set;
    this.rows = [];  // by index
  }

  build(parameters) {
    this.rows = [];
    const groups = new Map();
    parameters.forEach((parameter, index) => {
      if (!parameter) return;
      if (!groups.has(parameter.element)) groups.set(parameter.element, this.group(parameter));
      groups.get(parameter.element).append(this.row(parameter, index));
    });
    this.root.replaceChildren(...groups.values());
    if (groups.size === 0) this.root.innerHTML = '<p class="weak">This scene has no live parameters.</p>';
  }

  group({ element, type, insert_at }) {
    const section = document.createElement("section");
    section.dataset.element = element;
    const title = document.createElement("h3"), what = document.createElement("small");
    title.textContent = `${element} `;
    what.textContent = `${type} at ${insert_at}`;
    title.append(what);
    section.append(title);
    return section;
  }

  row(parameter, index) {
    const row = document.createElement("div"), [low, high] = rangeOf(parameter);
    row.className = "parameter";
    row.title = `${parameter.summary}${parameter.min !== null || parameter.max !== null ? `; from ${parameter.min ?? "any"} to ${parameter.max ?? "any"} ${parameter.unit}` : ""}`;
    const name = document.createElement("span"), unit = document.createElement("span");
    name.textContent = parameter.name;
    unit.textContent = parameter.unit;
    unit.className = "unit";
    const slider = document.createElement("input"), field = document.createElement("input");
    Object.assign(slider, { type: "range", min: low, max: high, step: "any", disabled: !this.canSet });
    Object.assign(field, { type: "number", step: "any", disabled: !this.canSet });
    if (parameter.min !== null) field.min = parameter.min;
    if (parameter.max !== null) field.max = parameter.max;
    for (const input of [slider, field]) {
      input.setAttribute("aria-label", `${parameter.element} ${parameter.name}${parameter.unit ? ` in ${parameter.unit}` : ""}`);
      input.addEventListener(input === slider ? "input" : "change", () => {
        this.refuse(index, "");
        if (input === slider) field.value = Number(Number(slider.value).toPrecision(5));
        this.set(index, Number(input.value));
      });
    }
    row.append(name, slider, field, unit);
    this.rows[index] = { row, slider, field };
    this.write(index, parameter.value);
    return row;
  }

  write(index, value) {
    const row = this.rows[index];
    if (!row) return;
    if (document.activeElement !== row.slider) row.slider.value = value;
    if (document.activeElement !== row.field) row.field.value = Number(value.toPrecision(6));
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
