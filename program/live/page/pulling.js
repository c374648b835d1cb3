// Bodies of physics are pulled in the view: the place where one is held follows the pointer by a spring, in the plane that
// faces the camera there.
import * as THREE from "three";

export class Pulling {
  /** `bodyOf(item)` gives { number, matrix } of the body that moves with an item, or null; `send` asks the simulation. */
  constructor(view, navigation, { bodyOf, send }) {
    Object.assign(this, { view, navigation, bodyOf, send, on: false, held: null });
    this.line = new THREE.Line(
      new THREE.BufferGeometry(),
      new THREE.LineBasicMaterial({ color: 0xe5484d, depthTest: false, transparent: true }),
    );
    this.line.visible = false;
    this.line.frustumCulled = false;
    this.line.renderOrder = 2;
    view.overlay.add(this.line);
    // The controls of the camera listen to the mouse, which comes after the pointer.
    view.canvas.addEventListener("pointerdown", (event) => this.begin(event));
    view.canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
      view.canvas.addEventListener(end, () => this.end());
    view.onFrame.push(() => this.draw());
  }

  begin(event) {
    const hit = this.on && event.button === 0 ? this.view.pick(event) : null,
      body = hit?.item ? this.bodyOf(hit.item) : null;
    if (!body) return;
    const world = new THREE.Vector3(...hit.point);
    const at = world.clone().applyMatrix4(new THREE.Matrix4().getInverse(body.matrix));
    this.held = { ...body, at, to: world, plane: new THREE.Plane() };
    this.held.plane.setFromNormalAndCoplanarPoint(this.view.camera.getWorldDirection(new THREE.Vector3()), world);
    this.view.canvas.setPointerCapture(event.pointerId);
    this.navigation.orbit.enabled = false;
    this.ask();
  }

  move(event) {
    if (!this.held) return;
    this.view.rayOf(event).ray.intersectPlane(this.held.plane, this.held.to);
    this.ask();
  }

  ask() {
    const { number, at, to } = this.held;
    this.send({ op: "pull", body: number, at: at.toArray(), to: to.toArray() });
  }

  end() {
    if (!this.held) return;
    this.held = null;
    this.line.visible = false;
    this.view.dirty = true;
    this.navigation.orbit.enabled = this.navigation.mode === "orbit";
    this.send({ op: "release" });
  }

  draw() {
    if (!this.held) return;
    const from = this.held.at.clone().applyMatrix4(this.held.matrix); // the matrix follows the body
    this.line.geometry.dispose();
    this.line.geometry = new THREE.BufferGeometry().setFromPoints([from, this.held.to]);
    this.line.visible = true;
    this.view.dirty = true;
  }
}
