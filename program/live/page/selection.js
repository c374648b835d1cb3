// What is known of the object that is selected.
import { short } from "simvis/color_ramp.js";

const COMMON = ["type", "name", "insert_at"];

/** A fact is a name, a text and the full value, which is its tooltip if the text is shorter. */
function factsOf(facts) {
  const list = document.createElement("dl");
  list.className = "facts";
  for (const [name, value, full] of facts) {
    if (value === null || value === undefined || value === "") continue;
    const term = document.createElement("dt"),
      text = document.createElement("dd");
    term.textContent = name;
    text.textContent = value;
    if (full !== undefined) text.title = full;
    list.append(term, text);
  }
  return list;
}

const sizeOf = ({ box_m }) => box_m && `${box_m.max.map((high, i) => short(high - box_m.min[i])).join(" × ")} m`;
const shapeFacts = (thing) => [
  ["triangles", thing.triangles ? thing.triangles.toLocaleString("en") : null],
  ["size", sizeOf(thing)],
  [
    "materials",
    thing.materials
      ?.map((material) => material.name)
      .filter(Boolean)
      .join(", "),
  ],
];

export class SelectionPanel {
  /** `physicsOf(kind, name)` gives what physics knows of an object, as pairs of a name and a text; `objectsOf()` the objects
   * of the scene, and `sizeOf(name)` the lengths of the box around an object's surfaces, in metres, or null. */
  constructor(root, { lookThrough, drag, physicsOf, objectsOf, sizeOf, canSet }) {
    Object.assign(this, { root, lookThrough, drag, physicsOf, objectsOf, sizeOf, canSet });
    this.show(null);
  }

  /** Writes what changes from frame to frame. */
  refresh() {
    if (this.changing) this.facts.replaceWith((this.facts = factsOf(this.changing())));
  }

  /** Facts that `read` gives, each frame anew. */
  follow(read) {
    this.changing = read;
    this.facts = factsOf(read());
    return this.facts;
  }

  show(thing, scene) {
    this.changing = null;
    if (!thing || !scene) {
      this.root.innerHTML = '<p class="weak">Click on an object in the view or in the tree.</p>';
      return;
    }
    const title = document.createElement("h3"),
      kind = document.createElement("small");
    title.textContent = `${thing.name} `;
    kind.textContent = thing.kind;
    title.append(kind);
    const described = this[thing.kind](thing.name, scene, thing);
    this.root.replaceChildren(title, ...(described ?? [factsOf([["state", "not in the scene any more"]])]));
  }

  /** A beam of a scan: thing.read() gives what it measured last. */
  beam(name, scene, thing) {
    return [this.follow(thing.read)];
  }

  /** A pixel of a camera. */
  pixel(name, scene, thing) {
    return [this.follow(thing.read)];
  }

  part(name, { list }, { hit }) {
    const part = list.parts.find((each) => each.name === name);
    return (
      part && [
        factsOf([
          ["from", part.source],
          ["inserted at", part.insert_at],
          ...(hit ?? []),
          ...shapeFacts(part),
          ["insertion points", part.insertion_points.join(", ")],
        ]),
        this.follow(() => this.physicsOf("part", name)),
      ]
    );
  }

  /** A model, a link or another object in the file of a part. */
  object(name, hit) {
    const objects = this.objectsOf(),
      object = objects.byName.get(name),
      size = object && this.sizeOf(name);
    return (
      object && [
        factsOf([
          ["path", object.path],
          ["part", objects.partOf(object)?.name],
          ["class", object.label],
          ["instance", objects.idOf(object)],
          ...(hit ?? []).filter(([fact]) => fact !== "object"),
          ["size", size && `${size.map((value) => short(value)).join(" × ")} m`],
        ]),
        this.follow(() => this.physicsOf(object.kind, name)),
      ]
    );
  }

  model(name, scene, { hit }) {
    return this.object(name, hit);
  }

  link(name, scene, { hit }) {
    return this.object(name, hit);
  }

  frame(name, scene, { hit }) {
    return this.object(name, hit);
  }

  element(name, { list, elements }) {
    const element = list.elements.find((each) => each.name === name);
    if (!element) return null;
    const facts = factsOf([["type", element.type], ["inserted at", element.insert_at], ...shapeFacts(element)]);
    const physics = this.follow(() => this.physicsOf("element", name));
    if (element.type !== "pose" || !this.canSet || elements[name] === undefined) return [facts, physics];
    return [facts, physics, this.buttons(["Drag in the view", () => this.drag(name)])];
  }

  sensor(name, { list, sensors }) {
    const listed = list.sensors.find((each) => each.name === name),
      sensor = sensors.find((each) => each.name === name);
    if (!listed || !sensor) return null;
    const own = Object.keys(listed.attributes),
      rest = document.createElement("details"),
      summary = document.createElement("summary");
    summary.textContent = "Defaults";
    rest.append(
      summary,
      factsOf(Object.entries(sensor.attributes).filter(([key]) => !own.includes(key) && !COMMON.includes(key))),
    );
    return [
      factsOf([
        ["type", sensor.type],
        ["method", listed.method],
        ["inserted at", sensor.insert_at],
        ["sees", sensor.visualization ? "what is drawn for people" : null],
        ...Object.entries(listed.attributes),
      ]),
      this.buttons(["Look through it", () => this.lookThrough(name)]),
      rest,
    ];
  }

  buttons(...all) {
    const row = document.createElement("div");
    row.className = "row";
    for (const [text, action] of all) {
      const button = document.createElement("button");
      button.textContent = text;
      button.addEventListener("click", action);
      row.append(button);
    }
    return row;
  }
}
