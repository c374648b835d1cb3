// How the camera of the view moves: around a point, freely, or with a camera of the scene.
import * as THREE from "three";
import { OrbitControls } from "simvis/OrbitControls.js";
import { toRigid } from "simvis/scene_view.js";

const FLY_M_PER_S = 2.5,
  FAST = 4,
  LOOK_RAD_PER_PX = 0.004,
  TURN_RAD = 0.08,
  ZOOM = 1.15;
const FIRST_REACH_M = 5,
  FIRST_ELEVATION_DEG = 28,
  LOW_ELEVATION_DEG = 5,
  FIRST_TRIES = 12,
  LEAST_REACH_M = 1.5,
  BEHIND_M = 1.6, // a view along a beam stands so far behind the sensor, and so far above it
  ABOVE_M = 1,
  OWN_BODY_M = 1, // around a sensor, where its robot stands
  ROOM_ELEVATION_DEG = 55;
const FLY_KEYS = { w: [0, 0, -1], s: [0, 0, 1], a: [-1, 0, 0], d: [1, 0, 0], q: [0, -1, 0], e: [0, 1, 0] };

// A camera of three.js looks along -z with y up, a sensor along x with z up.
const SENSOR_FROM_CAMERA = new THREE.Matrix4().set(0, 0, -1, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1);

export class Navigation {
  constructor(view, hint) {
    this.view = view;
    this.hint = hint;
    this.mode = "orbit";
    this.sensor = null; // looked through: { rows, fov }
    this.orbit = new OrbitControls(view.camera, view.canvas);
    this.orbit.enableKeys = false;
    this.orbit.screenSpacePanning = true;
    this.orbit.addEventListener("change", () => {
      view.dirty = true;
    });
    this.keys = new Set();
    this.last = performance.now();
    view.canvas.addEventListener("keydown", (event) => this.press(event));
    view.canvas.addEventListener("keyup", (event) => this.keys.delete(event.key.toLowerCase()));
    view.canvas.addEventListener("blur", () => this.keys.clear());
    view.canvas.addEventListener("pointermove", (event) => this.look(event));
    view.onFrame.push(() => this.step());
  }

  /** `mode`: orbit, fly or sensor. */
  set(mode, sensor = null) {
    this.mode = mode;
    this.sensor = sensor;
    this.orbit.enabled = mode === "orbit";
    this.hint.textContent =
      mode === "fly"
        ? "W A S D Q E move, drag to look, shift is faster"
        : mode === "sensor"
          ? `through ${sensor.name}; Escape ends it`
          : "";
    if (mode !== "sensor") {
      this.view.camera.fov = 50;
      this.view.camera.updateProjectionMatrix();
    }
    if (mode === "orbit") this.aimAt(this.view.camera.position.clone().add(this.ahead().multiplyScalar(3)));
    this.view.dirty = true;
  }

  ahead() {
    return this.view.camera.getWorldDirection(new THREE.Vector3());
  }

  aimAt(target) {
    this.orbit.target.copy(target);
    this.orbit.update();
  }

  /** Goes to where the box fills the view, from the direction in which the camera stands now. */
  frame(box, from = null) {
    if (box.isEmpty()) return;
    const { camera } = this.view,
      sphere = box.getBoundingSphere(new THREE.Sphere());
    const direction = from ?? camera.position.clone().sub(this.orbit.target).normalize();
    const half = (Math.min(camera.fov * camera.aspect, camera.fov) * Math.PI) / 360;
    const distance = Math.max(sphere.radius, 0.1) / Math.sin(half);
    camera.position.copy(sphere.center).addScaledVector(direction.normalize(), distance);
    this.aimAt(sphere.center);
    this.view.dirty = true;
  }

  /** Stands at one point and looks at another. */
  stand(place, target) {
    this.view.camera.position.set(...place);
    this.aimAt(new THREE.Vector3(...target));
    this.view.dirty = true;
  }

  /** The direction in which the camera stands now, but so steep that it looks over the walls of a room. */
  fromAbove() {
    const { x, y } = this.view.camera.position.clone().sub(this.orbit.target);
    return this.direction((Math.atan2(y, x) * 180) / Math.PI, ROOM_ELEVATION_DEG);
  }

  /** A unit vector from azimuth and elevation in degrees. */
  direction(azimuth, elevation) {
    const a = (azimuth * Math.PI) / 180,
      e = (elevation * Math.PI) / 180;
    return new THREE.Vector3(Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e));
  }

  /**
   * Looks at points of the world from where the way to them is free the longest, and of several such places, from where it
   * is so close above the ground: a low wall then does not hide what stands behind it.
   */
  standBefore(points, whole) {
    const box = new THREE.Box3().setFromPoints(points.map((point) => new THREE.Vector3(...point)));
    const middle = box.getCenter(new THREE.Vector3()),
      reach = FIRST_REACH_M + box.getSize(new THREE.Vector3()).length();
    const beyond = box.getSize(new THREE.Vector3()).length() / 2 + 0.5,
      freeFrom = (direction) => Math.min(reach, this.view.freeReach(middle, direction, beyond));
    let best = { free: 0, low: 0 };
    for (let i = 0; i < FIRST_TRIES; ++i) {
      const azimuth = -50 + (360 * i) / FIRST_TRIES,
        direction = this.direction(azimuth, FIRST_ELEVATION_DEG);
      const free = freeFrom(direction),
        low = freeFrom(this.direction(azimuth, LOW_ELEVATION_DEG));
      if (free > best.free + 1e-6 || (free > best.free - 1e-6 && low > best.low + 1e-6)) best = { free, low, direction };
    }
    if (best.free < LEAST_REACH_M) return this.frame(whole, this.direction(-50, 35));
    this.view.camera.position.copy(middle).addScaledVector(best.direction, 0.95 * best.free);
    this.aimAt(middle);
  }

  /** Stands behind one point, a little above the line to another, and looks along it. */
  standBehind(start, end) {
    const from = new THREE.Vector3(...start),
      to = new THREE.Vector3(...end),
      back = from.clone().sub(to).setZ(0);
    back.setLength(BEHIND_M).setZ(ABOVE_M);
    const free = this.view.freeReach(from, back.clone().normalize(), OWN_BODY_M);
    this.view.camera.position.copy(from).add(back.clampLength(0, 0.9 * free));
    this.aimAt(to);
  }

  press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.toLowerCase();
    this.fast = event.shiftKey;
    if (this.mode === "fly" && FLY_KEYS[key]) this.keys.add(key);
    else if (this.mode === "orbit" && key.startsWith("arrow")) this.turn(key);
    else if (this.mode === "orbit" && (key === "+" || key === "-")) this.zoom(key === "+" ? 1 / ZOOM : ZOOM);
    else return;
    event.preventDefault();
  }

  turn(key) {
    const { camera } = this.view,
      arm = camera.position.clone().sub(this.orbit.target);
    const spherical = new THREE.Spherical().setFromVector3(new THREE.Vector3(arm.x, arm.z, -arm.y));
    spherical.theta += key === "arrowleft" ? -TURN_RAD : key === "arrowright" ? TURN_RAD : 0;
    spherical.phi += key === "arrowup" ? -TURN_RAD : key === "arrowdown" ? TURN_RAD : 0;
    spherical.makeSafe();
    const turned = new THREE.Vector3().setFromSpherical(spherical);
    camera.position.copy(this.orbit.target).add(new THREE.Vector3(turned.x, -turned.z, turned.y));
    this.orbit.update();
  }

  zoom(factor) {
    const { camera } = this.view;
    camera.position.sub(this.orbit.target).multiplyScalar(factor).add(this.orbit.target);
    this.orbit.update();
  }

  look(event) {
    if (this.mode !== "fly" || event.buttons === 0) return;
    const { camera } = this.view,
      ahead = this.ahead();
    const yaw = Math.atan2(ahead.y, ahead.x) - event.movementX * LOOK_RAD_PER_PX;
    const pitch = Math.max(-1.5, Math.min(1.5, Math.asin(ahead.z) - event.movementY * LOOK_RAD_PER_PX));
    camera.lookAt(
      camera.position
        .clone()
        .add(new THREE.Vector3(Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch))),
    );
    this.view.dirty = true;
  }

  step() {
    const now = performance.now(),
      seconds = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    if (this.mode === "sensor") return this.followSensor();
    if (this.mode !== "fly" || this.keys.size === 0) return;
    for (const key of this.keys) {
      this.view.camera.position.add(
        new THREE.Vector3(...FLY_KEYS[key])
          .applyQuaternion(this.view.camera.quaternion)
          .multiplyScalar((this.fast ? FAST : 1) * FLY_M_PER_S * seconds),
      );
    }
    this.view.dirty = true;
  }

  followSensor() {
    const { camera } = this.view,
      rows = this.sensor.rows();
    if (!rows) return;
    const world = toRigid(rows).multiply(SENSOR_FROM_CAMERA);
    world.decompose(camera.position, camera.quaternion, new THREE.Vector3());
    // The whole picture of the sensor is within the view.
    const tangent = Math.tan((this.sensor.hfov_deg * Math.PI) / 360);
    const fov = (2 * Math.atan(Math.max(tangent / camera.aspect, tangent / this.sensor.aspect)) * 180) / Math.PI;
    if (camera.fov !== fov) {
      camera.fov = fov;
      camera.updateProjectionMatrix();
    }
  }
}
