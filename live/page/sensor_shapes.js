// What stands for a sensor in the view: its frame, its field of view, a handle to click on, its scan, its trail.
import * as THREE from "three";
import { colorOf, limitsOf, shareOf } from "simvis/color_ramp.js";
import { toMatrix, toRigid } from "simvis/scene_view.js";

const AXIS_M = 0.25,
  FRUSTUM_M = 0.5,
  HANDLE_M = 0.03,
  ARC_STEPS = 32,
  LONGEST_TRAIL = 5000;
const number = (sensor, name, otherwise) => Number(sensor.attributes[name] ?? otherwise);

export const isScanner = (sensor) => sensor.attributes.min_angle !== undefined;
export const isCamera = (sensor) => sensor.attributes.hfov !== undefined;
/** Of a camera: the horizontal field of view, and width by height. */
export const lensOf = (sensor) => ({
  hfov_deg: number(sensor, "hfov", 90),
  aspect: number(sensor, "width", 4) / number(sensor, "height", 3),
});

function line(points, color, opacity) {
  const geometry = new THREE.BufferGeometry().setFromPoints(points.map((p) => new THREE.Vector3(...p)));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color, transparent: true, opacity }));
}

function cameraLines(sensor) {
  const { hfov_deg, aspect } = lensOf(sensor),
    y = FRUSTUM_M * Math.tan((Math.min(hfov_deg, 170) * Math.PI) / 360),
    z = y / aspect;
  const corners = [
    [FRUSTUM_M, y, z],
    [FRUSTUM_M, -y, z],
    [FRUSTUM_M, -y, -z],
    [FRUSTUM_M, y, -z],
  ];
  const points = corners.flatMap((corner, i) => [[0, 0, 0], corner, corner, corners[(i + 1) % 4]]);
  return [
    ...points,
    [FRUSTUM_M, y * 0.3, z],
    [FRUSTUM_M, 0, z * 1.35],
    [FRUSTUM_M, 0, z * 1.35],
    [FRUSTUM_M, -y * 0.3, z],
  ];
}

function scannerLines(sensor) {
  const from = (number(sensor, "min_angle", -90) * Math.PI) / 180,
    to = (number(sensor, "max_angle", 90) * Math.PI) / 180;
  const points = [];
  for (let i = 0; i < ARC_STEPS; ++i) {
    for (const k of [i, i + 1]) {
      const angle = from + ((to - from) * k) / ARC_STEPS;
      points.push([FRUSTUM_M * Math.cos(angle), FRUSTUM_M * Math.sin(angle), 0]);
    }
  }
  return [[0, 0, 0], points[0], [0, 0, 0], points[points.length - 1], ...points];
}

export class SensorShape {
  constructor(sensor, view) {
    this.view = view;
    this.group = new THREE.Group();
    this.group.matrixAutoUpdate = false;
    this.axes = new THREE.AxesHelper(AXIS_M);
    const color = isCamera(sensor) ? 0x2a9d62 : 0xc77d1a;
    this.frustum = line(
      isCamera(sensor)
        ? cameraLines(sensor)
        : isScanner(sensor)
          ? scannerLines(sensor)
          : [
              [0, 0, 0],
              [FRUSTUM_M, 0, 0],
            ],
      color,
      0.8,
    );
    const handle = new THREE.Mesh(
      new THREE.SphereBufferGeometry(HANDLE_M, 12, 8),
      new THREE.MeshBasicMaterial({ color }),
    );
    handle.userData.sensor = sensor.name;
    this.group.userData.handle = handle;
    this.group.add(this.axes, this.frustum, handle);
    this.scan = new THREE.Group();
    this.scan.matrixAutoUpdate = false;
    this.trail = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color }));
    this.trail.frustumCulled = false;
    this.places = []; // [frame, x, y, z] by frame
    view.overlay.add(this.group, this.scan, this.trail);
  }

  remove() {
    this.view.overlay.remove(this.group, this.scan, this.trail);
  }

  place(rows, frame) {
    this.group.visible = Boolean(rows);
    if (!rows) return;
    this.group.matrix.copy(toRigid(rows));
    this.group.matrixWorldNeedsUpdate = true;
    const at = this.places.findIndex(([known]) => known >= frame);
    const place = [frame, rows[3], rows[7], rows[11]];
    if (at < 0) this.places.push(place);
    else this.places.splice(at, this.places[at][0] === frame ? 1 : 0, place);
    if (this.places.length > LONGEST_TRAIL) this.places.shift();
    const shown = this.places.filter(([known]) => known <= frame).map(([, ...p]) => new THREE.Vector3(...p));
    this.trail.geometry.dispose();
    this.trail.geometry = new THREE.BufferGeometry().setFromPoints(shown.length > 1 ? shown : []);
    this.view.dirty = true;
  }

  show({ frusta, axes, points, beams, trails }) {
    this.frustum.visible = frusta;
    this.axes.visible = axes;
    this.trail.visible = trails;
    for (const child of this.scan.children) child.visible = child.isPoints ? points : beams;
    this.view.dirty = true;
  }

  /** Returns the limits of the colours. */
  measure(message, values, layers) {
    for (const child of [...this.scan.children]) {
      child.geometry.dispose();
      child.material.dispose();
      this.scan.remove(child);
    }
    const range = message.columns.get("range_m").values,
      limits = limitsOf(values);
    const places = [],
      colors = [],
      ends = [];
    for (let i = 0; i < range.length; ++i) {
      const x = message.points[3 * i],
        y = message.points[3 * i + 1],
        z = message.points[3 * i + 2];
      if (!Number.isFinite(x) || range[i] === 0) continue;
      const color = colorOf(shareOf(values[i] ?? NaN, limits)).map((part) => (part / 255) ** 2.2);
      places.push(x, y, z);
      colors.push(...color);
      ends.push(0, 0, 0, x, y, z);
    }
    const floats = (array) => new THREE.Float32BufferAttribute(array, 3);
    const points = new THREE.BufferGeometry();
    points.setAttribute("position", floats(places));
    points.setAttribute("color", floats(colors));
    this.scan.add(
      new THREE.Points(
        points,
        new THREE.PointsMaterial({ size: 5, sizeAttenuation: false, vertexColors: THREE.VertexColors }),
      ),
    );
    const beams = new THREE.BufferGeometry();
    beams.setAttribute("position", floats(ends));
    beams.setAttribute(
      "color",
      floats(colors.flatMap((_, i) => (i % 3 === 0 ? [...colors.slice(i, i + 3), ...colors.slice(i, i + 3)] : []))),
    );
    this.scan.add(
      new THREE.LineSegments(
        beams,
        new THREE.LineBasicMaterial({ vertexColors: THREE.VertexColors, transparent: true, opacity: 0.35 }),
      ),
    );
    toMatrix(message.world_from_sensor, this.scan.matrix);
    this.scan.matrixWorldNeedsUpdate = true;
    for (const child of this.scan.children) child.frustumCulled = false;
    this.show(layers);
    return limits;
  }
}
