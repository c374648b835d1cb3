// Brings the messages of a simulation, live or recorded, to the parts of the page.
import { hasBoxes } from "simvis/boxes.js";
import { Dragging } from "simvis/dragging.js";
import { Graphs } from "simvis/graphs.js";
import { Images } from "simvis/images.js";
import { KeptFrames } from "simvis/kept_frames.js";
import { Labels } from "simvis/labels.js";
import { Layout } from "simvis/layout.js";
import { LiveSeries } from "simvis/live_series.js";
import { Names } from "simvis/names.js";
import { Navigation } from "simvis/navigation.js";
import { Objects } from "simvis/objects.js";
import { ParameterPanel } from "simvis/parameters.js";
import { Picking } from "simvis/picking.js";
import { PhysicsLayer } from "simvis/physics_layer.js";
import { PlaceSensor } from "simvis/place_sensor.js";
import { Pulling } from "simvis/pulling.js";
import { SceneView } from "simvis/scene_view.js";
import { SelectionPanel } from "simvis/selection.js";
import { SensorShape, isCamera, isScanner, lensOf } from "simvis/sensor_shapes.js";
import { TimeBar } from "simvis/time_bar.js";
import { Tables } from "simvis/tables.js";
import { Tree } from "simvis/tree.js";
import { showLabels, showRamp } from "simvis/legend.js";
import { showPlan } from "simvis/plan.js";

const MOST_NEWS = 3; // warnings above the scene
const SAME_ROBOT_M = 1.5; // sensors so near to each other are taken as those of one robot
const SCENE_LAYERS = ["frusta", "axes", "names", "points", "beams", "trails", "grid"],
  PHYSICS_LAYERS = ["contacts", "masses", "collisions", "joints"];
const element = (id) => document.getElementById(id);
const { open } = await import(element("recording") ? "simvis/recorded_source.js" : "simvis/live_source.js");
const HOSTS = {
  runs: "connected",
  stands: "the simulation that is followed stands still",
  ended: "the simulation that is followed has ended; waiting for the next one",
};
let host = "runs"; // of the simulation that is followed
function showState(text, wrong) {
  element("state").textContent = text;
  element("state").classList.toggle("wrong", wrong);
}
const source = open(receive, (text, wrong) => {
  host = "runs";
  showState(text, wrong);
});
const kept = source.recorded ? null : new KeptFrames(show);
const layout = new Layout(() => describeLayout());

const view = new SceneView(element("view"));
const navigation = new Navigation(view, element("hint"));
const dragging = new Dragging(view, navigation);
const tree = new Tree(element("tree"), element("tree-filter"), (thing) => {
  showTree(false);
  select(thing);
});
const labels = new Labels(view, element("labels"));
const names = new Names();
const images = new Images(element("images"), names, look, (...pixel) => select(picking.pixelOf(...pixel)));
const physics = new PhysicsLayer(view, element("force-scale"));
const pulling = new Pulling(view, navigation, {
  bodyOf: (item) => physics.bodyOf(item),
  send: (message) => source.send(message),
});
const graphs = new Graphs(element("graphs"), (time_s) => ask({ op: "seek", time_s }));
const series = new LiveSeries(graphs);
const tables = new Tables(element("tables"));
const parameters = new ParameterPanel(element("parameters"), !source.recorded, (index, value) =>
  source.send({ op: "set", parameter: index, value }),
);
const time = new TimeBar({ send: ask });
const place = new PlaceSensor(element("place"), {
  dragging,
  canExecute: !source.recorded,
  rowsOfPoint: (point) => rowsOf(scene.points[point]),
  execute: (xml) => source.send({ op: "execute", xml }),
});
const selectionPanel = new SelectionPanel(element("selection"), {
  lookThrough,
  drag: dragElement,
  physicsOf,
  objectsOf: () => objects,
  sizeOf(name) {
    const names = objects.contentOf(name),
      box = view.box((item) => names.has(item.point));
    return box.isEmpty() ? null : box.max.sub(box.min).toArray();
  },
  canSet: !source.recorded,
});

let scene = null,
  objects = new Objects(),
  selected = null,
  opened = false,
  shownNumber = 0, // of the frame of a recording
  told = ""; // what is looked at, as the simulation knows it
let frame = { frame: 0, time_s: 0 };
const transforms = new Map(),
  values = [],
  shapes = new Map(),
  scans = new Map();
let lamps = null; // the last message of lights
const picking = new Picking({ view, shapes, scans, names, images, sceneOf: () => scene, objectsOf: () => objects, rowsOf });

/** Brings a request to where it is carried out: frames that the page keeps are its own matter. */
function ask(message) {
  if (!kept) return source.send(message);
  const back = kept.looksBack;
  if (message.op === "seek") return kept.seek(message.frame ?? kept.numberAt(message.time_s));
  if (back && message.op === "step") return kept.seek(kept.place().number + 1);
  if (back && message.op === "play") kept.seek(Infinity);
  source.send(message);
}

function rowsOf(transform) {
  return transform === 0 ? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0] : transforms.get(transform);
}

function placeOf(transform) {
  const rows = transform === null ? null : rowsOf(transform);
  return rows ? [rows[3], rows[7], rows[11]] : null;
}

function layers() {
  const on = (id) => element(`show-${id}`).checked;
  return Object.fromEntries([...SCENE_LAYERS, ...PHYSICS_LAYERS].map((id) => [id, on(id)]));
}

/** Tells what is looked at; a simulation sends nothing else. */
function look() {
  if (!scene) return;
  const on = layers(),
    pictures = element("images-section").open;
  const sensors = scene.sensors.flatMap((sensor, i) => {
    const wanted = isCamera(sensor)
      ? pictures && images.shows(sensor.name)
      : isScanner(sensor)
        ? on.points || on.beams || sensor.beams
        : true;
    return wanted ? [i] : [];
  });
  const message = {
    op: "look",
    sensors,
    plan: element("plan-section").open,
    physics: PHYSICS_LAYERS.some((id) => on[id]) || isBody(selected) || pulling.on,
  };
  if (JSON.stringify(message) === told) return;
  told = JSON.stringify(message);
  source.send(message);
}

const receivers = {
  async scene(message) {
    scene = message;
    document.title = `${message.name} – SimVis`;
    document.querySelector("h1").textContent = message.name;
    lamps = null;
    transforms.clear();
    for (const shape of shapes.values()) shape.remove();
    shapes.clear();
    scans.clear();
    images.clear();
    tables.clear();
    physics.clear();
    names.set(message.items, message.objects);
    objects = new Objects(message.objects, message.items);
    const restarts = message.parameters.findIndex((each) => each?.type === "physics" && each.name === "restarts");
    element("physics-menu").hidden = restarts < 0;
    element("restart").hidden = element("pull-label").hidden = source.recorded;
    element("restart").onclick = () => source.send({ op: "set", parameter: restarts, value: values[restarts] + 1 });
    await view.load(await source.glb(message.glb), message);
    for (const sensor of message.sensors) shapes.set(sensor.name, new SensorShape(sensor, view));
    shapes.forEach((shape) => shape.show(layers()));
    labels.show(message.sensors.map(({ name, transform }) => [name, () => placeOf(transform)]));
    tree.show(message.list, objects);
    parameters.build(message.parameters);
    place.offer(Object.keys(message.points).sort());
    told = ""; // of other sensors
    look();
    select(selected);
  },
  transforms(message) {
    for (const [index, rows] of message.transforms) transforms.set(index, rows);
    view.move(message.transforms);
    const moved = new Set(message.transforms.map(([index]) => index));
    if (lamps?.lights.some(({ transform }) => moved.has(transform))) view.light(lamps.lights, rowsOf);
  },
  shapes: (message) => view.reshape(message.shapes),
  materials: (message) => view.paint(message.materials),
  lights(message) {
    lamps = message;
    view.light(message.lights, rowsOf);
  },
  hidden: (message) => view.hide(new Set(message.items)),
  environment: (message) => view.surround(message),
  values(message) {
    for (const [index, value] of message.values) {
      values[index] = value;
      parameters.write(index, value);
    }
  },
  bodies: (message) => physics.setBodies(message.bodies),
  physics: (message) => physics.place(message),
  series(message) {
    graphs.setAll(message.series);
    graphs.draw();
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
    for (const table of message.tables) {
      const sensor = scene.sensors[table.sensor].name;
      if (!table.one_row) tables.show(sensor, table);
      if (hasBoxes(table)) images.showBoxes(sensor, table);
    }
    graphs.draw(message.time_s);
    time.show(message);
    if (source.recorded && message.number !== shownNumber) layout.note();
    shownNumber = message.number ?? 0;
    if (kept) time.place(kept.place(), kept.shown !== null);
    if (message.plan !== undefined && element("plan-section").open) showPlan(element("plan"), message.plan);
    element("warnings").replaceChildren(...listOf(message.warnings));
    element("warnings-section").querySelector("summary").textContent = `Warnings (${message.warnings.length})`;
    showNews(message.news ?? []);
    if (selected) mark();
    selectionPanel.refresh();
    if (!opened) openView();
    document.documentElement.dataset.frame = message.frame;
  },
  playing: (message) => time.play(message.playing),
  error({ about, message }) {
    const isOf = (parameter) => parameter && message.startsWith(`${parameter.element}.${parameter.name}: `);
    const index = about === "set" ? scene.parameters.findIndex(isOf) : -1;
    if (index >= 0) return parameters.refuse(index, message);
    alertOf(message);
  },
  saved() {
    element("state").textContent = "the scene file is saved";
  },
};

/** A message of the simulation: it is kept, and shown unless the page looks back. */
async function receive(message) {
  if (message.op === "frame" && message.host !== host) {
    host = message.host;
    showState(HOSTS[host], host !== "runs");
  }
  if (!kept) return show(message);
  kept.note(message);
  series.note(message, scene);
  const isState = message.op !== "scene" && message.op !== "bodies" && message.op !== "error" && message.op !== "saved";
  if (!kept.looksBack || !isState) return show(message);
  if (message.op === "frame") time.place(kept.place(), true);
}

async function show(message) {
  try {
    await receivers[message.op]?.(message);
  } catch (error) {
    alertOf(String(error));
    console.error(error);
  }
}

const listOf = (texts) => texts.map((text) => Object.assign(document.createElement("li"), { textContent: text }));

/** The warnings that came with the frame of a recording, such as what a test found there, above the scene. */
function showNews(texts) {
  const more = texts.length - MOST_NEWS,
    shown = texts.slice(-MOST_NEWS);
  if (more > 0) shown.push(`and ${more} more in the section Warnings`);
  element("news").hidden = shown.length === 0;
  element("news")
    .querySelector("ul")
    .replaceChildren(...listOf(shown));
}

function alertOf(text) {
  const line = document.createElement("p");
  line.textContent = text;
  element("alerts").append(line);
  setTimeout(() => line.remove(), 15000);
}

function drawScan(message) {
  const by = element("color-by");
  for (const name of message.columns.keys())
    if (![...by.options].some((option) => option.value === name)) by.add(new Option(name));
  const column = message.columns.get(by.value);
  const limits = shapes.get(scene.sensors[message.sensor].name).measure(message, by.value, layers());
  if (limits) showRamp(element("legend"), limits, column?.unit ?? "");
  else showLabels(element("legend"), column.values, (number) => names.of(by.value, number));
}

/**
 * The first view: along the beam that the link selects; else around the first sensors that measure, from where nothing
 * stands in between; else the whole scene.
 */
function openView() {
  opened = true;
  openLayout();
  if (layout.numbers("cam", 6) || (selected?.kind === "beam" && lookAlong(selected))) return;
  const near = robotPlaces(),
    whole = view.box();
  if (near.length > 0) navigation.standBefore(near, whole);
  else if (!whole.isEmpty()) navigation.frame(whole, navigation.direction(-50, 35));
}

/** Stands behind a sensor and looks along its beam. False: the beam ends nowhere. */
function lookAlong({ name, place }) {
  const end = place(),
    start = placeOf(scene.sensors.find((each) => each.name === name).transform);
  if (!end || !start) return false;
  navigation.standBehind(start, end);
  return true;
}

/** The places of the sensors of the first robot. */
function robotPlaces() {
  const places = scene.sensors
    .filter((each) => !each.visualization)
    .map((each) => placeOf(each.transform))
    .filter(Boolean);
  return places.filter((place) => Math.hypot(...place.map((value, i) => value - places[0][i])) < SAME_ROBOT_M);
}

/** The middle of the first robot's sensors; null without any. */
function robotMiddle() {
  const places = scene ? robotPlaces() : [];
  return places.length === 0
    ? null
    : [0, 1, 2].map((i) => places.reduce((sum, place) => sum + place[i], 0) / places.length);
}

/** All of the scene; of a closed room, the inside from above without its ceiling. */
function showWhole() {
  const robot = robotMiddle();
  cutAbove(1);
  navigation.frame(view.box());
  const room = robot && view.hides(robot) && view.roomAround(robot);
  if (room) {
    navigation.frame(room.box, navigation.fromAbove());
    cutAbove(view.shareOfHeight(room.ceiling_m));
  }
  cutInFront(robot !== null && view.hides(robot));
}

/** Cuts away what lies above a share of the scene's height; 1: nothing. */
function cutAbove(share) {
  element("cut").value = 100 * share;
  view.cutAbove(share);
  layout.note();
}

function cutInFront(on) {
  element("cut-front").checked = on;
  view.setFront(on ? robotMiddle : null);
  layout.note();
}

function describeLayout() {
  const on = layers(),
    { position } = view.camera,
    { target } = navigation.orbit;
  const numbers = [...position.toArray(), ...target.toArray()].map((value) => Number(value.toFixed(3)));
  return {
    cam: navigation.mode === "sensor" ? null : numbers.join(","),
    layers: Object.keys(on)
      .filter((id) => on[id])
      .join(","),
    open: [...document.querySelectorAll("aside > details[open]")].map(({ id }) => id.replace("-section", "")).join(","),
    by: element("color-by").value,
    cut: element("cut-front").checked ? "front" : null,
    above: Number(element("cut").value) < 100 ? Number(element("cut").value).toFixed(1) : null,
    select: selected && scene ? (selected.link ?? `${selected.kind}:${selected.name}`) : null,
    frame: source.recorded ? String(shownNumber) : null,
  };
}

/** Sets the page up as the link says. */
function openLayout() {
  const camera = layout.numbers("cam", 6);
  if (camera) navigation.stand(camera.slice(0, 3), camera.slice(3));
  if (layout.get("cut") === "front") cutInFront(true);
  const above = layout.numbers("above", 1);
  if (above) cutAbove(above[0] / 100);
  const thing = picking.thingOfLink(layout.get("select") ?? "");
  if (thing) select(thing);
}

/** What the link says of layers and sections, before anything is shown. */
function openLayers() {
  const on = layout.names("layers"),
    open = layout.names("open"),
    by = layout.get("by");
  if (on) for (const id of Object.keys(layers())) element(`show-${id}`).checked = on.includes(id);
  if (open)
    for (const section of document.querySelectorAll("aside > details"))
      section.open = open.includes(section.id.replace("-section", ""));
  if (by && ![...element("color-by").options].some(({ value }) => value === by))
    element("color-by").add(new Option(by));
  if (by) element("color-by").value = by;
  showLayers();
}

function showLayers() {
  const on = layers();
  shapes.forEach((shape) => shape.show(on));
  physics.show(on);
  labels.on = on.names;
  view.showGrid(on.grid);
  look();
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

/** Whether what is selected is a model, a link or another object in the file of a part. */
const isObject = (thing) => ["model", "link", "frame"].includes(thing?.kind);

function mark() {
  if (!selected) return view.mark(null);
  view.markPoint(selected.place?.() ?? null);
  if (isObject(selected)) {
    const names = objects.contentOf(selected.name);
    return view.mark((item) => names.has(item.point));
  }
  if (!["part", "element"].includes(selected.kind)) return view.mark(null);
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
  view.markPoint(null);
  layout.note();
  look();
  dragging.end();
  place.stop();
  tree.select(thing);
  selectionPanel.show(thing, scene);
  document.documentElement.dataset.selected = thing ? `${thing.kind} ${thing.name}` : "";
  mark();
  if (thing?.kind === "sensor") images.reveal(thing.name);
  if (thing?.kind === "element") parameters.reveal(thing.name);
  if ((thing?.kind === "part" || isObject(thing)) && scene.points[thing.name] !== undefined)
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

view.onClick((hit, event) => {
  if (dragging.dragging || pulling.on) return;
  select(picking.thingOf(hit, event));
});

/** Whether the selection panel tells what physics knows of it. */
const isBody = (thing) =>
  !element("physics-menu").hidden && (thing?.kind === "part" || thing?.kind === "element" || isObject(thing));

/** What physics knows of a part, an object in its file or an element. */
function physicsOf(kind, name) {
  const points = kind === "element" ? null : objects.contentOf(name);
  return physics.factsOf((body) => (points ? points.has(body.name) : body.element === name));
}

element("camera-mode").addEventListener("change", ({ target }) => navigation.set(target.value));
element("whole").addEventListener("click", showWhole);
element("cut-front").addEventListener("change", ({ target }) => cutInFront(target.checked));
element("focus").addEventListener("click", focusSelection);
element("cut").addEventListener("input", ({ target }) => cutAbove(Number(target.value) / 100));
for (const id of [...SCENE_LAYERS, ...PHYSICS_LAYERS]) {
  element(`show-${id}`).addEventListener("change", () => {
    showLayers();
    layout.note();
  });
}
element("pull").addEventListener("change", ({ target }) => {
  pulling.on = target.checked;
  look();
});
element("color-by").addEventListener("change", () => {
  scans.forEach(drawScan);
  layout.note();
});
navigation.orbit.addEventListener("change", () => layout.note());
for (const section of ["plan-section", "images-section"]) element(section).addEventListener("toggle", look);
element("plan-section").addEventListener("toggle", ({ target }) => {
  if (target.open && frame.plan !== undefined) showPlan(element("plan"), frame.plan);
});
for (const section of document.querySelectorAll("aside > details"))
  section.addEventListener("toggle", () => {
    graphs.draw();
    layout.note();
  });
element("news")
  .querySelector("button")
  .addEventListener("click", () => showNews([]));
element("show-tree").addEventListener("click", () => showTree(!document.body.classList.contains("tree-open")));
element("save").hidden = source.recorded;
element("save").addEventListener("click", () => source.send({ op: "save" }));

for (const menu of document.querySelectorAll(".menu")) {
  document.addEventListener("pointerdown", ({ target }) => {
    if (!menu.contains(target)) menu.open = false;
  });
  menu.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    menu.open = false;
    menu.querySelector("summary").focus();
  });
}

/** On a phone, the tree lies over the view. */
function showTree(on) {
  document.body.classList.toggle("tree-open", on);
  element("show-tree").setAttribute("aria-expanded", String(on));
}

function focusSelection() {
  if (!selected) return navigation.frame(view.box());
  if (isObject(selected)) {
    const names = objects.contentOf(selected.name);
    return navigation.frame(view.box((item) => names.has(item.point)));
  }
  if (!["part", "element"].includes(selected.kind))
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
    ".": () => ask({ op: "step" }),
    f: focusSelection,
    Home: showWhole,
    "?": () => (element("keys-menu").open = true),
    Escape: () => (navigation.mode === "sensor" ? navigation.set("orbit") : select(null)),
  };
  if (!keys[event.key]) return;
  keys[event.key]();
  event.preventDefault();
});

/** What tests of the page and the browser's console read. */
export const page = {
  view,
  dragging,
  graphs,
  images,
  kept,
  physics,
  pulling,
  scans,
  values,
  scene: () => scene,
  selected: () => selected,
};

openLayers();
source.start();
