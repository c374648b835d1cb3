// Brings the messages of a simulation, live or recorded, to the parts of the page.
import { Dragging } from "simvis/dragging.js";
import { Graphs } from "simvis/graphs.js";
import { Images } from "simvis/images.js";
import { Labels } from "simvis/labels.js";
import { Navigation } from "simvis/navigation.js";
import { ParameterPanel } from "simvis/parameters.js";
import { PlaceSensor } from "simvis/place_sensor.js";
import { SceneView } from "simvis/scene_view.js";
import { SelectionPanel } from "simvis/selection.js";
import { SensorShape, isCamera, isScanner, lensOf } from "simvis/sensor_shapes.js";
import { TimeBar } from "simvis/time_bar.js";
import { Tables } from "simvis/tables.js";
import { Tree } from "simvis/tree.js";
import { rampCss, short } from "simvis/color_ramp.js";
import { showPlan } from "simvis/plan.js";

const SAME_ROBOT_M = 1.5; // sensors so near to each other are taken as those of one robot
const element = (id) => document.getElementById(id);
const { open } = await import(element("recording") ? "simvis/recorded_source.js" : "simvis/live_source.js");
const source = open(receive, (text, wrong) => {
  element("state").textContent = text;
  element("state").classList.toggle("wrong", wrong);
});

const view = new SceneView(element("view"));
const navigation = new Navigation(view, element("hint"));
const dragging = new Dragging(view, navigation);
const tree = new Tree(element("tree"), element("tree-filter"), (thing) => select(thing));
const labels = new Labels(view, element("labels"));
const images = new Images(element("images"), look);
const graphs = new Graphs(element("graphs"));
const tables = new Tables(element("tables"));
const asked = []; // parameters that were asked for and not answered yet
const parameters = new ParameterPanel(element("parameters"), !source.recorded, (index, value) => {
  asked.push(index);
  source.send({ op: "set", parameter: index, value });
});
const time = new TimeBar(source);
const place = new PlaceSensor(element("place"), {
  dragging,
  canExecute: !source.recorded,
  rowsOfPoint: (point) => rowsOf(scene.points[point]),
  execute: (xml) => source.send({ op: "execute", xml }),
});
const selectionPanel = new SelectionPanel(element("selection"), {
  lookThrough,
  drag: dragElement,
  canSet: !source.recorded,
});

let scene = null,
  selected = null,
  opened = false,
  told = ""; // what is looked at, as the simulation knows it
let frame = { frame: 0, time_s: 0 };
const transforms = new Map(),
  values = [],
  shapes = new Map(),
  scans = new Map();
const changed = new Map(); // values since the last frame

function rowsOf(transform) {
  return transform === 0 ? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0] : transforms.get(transform);
}

function placeOf(transform) {
  const rows = transform === null ? null : rowsOf(transform);
  return rows ? [rows[3], rows[7], rows[11]] : null;
}

function layers() {
  const on = (id) => element(`show-${id}`).checked;
  return { frusta: on("frusta"), axes: on("axes"), points: on("points"), beams: on("beams"), trails: on("trails") };
}

/** Tells what is looked at; a simulation sends nothing else. */
function look() {
  if (!scene) return;
  const { points, beams } = layers(),
    pictures = element("images-section").open;
  const sensors = scene.sensors.flatMap((sensor, i) => {
    const wanted = isCamera(sensor) ? pictures && images.shows(sensor.name) : isScanner(sensor) ? points || beams : true;
    return wanted ? [i] : [];
  });
  const message = { op: "look", sensors, plan: element("plan-section").open };
  if (JSON.stringify(message) === told) return;
  told = JSON.stringify(message);
  source.send(message);
}

const receivers = {
  async scene(message) {
    scene = message;
    transforms.clear();
    for (const shape of shapes.values()) shape.remove();
    shapes.clear();
    scans.clear();
    images.clear();
    graphs.clear();
    tables.clear();
    await view.load(await source.glb(message.glb), message);
    for (const sensor of message.sensors) shapes.set(sensor.name, new SensorShape(sensor, view));
    labels.show(message.sensors.map(({ name, transform }) => [name, () => placeOf(transform)]));
    tree.show(message.list);
    parameters.build(message.parameters);
    place.offer(Object.keys(message.points).sort());
    told = ""; // of other sensors
    look();
    select(selected);
  },
  transforms(message) {
    for (const [index, rows] of message.transforms) transforms.set(index, rows);
    view.move(message.transforms);
  },
  materials: (message) => view.paint(message.materials),
  lights(message) {
    view.light(message.lights, rowsOf);
  },
  values(message) {
    for (const [index, value] of message.values) {
      values[index] = value;
      parameters.write(index, value);
      const asking = asked.indexOf(index);
      if (asking >= 0) asked.splice(asking, 1);
    }
    for (const [index, value] of message.values) changed.set(index, value);
  },
  scan(message) {
    scans.set(message.sensor, message);
    drawScan(message);
  },
  image: (message) => images.show(message, scene.sensors[message.sensor].name),
  frame(message) {
    frame = message;
    for (const sensor of scene.sensors)
      shapes.get(sensor.name).place(sensor.transform === null ? null : rowsOf(sensor.transform), message.frame);
    for (const [index, value] of changed) {
      const parameter = scene.parameters[index];
      if (parameter) graphs.add(`${parameter.element}.${parameter.name}`, parameter.unit, message.time_s, value);
    }
    changed.clear();
    for (const table of message.tables) showTable(table, message.time_s);
    graphs.draw();
    time.show(message);
    if (message.plan !== undefined && element("plan-section").open) showPlan(element("plan"), message.plan);
    element("warnings").replaceChildren(
      ...message.warnings.map((text) => Object.assign(document.createElement("li"), { textContent: text })),
    );
    element("warnings-section").querySelector("summary").textContent = `Warnings (${message.warnings.length})`;
    if (selected) mark();
    if (!opened) openView();
    document.documentElement.dataset.frame = message.frame;
  },
  playing: (message) => time.play(message.playing),
  error({ about, message }) {
    if (about === "set" && asked.length > 0) return parameters.refuse(asked.shift(), message);
    alertOf(message);
  },
  saved() {
    element("state").textContent = "the scene file is saved";
  },
};

async function receive(message) {
  try {
    await receivers[message.op]?.(message);
  } catch (error) {
    alertOf(String(error));
    console.error(error);
  }
}

function alertOf(text) {
  const line = document.createElement("p");
  line.textContent = text;
  element("alerts").append(line);
  setTimeout(() => line.remove(), 15000);
}

function showTable(table, time_s) {
  const { name } = scene.sensors[table.sensor];
  if (!table.one_row) return tables.show(name, table);
  for (const [i, [column, unit]] of table.columns.entries())
    graphs.add(`${name} ${column}`, unit, time_s, table.rows[0][i] ?? NaN);
}

function drawScan(message) {
  const by = element("color-by");
  for (const name of message.columns.keys())
    if (![...by.options].some((option) => option.value === name)) by.add(new Option(name));
  const column = message.columns.get(by.value);
  const limits = shapes.get(scene.sensors[message.sensor].name).measure(message, column?.values ?? [], layers());
  const unit = ` ${column?.unit ?? ""}`;
  element("legend").innerHTML = '<div class="ramp"></div><div class="scale"><span></span><span></span></div>';
  element("legend").firstChild.style.background = rampCss();
  const [low, high] = element("legend").querySelectorAll("span");
  low.textContent = short(limits[0]) + unit;
  high.textContent = short(limits[1]) + unit;
}

/** The first view: around the first sensors that measure, from where nothing stands in between; else the whole scene. */
function openView() {
  opened = true;
  const places = scene.sensors
    .filter((each) => !each.visualization)
    .map((each) => placeOf(each.transform))
    .filter(Boolean);
  const near = places.filter((place) => Math.hypot(...place.map((value, i) => value - places[0][i])) < SAME_ROBOT_M);
  const whole = view.box();
  if (near.length > 0) navigation.standBefore(near, whole);
  else if (!whole.isEmpty()) navigation.frame(whole, navigation.direction(-50, 35));
}

function below(part) {
  const names = new Set([part]),
    points = new Set();
  for (const each of scene.list.parts) {
    if (names.has(each.name) || points.has(each.insert_at)) {
      names.add(each.name);
      points.add(each.name);
      each.insertion_points.forEach((point) => points.add(point));
    }
  }
  return names;
}

function mark() {
  if (!selected || selected.kind === "sensor") return view.mark(null);
  const { kind, name } = selected;
  const moved = kind === "element" && scene.list.elements.find((each) => each.name === name);
  const parts =
    kind === "part" && name !== "ROOT"
      ? below(name)
      : moved && moved.insert_at !== "ROOT"
        ? below(moved.insert_at)
        : null;
  view.mark(parts && ((item) => parts.has(item.part)));
}

function select(thing) {
  selected = thing;
  dragging.end();
  place.stop();
  tree.select(thing);
  selectionPanel.show(thing, scene);
  document.documentElement.dataset.selected = thing ? `${thing.kind} ${thing.name}` : "";
  mark();
  if (thing?.kind === "sensor") images.reveal(thing.name);
  if (thing?.kind === "element") parameters.reveal(thing.name);
  if (thing?.kind === "part" && scene.points[thing.name] !== undefined)
    place.offer(Object.keys(scene.points).sort(), thing.name);
}

function lookThrough(name) {
  const sensor = scene.sensors.find((each) => each.name === name);
  element("camera-mode").value = "orbit";
  navigation.set("sensor", {
    name,
    ...(isCamera(sensor) ? lensOf(sensor) : { hfov_deg: 90, aspect: 1.5 }),
    rows: () => (sensor.transform === null ? null : rowsOf(sensor.transform)),
  });
  view.canvas.focus();
}

/** Drags a pose: what stands before it in the scene is its parent. */
function dragElement(name) {
  const index = scene.parameters.findIndex((each) => each?.element === name);
  const names = ["x", "y", "z", "roll", "pitch", "yaw"];
  const pose = Object.fromEntries(names.map((each, i) => [each, values[index + i]]));
  const parent = dragging.parentOf(rowsOf(scene.elements[name]), pose);
  dragging.begin(parent, pose, (moved) => {
    names.forEach((each, i) => source.send({ op: "set", parameter: index + i, value: moved[each] }));
  });
}

view.onClick((hit) => {
  if (dragging.dragging) return;
  select(
    hit === null ? null : hit.sensor ? { kind: "sensor", name: hit.sensor } : { kind: "part", name: hit.item.part },
  );
});
element("camera-mode").addEventListener("change", ({ target }) => navigation.set(target.value));
element("whole").addEventListener("click", () => navigation.frame(view.box()));
element("focus").addEventListener("click", focusSelection);
element("cut").addEventListener("input", ({ target }) => {
  const box = view.box(),
    share = Number(target.value) / 100;
  view.setCut(share >= 1 ? Infinity : box.min.z + share * (box.max.z - box.min.z));
});
for (const id of ["frusta", "axes", "points", "beams", "trails"]) {
  element(`show-${id}`).addEventListener("change", () => {
    shapes.forEach((shape) => shape.show(layers()));
    look();
  });
}
element("show-names").addEventListener("change", ({ target }) => {
  labels.on = target.checked;
  view.dirty = true;
});
element("show-grid").addEventListener("change", ({ target }) => view.showGrid(target.checked));
element("color-by").addEventListener("change", () => scans.forEach(drawScan));
for (const section of ["plan-section", "images-section"]) element(section).addEventListener("toggle", look);
element("plan-section").addEventListener("toggle", ({ target }) => {
  if (target.open && frame.plan !== undefined) showPlan(element("plan"), frame.plan);
});
for (const section of document.querySelectorAll("aside > details"))
  section.addEventListener("toggle", () => graphs.draw());
element("save").hidden = source.recorded;
element("save").addEventListener("click", () => source.send({ op: "save" }));

const menu = document.querySelector(".menu");
document.addEventListener("pointerdown", ({ target }) => {
  if (!menu.contains(target)) menu.open = false;
});
menu.addEventListener("keydown", (event) => {
  if (event.key !== "Escape") return;
  menu.open = false;
  menu.querySelector("summary").focus();
});

function focusSelection() {
  if (!selected) return navigation.frame(view.box());
  if (selected.kind === "sensor")
    return navigation.frame(
      view.boxAround(rowsOf(scene.sensors.find((each) => each.name === selected.name).transform)),
    );
  const parts =
    selected.kind === "part"
      ? below(selected.name)
      : below(scene.list.elements.find((each) => each.name === selected.name).insert_at);
  navigation.frame(view.box((item) => parts.has(item.part)));
}

document.addEventListener("keydown", (event) => {
  if (
    event.target.closest("input, select, button, summary, [role=treeitem]") ||
    event.ctrlKey ||
    event.metaKey ||
    event.altKey
  )
    return;
  const keys = {
    " ": () => time.toggle(),
    ".": () => source.send({ op: "step" }),
    f: focusSelection,
    Home: () => navigation.frame(view.box()),
    Escape: () => (navigation.mode === "sensor" ? navigation.set("orbit") : select(null)),
  };
  if (!keys[event.key]) return;
  keys[event.key]();
  event.preventDefault();
});

/** What tests of the page and the browser's console read. */
export const page = { view, dragging, scans, values, scene: () => scene };

source.start();
