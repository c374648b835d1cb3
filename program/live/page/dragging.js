// Dragging in the view: a pose element, or the place of a new sensor.
import * as THREE from "three";
import { TransformControls } from "simvis/TransformControls.js";
import { toRigid } from "simvis/scene_view.js";

const DEG = 180 / Math.PI;

/** The numbers of a pose: x y z in metres, roll pitch yaw in degrees; R = Rz(yaw) Ry(pitch) Rx(roll). */
export function poseOf(matrix) {
  const position = new THREE.Vector3(),
    rotation = new THREE.Quaternion();
  matrix.decompose(position, rotation, new THREE.Vector3());
  const angles = new THREE.Euler().setFromQuaternion(rotation, "ZYX");
  return {
    x: position.x,
    y: position.y,
    z: position.z,
    roll: angles.x * DEG,
    pitch: angles.y * DEG,
    yaw: angles.z * DEG,
  };
}

export function matrixOf({ x, y, z, roll, pitch, yaw }) {
  const angles = new THREE.Euler(roll / DEG, pitch / DEG, yaw / DEG, "ZYX");
  return new THREE.Matrix4().compose(
    new THREE.Vector3(x, y, z),
    new THREE.Quaternion().setFromEuler(angles),
    new THREE.Vector3(1, 1, 1),
  );
}

export class Dragging {
  constructor(view, navigation) {
    this.view = view;
    this.proxy = new THREE.Object3D();
    view.scene.add(this.proxy);
    this.controls = new TransformControls(view.camera, view.canvas);
    this.controls.setSpace("local");
    this.controls.setSize(0.8);
    view.scene.add(this.controls);
    this.controls.addEventListener("change", () => {
      view.dirty = true;
    });
    this.controls.addEventListener("dragging-changed", ({ value }) => {
      this.dragging = value;
      navigation.orbit.enabled = !value && navigation.mode === "orbit";
    });
    this.controls.addEventListener("objectChange", () => {
      this.proxy.updateMatrix();
      this.moved?.(poseOf(new THREE.Matrix4().getInverse(this.parent).multiply(this.proxy.matrix)));
    });
  }

  /** `parent` are the rows of world_from_parent, `pose` is in it; `moved` gets each new pose. */
  begin(parent, pose, moved) {
    if (this.dragging) return;
    this.parent = parent.isMatrix4 ? parent : toRigid(parent);
    this.moved = moved;
    this.parent
      .clone()
      .multiply(matrixOf(pose))
      .decompose(this.proxy.position, this.proxy.quaternion, new THREE.Vector3());
    this.proxy.updateMatrixWorld(true);
    this.controls.attach(this.proxy);
    this.view.dirty = true;
  }

  /** world_from_parent, of a pose in it and the rows of where that stands. */
  parentOf(rows, pose) {
    return toRigid(rows).multiply(new THREE.Matrix4().getInverse(matrixOf(pose)));
  }

  end() {
    this.controls.detach();
    this.moved = null;
    this.view.dirty = true;
  }

  set(mode) {
    this.controls.setMode(mode);
  }
}
