// What physics has of a scene, drawn over it: where bodies touch and with what force, their centres of mass and
// inertias, the shapes that collide, the axes of joints.
import * as THREE from "three";
import { short } from "simvis/color_ramp.js";
import { toMatrix } from "simvis/scene_view.js";

const shown = (code) => new THREE.Color(code).convertGammaToLinear(2.2); // the picture is encoded when it is drawn
const COLORS = {
  contacts: shown(0xe5484d),
  masses: shown(0xd9a400),
  collisions: shown(0x3d8be0),
  joints: shown(0xb45fd6),
};
const ARROW_M = 0.5, // of the greatest force so far
  HEAD = 0.2, // of an arrow, as a share of its length
  AXIS_M = 0.25, // half of what is drawn of the axis of a joint
  CENTER_M = 0.03, // half of the cross at a centre of mass
  PLANE_M = 5, // half of what is drawn of a plane without end
  ROUND = 32, // pieces of a circle
  EDGE_DEG = 15, // between two triangles of a hull that have an edge
  NO_BODY = 0xffffffff;

const circle = (place) => {
  const points = [];
  for (let i = 0; i < ROUND; ++i) for (const k of [i, i + 1]) points.push(place((2 * Math.PI * k) / ROUND));
  return points;
};
const rings = ([x, y, z]) => [
  ...circle((a) => [x * Math.cos(a), y * Math.sin(a), 0]),
  ...circle((a) => [x * Math.cos(a), 0, z * Math.sin(a)]),
  ...circle((a) => [0, y * Math.cos(a), z * Math.sin(a)]),
];
const cross = (size) =>
  [0, 1, 2].flatMap((axis) => [-1, 1].map((side) => [0, 1, 2].map((i) => (i === axis ? side * size : 0))));

function boxLines([x, y, z]) {
  const points = [];
  for (const a of [-1, 1])
    for (const b of [-1, 1]) {
      points.push([-x, a * y, b * z], [x, a * y, b * z]);
      points.push([a * x, -y, b * z], [a * x, y, b * z]);
      points.push([a * x, b * y, -z], [a * x, b * y, z]);
    }
  return points;
}

function cylinderLines([radius, , half], domes) {
  const points = [];
  for (const z of [-half, half]) points.push(...circle((a) => [radius * Math.cos(a), radius * Math.sin(a), z]));
  for (const [x, y] of [
    [1, 0],
    [-1, 0],
    [0, 1],
    [0, -1],
  ])
    points.push([x * radius, y * radius, -half], [x * radius, y * radius, half]);
  if (!domes) return points;
  const dome = (a) => [radius * Math.cos(a), half + radius * Math.sin(a)];
  for (let i = 0; i < ROUND / 2; ++i)
    for (const k of [i, i + 1]) {
      const [across, up] = dome((2 * Math.PI * k) / ROUND);
      points.push([across, 0, up], [0, across, up], [across, 0, -up], [0, across, -up]);
    }
  return pairs(points, points.length - 4 * ROUND);
}

/** Points behind `first` come in groups of four lines side by side; these are put behind each other. */
function pairs(points, first) {
  const sorted = points.slice(0, first);
  for (let i = first; i < points.length; i += 8)
    for (let k = 0; k < 4; ++k) sorted.push(points[i + k], points[i + k + 4]);
  return sorted;
}

function hullLines({ points, triangles }) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points.flat(), 3));
  geometry.setIndex(triangles);
  const edges = new THREE.EdgesGeometry(geometry, EDGE_DEG),
    { array } = edges.getAttribute("position"),
    lines = [];
  for (let i = 0; i < array.length; i += 3) lines.push([array[i], array[i + 1], array[i + 2]]);
  return lines;
}

/** Pairs of points: the lines that show a shape, in its own frame. */
export function linesOf(shape) {
  const kinds = {
    box: () => boxLines(shape.half_m),
    sphere: () => rings([shape.half_m[0], shape.half_m[0], shape.half_m[0]]),
    capsule: () => cylinderLines(shape.half_m, true),
    cylinder: () => cylinderLines(shape.half_m, false),
    hull: () => hullLines(shape),
    plane: () => [...boxLines([PLANE_M, PLANE_M, 0]), [0, 0, 0], [0, 0, AXIS_M]],
  };
  return kinds[shape.kind]();
}

const jointLines = ({ kind, axis }) =>
  kind === "fixed"
    ? []
    : kind === "ball"
      ? rings([AXIS_M / 2, AXIS_M / 2, AXIS_M / 2])
      : [-1, 1].map((side) => axis.map((value) => side * AXIS_M * value));

/** A round number that is not smaller. */
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].find((each) => each * power >= value * (1 - 1e-9)) * power;
}

function lines(points, color, opacity = 1) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points.flat(), 3));
  const drawn = new THREE.LineSegments(
    geometry,
    new THREE.LineBasicMaterial({ color, opacity, transparent: true, depthTest: false }),
  );
  drawn.frustumCulled = false;
  drawn.renderOrder = 1;
  return drawn;
}

export class PhysicsLayer {
  /** `legend` gets the scale of the forces. */
  constructor(view, legend) {
    Object.assign(this, { view, legend, on: {}, bodies: [], contacts: [] });
    this.root = new THREE.Group();
    this.touches = new THREE.Group();
    view.overlay.add(this.root);
    this.clear();
  }

  clear() {
    this.bodies = [];
    this.contacts = [];
    this.greatest_n = 0;
    for (const child of [...this.root.children]) this.root.remove(child);
    this.root.add(this.touches);
    this.drawContacts();
  }

  /** What the bodies are; they are drawn when they have a place. */
  setBodies(bodies) {
    this.clear();
    this.bodies = bodies.map((body) => ({ ...body, group: this.groupOf(body) }));
    this.root.add(...this.bodies.map(({ group }) => group));
    this.show(this.on);
  }

  groupOf(body) {
    const group = new THREE.Group();
    group.matrixAutoUpdate = false;
    group.visible = false;
    const add = (layer, points, color, rows, opacity) => {
      if (points.length === 0) return;
      const drawn = lines(points, color, opacity);
      drawn.userData.layer = layer;
      if (rows) {
        drawn.matrixAutoUpdate = false;
        toMatrix(rows, drawn.matrix);
      }
      group.add(drawn);
    };
    for (const shape of body.shapes) add("collisions", linesOf(shape), COLORS.collisions, shape.rows, 0.7);
    if (body.mass_kg > 0) {
      add("masses", rings(body.half_m), COLORS.masses, body.axes, 0.8);
      add("masses", cross(CENTER_M), COLORS.masses, body.axes);
    }
    if (body.joint) add("joints", jointLines(body.joint), COLORS.joints);
    return group;
  }

  /** A frame that has no places, as one from before physics was wanted, shows no bodies. */
  place({ poses, contacts }) {
    this.bodies.forEach(({ group }, i) => {
      group.visible = i < poses.length;
      if (!group.visible) return;
      toMatrix(poses[i], group.matrix);
      group.matrixWorldNeedsUpdate = true;
    });
    this.contacts = contacts;
    for (const { force_n } of contacts) this.greatest_n = Math.max(this.greatest_n, force_n);
    this.drawContacts();
  }

  drawContacts() {
    for (const child of [...this.touches.children]) {
      child.geometry.dispose();
      this.touches.remove(child);
    }
    const scale_n = this.greatest_n > 0 ? roundUp(this.greatest_n) : 0;
    if (this.contacts.length > 0) {
      const points = new THREE.BufferGeometry();
      points.setAttribute(
        "position",
        new THREE.Float32BufferAttribute(
          this.contacts.flatMap(({ point }) => point),
          3,
        ),
      );
      const dots = new THREE.Points(
        points,
        new THREE.PointsMaterial({
          color: COLORS.contacts,
          size: 6,
          sizeAttenuation: false,
          depthTest: false,
          transparent: true,
        }),
      );
      dots.frustumCulled = false;
      dots.renderOrder = 1;
      this.touches.add(
        dots,
        lines(
          this.contacts.flatMap((each) => this.arrowOf(each, scale_n)),
          COLORS.contacts,
        ),
      );
    }
    this.legend.textContent = scale_n > 0 ? `contacts: an arrow of ${ARROW_M} m is ${short(scale_n)} N` : "";
    this.touches.visible = Boolean(this.on.contacts);
    this.view.dirty = true;
  }

  /** Along the force on the body that moves; of two that move, on the first. */
  arrowOf({ point, normal, force_n, a, b }, scale_n) {
    if (!(force_n > 0)) return [];
    const isOnSecond = this.bodies[a]?.kind !== "dynamic" && this.bodies[b]?.kind === "dynamic";
    const start = new THREE.Vector3(...point),
      along = new THREE.Vector3(...normal).multiplyScalar(((isOnSecond ? -1 : 1) * ARROW_M * force_n) / scale_n),
      end = start.clone().add(along);
    const side = new THREE.Vector3(
      Math.abs(along.x) > Math.abs(along.z) ? 0 : 1,
      0,
      Math.abs(along.x) > Math.abs(along.z) ? 1 : 0,
    )
      .cross(along)
      .multiplyScalar(HEAD / 2);
    const back = end.clone().addScaledVector(along, -HEAD);
    return [start, end, end, back.clone().add(side), end, back.clone().sub(side)].map((each) => each.toArray());
  }

  /** `on`: which of contacts, masses, collisions and joints are drawn. */
  show(on) {
    this.on = on;
    for (const { group } of this.bodies)
      for (const child of group.children) child.visible = Boolean(on[child.userData.layer]);
    this.touches.visible = Boolean(on.contacts);
    this.legend.hidden = !on.contacts;
    this.view.dirty = true;
  }

  /** The dynamic body that moves with an item: { number, matrix }, whose matrix follows it; null: none. */
  bodyOf({ point, part }) {
    const named = (name) => this.bodies.findIndex((body) => body.kind === "dynamic" && body.name === name);
    const number = [point, part].map(named).find((each) => each >= 0);
    if (number === undefined || !this.bodies[number].group.visible) return null;
    return { number, matrix: this.bodies[number].group.matrix };
  }

  /** What is known of the bodies of an element, or that move with an insertion point, as pairs of a name and a text. */
  factsOf(fits) {
    const own = this.bodies.map((body, i) => [body, i]).filter(([body]) => fits(body));
    if (own.length === 0) return [];
    const numbers = new Set(own.map(([, i]) => i)),
      touching = this.contacts.filter(({ a, b }) => numbers.has(a) !== numbers.has(b));
    const mass = own.reduce((sum, [{ mass_kg }]) => sum + mass_kg, 0),
      force = touching.reduce((sum, { force_n }) => sum + Math.max(0, force_n), 0);
    const others = new Set(touching.map(({ a, b }) => (numbers.has(a) ? b : a)));
    const names = [...others].filter((i) => i !== NO_BODY).map((i) => this.bodies[i]?.name);
    return [
      ["body", own[0][0].kind],
      ["mass", mass > 0 ? `${short(mass)} kg` : null],
      [
        "touches",
        touching.length > 0
          ? `${[...new Set(names)].join(", ")}: ${touching.length} points, ${short(force)} N`
          : "nothing",
      ],
    ];
  }
}
