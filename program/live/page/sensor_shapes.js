// What stands for a sensor in the view: its frame, its field of view, a handle to click on, its scan, its trail.
import * as THREE from "three";
import { colorOf, colorOfLabel, isWhole, limitsOf, shareOf } from "simvis/color_ramp.js";
import { isId } from "simvis/names.js";
import { toMatrix, toRigid } from "simvis/scene_view.js";

const AXIS_M = 0.25,
  FRUSTUM_M = 0.5,
  HANDLE_M = 0.03,
  ARC_STEPS = 32,
  LONGEST_TRAIL = 5000;
const number = (sensor, name, otherwise) => Number(sensor.attributes[name] ?? otherwise);

export const isScanner = (sensor) => sensor.attributes.min_angle !== undefined;
export const isCamera = (sensor) => sensor.attributes.hfov !== undefined;
/** Of a camera: its pinhole in pixels, from the corner of the first one, and its horizontal field of view. */
export function lensOf(sensor) {
  const width = number(sensor, "width", 4),
    height = number(sensor, "height", 3),
    of_hfov = width / 2 / Math.tan((number(sensor, "hfov", 90) * Math.PI) / 360),
    fx = number(sensor, "fx", of_hfov);
  return {
    width,
    height,
    fx,
    fy: number(sensor, "fy", fx),
    cx: number(sensor, "cx", (width - 1) / 2) + 0.5,
    cy: number(sensor, "cy", (height - 1) / 2) + 0.5,
    hfov_deg: (Math.atan(width / 2 / fx) * 360) / Math.PI,
    aspect: width / height,
  };
}

/** The ray of three.js through the middle of a pixel of a camera without lens distortion, as it stands now. */
export function rayOfPixel(sensor, rows, [width, height], x, y) {
  const lens = lensOf(sensor);
  const along = new THREE.Vector3(
    1,
    (lens.cx - ((x + 0.5) * lens.width) / width) / lens.fx,
    (lens.cy - ((y + 0.5) * lens.height) / height) / lens.fy,
  );
  const world = toRigid(rows),
    start = new THREE.Vector3().setFromMatrixPosition(world);
  return new THREE.Raycaster(start, along.transformDirection(world));
}

/** The ray of three.js from one point of the world towards another. */
export function rayBetween(from, to) {
  const start = new THREE.Vector3(...from);
  return new THREE.Raycaster(start, new THREE.Vector3(...to).sub(start).normalize());
}

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
    this.trail.geometry.setAttribute("position", new THREE.Float32BufferAttribute(3 * (LONGEST_TRAIL + 1), 3));
    this.trail.visible = false; // until show() says otherwise
    this.trail.frustumCulled = false;
    this.asksForBeams = Boolean(sensor.beams);
    this.places = []; // [frame, x, y, z] by frame
    this.written = 0; // of them, from the first one on, in the buffer of the trail
    this.frame = 0; // that is shown
    this.drawn = { beams: [], places: [] }; // of the last scan: which beams have a point, and where
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
    const at = this.placesUpTo(frame - 1);
    this.places.splice(at, this.places[at]?.[0] === frame ? 1 : 0, [frame, rows[3], rows[7], rows[11]]);
    this.written = Math.min(this.written, at);
    if (this.places.length > LONGEST_TRAIL) {
      this.places.shift();
      this.written = 0;
    }
    this.frame = frame;
    this.drawTrail();
    this.view.dirty = true;
  }

  /** The number of places whose frames are not later; frames usually come in their order. */
  placesUpTo(frame) {
    let count = this.places.length;
    while (count > 0 && this.places[count - 1][0] > frame) --count;
    return count;
  }

  /** The places up to the frame that is shown. */
  drawTrail() {
    if (!this.trail.visible) return;
    const { position } = this.trail.geometry.attributes,
      { updateRange } = position,
      isWaiting = updateRange.count !== -1,
      first = isWaiting ? Math.min(this.written, updateRange.offset / 3) : this.written;
    for (; this.written < this.places.length; ++this.written)
      position.setXYZ(this.written, ...this.places[this.written].slice(1));
    Object.assign(updateRange, { offset: 3 * first, count: 3 * (this.written - first) });
    if (updateRange.count === 0) updateRange.count = -1;
    else position.needsUpdate = true;
    const count = this.placesUpTo(this.frame);
    this.trail.geometry.setDrawRange(0, count > 1 ? count : 0);
  }

  show({ frusta, axes, points, beams, trails }) {
    this.frustum.visible = frusta;
    this.axes.visible = axes;
    this.trail.visible = trails;
    this.drawTrail();
    for (const child of this.scan.children) child.visible = child.isPoints ? points : beams || this.asksForBeams;
    this.view.dirty = true;
  }

  /** Returns the limits of the colours; null if each number has a colour of its own. The column `by` gives the colours. */
  measure(message, by, layers) {
    for (const child of [...this.scan.children]) {
      child.geometry.dispose();
      child.material.dispose();
      this.scan.remove(child);
    }
    const range = message.columns.get("range_m").values,
      column = message.columns.get(by),
      values = column?.values ?? [],
      limits = isWhole(column?.type) && isId(by) ? null : limitsOf(values);
    const measured = [],
      places = [],
      colors = [],
      ends = [];
    for (let i = 0; i < range.length; ++i) {
      const x = message.points[3 * i],
        y = message.points[3 * i + 1],
        z = message.points[3 * i + 2];
      if (!Number.isFinite(x) || range[i] === 0) continue;
      const codes = limits ? colorOf(shareOf(values[i] ?? NaN, limits)) : colorOfLabel(values[i]);
      const color = codes.map((part) => (part / 255) ** 2.2);
      measured.push(i);
      places.push(x, y, z);
      colors.push(...color);
      ends.push(...(message.origins?.slice(3 * i, 3 * i + 3) ?? [0, 0, 0]), x, y, z);
    }
    this.drawn = { beams: measured, places };
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

  /** The beam whose point is drawn nearest to a place of the canvas, within `reach_px`: { beam, distance_m } or null. */
  beamAt(x, y, reach_px) {
    if (!this.scan.children.some((child) => child.visible)) return null;
    const { camera, canvas } = this.view,
      place = new THREE.Vector3();
    const canvas_from_sensor = new THREE.Matrix4()
      .multiplyMatrices(camera.projectionMatrix, new THREE.Matrix4().getInverse(camera.matrixWorld))
      .multiply(this.scan.matrix);
    const { beams, places } = this.drawn;
    let found = null;
    for (let i = 0; i < beams.length; ++i) {
      place.set(places[3 * i], places[3 * i + 1], places[3 * i + 2]).applyMatrix4(canvas_from_sensor);
      if (Math.abs(place.z) > 1) continue;
      const away = Math.hypot(
        ((place.x + 1) / 2) * canvas.clientWidth - x,
        ((1 - place.y) / 2) * canvas.clientHeight - y,
      );
      if (away <= reach_px && (!found || away < found.away)) found = { i, away };
    }
    if (!found) return null;
    const world = new THREE.Vector3(...places.slice(3 * found.i, 3 * found.i + 3)).applyMatrix4(this.scan.matrix);
    return { beam: beams[found.i], distance_m: world.distanceTo(camera.position) };
  }
}
