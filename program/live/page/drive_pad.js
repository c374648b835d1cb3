// Drives a vehicle by its element velocity_command: with buttons, or with the arrow keys while the pad has the focus. What
// is held is sent again and again, because a command ends by itself.
import { short } from "simvis/color_ramp.js";

const AGAIN_MS = 100, // well within the shortest time that people give a command
  FIRST_SPEED = 0.5, // m/s
  FIRST_TURN = 45; // deg/s
const WAYS = [
  { name: "forward", key: "ArrowUp", sign: "▲", forward: 1, turn: 0 },
  { name: "left", key: "ArrowLeft", sign: "◀", forward: 0, turn: 1 },
  { name: "backward", key: "ArrowDown", sign: "▼", forward: -1, turn: 0 },
  { name: "right", key: "ArrowRight", sign: "▶", forward: 0, turn: -1 },
];

export class DrivePad {
  /** `send(forward, turn)` gives a command in m/s and deg/s. */
  constructor(element, send) {
    this.send = send;
    this.held = new Set();
    this.timer = null;
    this.root = document.createElement("div");
    this.root.className = "pad";
    this.root.tabIndex = 0;
    this.root.setAttribute("role", "group");
    this.root.setAttribute("aria-label", `Drive ${element} with the arrow keys`);
    this.speed = this.addNumber("Speed", FIRST_SPEED, "m/s");
    this.turn = this.addNumber("Turn", FIRST_TURN, "deg/s");
    for (const way of WAYS) this.addButton(way);
    this.root.addEventListener("keydown", (event) => this.press(event));
    this.root.addEventListener("keyup", ({ key }) => this.release(WAYS.find((way) => way.key === key)));
    this.root.addEventListener("focusout", () => this.releaseAll());
  }

  addNumber(name, value, unit) {
    const label = document.createElement("label"),
      field = Object.assign(document.createElement("input"), { type: "number", min: 0, step: "any", value: short(value) });
    label.className = name.toLowerCase();
    label.append(`${name} `, field, ` ${unit}`);
    this.root.append(label);
    return field;
  }

  addButton(way) {
    const button = Object.assign(document.createElement("button"), { textContent: way.sign, title: way.name });
    button.className = way.name;
    button.setAttribute("aria-label", way.name);
    button.addEventListener("pointerdown", (event) => event.button === 0 && this.hold(way));
    for (const end of ["pointerup", "pointercancel", "pointerleave"])
      button.addEventListener(end, () => this.release(way));
    this.root.append(button);
  }

  press(event) {
    const way = WAYS.find(({ key }) => key === event.key);
    if (!way || event.target.matches("input")) return;
    event.preventDefault();
    if (!event.repeat) this.hold(way);
  }

  hold(way) {
    this.held.add(way);
    this.command();
    this.timer ??= setInterval(() => this.command(), AGAIN_MS);
  }

  release(way) {
    if (!this.held.delete(way)) return;
    this.command();
    if (this.held.size > 0) return;
    clearInterval(this.timer);
    this.timer = null;
  }

  releaseAll() {
    for (const way of [...this.held]) this.release(way);
  }

  command() {
    const sum = (of) => [...this.held].reduce((total, way) => total + way[of], 0);
    this.send(sum("forward") * Number(this.speed.value), sum("turn") * Number(this.turn.value));
  }
}
