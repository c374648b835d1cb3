// The scene in three dimensions: what the GLB holds, moved by transforms; lights; picking. SimVis has z up, and so has
// three.js here.
import * as THREE from "three";
import { GLTFLoader } from "simvis/GLTFLoader.js";

const LEAST_INSTANCES = 16; // from so many equal items on, one draw call shows all
const PICK_RADIUS_PX = 4; // the pointer may move so far in a click
// Ambient light from this side is that of the scene, and from the other side this share of it: so walls, floor and ceiling
// of one colour differ where they meet.
const SKY_SIDE = [0.45, 0.25, 0.85],
  GROUND_SHARE = 0.4;
const NOWHERE = new THREE.Matrix4().makeScale(0, 0, 0); // an instance that is not drawn
const FRONT_M = 1; // what is so near to a robot's sensors is of the robot itself, and is still drawn in front of it
const ROOM_RAYS = 12, // around a robot, to find the walls of its room
  ROOM_SLOPE = 0.25, // of these rays, so that they pass above furniture
  ROOM_WINDOW = 3, // a ray so much longer than the median has left the room
  ROOM_INSIDE = 0.9, // so far along a ray, the floor is searched below it
  WALL_M = 0.5, // thickness of its walls
  CEILING_M = 0.1; // so far below the ceiling it is cut

/** 12 numbers, the upper rows of a matrix. */
export function toMatrix(rows, matrix = new THREE.Matrix4()) {
  const [a, b, c, d, e, f, g, h, i, j, k, l] = rows;
  return matrix.set(a, b, c, d, e, f, g, h, i, j, k, l, 0, 0, 0, 1);
}

/** The same without scale. */
export function toRigid(rows) {
  const position = new THREE.Vector3(),
    rotation = new THREE.Quaternion(),
    scale = new THREE.Vector3();
  toMatrix(rows).decompose(position, rotation, scale);
  return new THREE.Matrix4().compose(position, rotation, new THREE.Vector3(1, 1, 1));
}

export class SceneView {
  constructor(canvas) {
    this.canvas = canvas;
    // Without alpha: opaque surfaces whose colour has one would show the page behind the canvas.
    const context = canvas.getContext("webgl2", { antialias: true, alpha: false });
    this.renderer = new THREE.WebGLRenderer(context ? { canvas, context } : { canvas, antialias: true });
    this.renderer.gammaOutput = true;
    this.renderer.gammaFactor = 2.2;
    this.renderer.physicallyCorrectLights = true;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(50, 1, 0.02, 2000);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(6, -6, 5);
    this.items = new THREE.Group();
    this.lights = new THREE.Group();
    this.overlay = new THREE.Group(); // gizmos and scans
    this.ambient = new THREE.HemisphereLight(0xffffff, 0xffffff, 1);
    this.ambient.position.set(...SKY_SIDE);
    this.marks = new THREE.Group(); // around what is selected
    this.spot = new THREE.Points(
      new THREE.BufferGeometry(),
      new THREE.PointsMaterial({
        size: 13,
        sizeAttenuation: false,
        depthTest: false,
        transparent: true,
        opacity: 0.85,
      }),
    ); // a point that is selected
    this.spot.visible = false;
    this.spot.frustumCulled = false;
    this.spot.renderOrder = 2;
    this.cut = new THREE.Plane(new THREE.Vector3(0, 0, -1), Infinity);
    this.front = new THREE.Plane(); // what lies before it is not drawn
    this.frontOf = null; // () => a point that nothing hides, or null
    this.scene.add(this.items, this.lights, this.overlay, this.marks, this.spot, this.ambient);
    this.byTransform = new Map(); // index: what follows it
    this.materials = []; // by index in the draw list
    this.meshes = new Map(); // index in the draw list: geometries
    this.undeformed = new Map(); // attribute: its numbers in the GLB
    this.onFrame = []; // called before each picture
    this.onDraw = []; // called when one is drawn
    this.dirty = true;
    new ResizeObserver(() => this.resize()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.followTheme());
    this.followTheme();
    this.resize();
    const draw = () => {
      requestAnimationFrame(draw);
      for (const call of this.onFrame) call();
      if (!this.dirty) return;
      this.dirty = false;
      this.placeCuts();
      this.renderer.render(this.scene, this.camera);
      for (const call of this.onDraw) call();
    };
    draw();
  }

  followTheme() {
    const style = getComputedStyle(document.documentElement);
    this.scene.background = new THREE.Color(style.getPropertyValue("--scene").trim());
    this.dirty = true;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(window.devicePixelRatio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }

  /** Shows the scene of a GLB. Resolves when it is there. */
  async load(bytes, { list }) {
    const gltf = await new Promise((resolve, reject) => new GLTFLoader().parse(bytes, "", resolve, reject));
    while (this.items.children.length > 0) this.items.remove(this.items.children[0]);
    this.byTransform.clear();
    this.materials = [];
    this.meshes.clear();
    this.undeformed.clear();
    const owners = new Map(
      list.parts.flatMap(({ name, insertion_points }) => [name, ...insertion_points].map((point) => [point, name])),
    );
    const groups = new Map();
    gltf.scene.updateMatrixWorld(true);
    const back = new THREE.Matrix4().set(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1); // z up again
    gltf.scene.traverse((node) => {
      if (node.userData.item === undefined || !node.geometry) return;
      const key = `${node.geometry.uuid} ${node.material.uuid}`;
      const matrix = new THREE.Matrix4().multiplyMatrices(back, node.matrixWorld);
      if (!groups.has(key)) groups.set(key, { node, all: [] });
      groups
        .get(key)
        .all.push({
          ...node.userData,
          part: owners.get(node.userData.part) ?? "ROOT",
          point: node.userData.part,
          matrix,
        });
      (this.materials[node.userData.material] ??= new Set()).add(node.material);
      const { mesh } = node.userData;
      this.meshes.set(mesh, (this.meshes.get(mesh) ?? new Set()).add(node.geometry));
    });
    for (const { node, all } of groups.values()) this.addItems(node, all);
    this.dirty = true;
  }

  addItems(node, all) {
    const { geometry, material } = node;
    if (material.normalMap) material.normalMap.encoding = THREE.LinearEncoding;
    if (node.isMesh && all.length >= LEAST_INSTANCES && all.every(({ matrix }) => matrix.determinant() > 0)) {
      const mesh = new THREE.InstancedMesh(geometry, material, all.length);
      mesh.frustumCulled = false;
      mesh.userData.all = all;
      all.forEach((item, i) => {
        mesh.setMatrixAt(i, item.matrix);
        this.follow(item.transform, (matrix) => {
          item.matrix.copy(matrix);
          if (!item.hidden) mesh.setMatrixAt(i, matrix);
          mesh.instanceMatrix.needsUpdate = true;
        });
      });
      this.items.add(mesh);
      return;
    }
    for (const item of all) {
      const shape = node.isPoints
        ? new THREE.Points(geometry, material)
        : node.isLine
          ? new THREE.LineSegments(geometry, material)
          : new THREE.Mesh(geometry, material);
      shape.matrixAutoUpdate = false;
      shape.matrix.copy(item.matrix);
      shape.userData.all = [item];
      this.follow(item.transform, (matrix) => {
        item.matrix.copy(matrix);
        shape.matrix.copy(matrix);
        shape.matrixWorldNeedsUpdate = true;
      });
      this.items.add(shape);
    }
  }

  follow(transform, move) {
    if (!this.byTransform.has(transform)) this.byTransform.set(transform, []);
    this.byTransform.get(transform).push(move);
  }

  move(transforms) {
    const matrix = new THREE.Matrix4();
    for (const [index, rows] of transforms) {
      const movers = this.byTransform.get(index);
      if (!movers) continue;
      toMatrix(rows, matrix);
      for (const move of movers) move(matrix);
    }
    this.dirty = true;
  }

  paint(materials) {
    for (const [index, r, g, b, a, er, eg, eb, roughness, metallic] of materials) {
      for (const material of this.materials[index] ?? []) {
        material.color?.setRGB(r, g, b);
        material.emissive?.setRGB(er, eg, eb);
        material.opacity = a;
        material.userData.blends ??= material.transparent;
        material.transparent = material.userData.blends || a < 1;
        if (material.roughness !== undefined) Object.assign(material, { roughness, metalness: metallic });
      }
    }
    this.dirty = true;
  }

  /** Gives these meshes other positions and normals, and all others those of the GLB. */
  reshape(shapes) {
    const deformed = new Map(shapes.map((each) => [each.mesh, each]));
    for (const [mesh, geometries] of this.meshes) for (const each of geometries) this.deform(each, deformed.get(mesh));
    this.dirty = true;
  }

  deform(geometry, shape) {
    for (const name of ["position", "normal"]) {
      const attribute = geometry.attributes[name],
        own = this.undeformed.get(attribute);
      if (!shape && !own) continue;
      if (!own) this.undeformed.set(attribute, attribute.array.slice());
      attribute.array.set(shape?.[name] ?? own);
      attribute.needsUpdate = true;
      geometry.boundingBox = geometry.boundingSphere = null; // three.js computes them when it needs them
    }
  }

  /** The colour behind the scene is that of the page: the background of a scene is for its cameras. */
  surround({ ambient }) {
    this.ambient.color.setRGB(...ambient);
    this.ambient.groundColor.setRGB(...ambient.map((value) => value * GROUND_SHARE));
    this.ambient.intensity = Math.PI; // ambient radiance from all sides, as SimVis has it
    this.dirty = true;
  }

  /** Shows all items but these. */
  hide(items) {
    for (const shape of this.items.children) {
      shape.userData.all.forEach((item, i) => {
        item.hidden = items.has(item.item);
        if (!shape.isInstancedMesh) shape.visible = !item.hidden;
        else shape.setMatrixAt(i, item.hidden ? NOWHERE : item.matrix);
      });
      if (shape.isInstancedMesh) shape.instanceMatrix.needsUpdate = true;
    }
    this.dirty = true;
  }

  /** `rowsOf` gives the rows of a transform by its index. */
  light(lights, rowsOf) {
    while (this.lights.children.length > 0) this.lights.remove(this.lights.children[0]);
    for (const each of lights) {
      const world = toRigid(rowsOf(each.transform) ?? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]);
      const color = new THREE.Color().setRGB(...each.color);
      const place = new THREE.Vector3().setFromMatrixPosition(world);
      const along = new THREE.Vector3(...each.direction).transformDirection(world);
      const light =
        each.kind === "point"
          ? new THREE.PointLight(color, each.intensity, each.range_m, 2)
          : each.kind === "spot"
            ? new THREE.SpotLight(
                color,
                each.intensity,
                each.range_m,
                each.outer_cone_rad,
                1 - each.inner_cone_rad / each.outer_cone_rad,
                2,
              )
            : new THREE.DirectionalLight(color, each.intensity);
      if (each.kind === "directional") {
        light.position.copy(along).multiplyScalar(-100);
        light.target.position.set(0, 0, 0);
      } else {
        light.position.copy(place);
        if (light.target) light.target.position.copy(place).add(along);
      }
      this.lights.add(light);
      if (light.target) this.lights.add(light.target);
    }
    this.dirty = true;
  }

  /** The box around all items, or those that `wanted` says. */
  box(wanted = () => true) {
    const box = new THREE.Box3(),
      one = new THREE.Box3();
    for (const shape of this.items.children) {
      if (!shape.geometry.boundingBox) shape.geometry.computeBoundingBox();
      for (const item of shape.userData.all) {
        if (wanted(item) && !item.hidden) box.union(one.copy(shape.geometry.boundingBox).applyMatrix4(item.matrix));
      }
    }
    return box;
  }

  /** Draws boxes around the items that `wanted` says. */
  mark(wanted) {
    while (this.marks.children.length > 0) this.marks.remove(this.marks.children[0]);
    if (wanted) {
      const color = new THREE.Color(getComputedStyle(document.documentElement).getPropertyValue("--accent").trim());
      const box = this.box(wanted);
      if (!box.isEmpty()) this.marks.add(new THREE.Box3Helper(box, color));
    }
    this.dirty = true;
  }

  /** How far it is from a point, in a direction, to the first object beyond `from` metres that the planes do not cut. */
  freeReach(point, direction, from, planes = []) {
    return this.firstHit(new THREE.Raycaster(point, direction, from), [], planes)?.distance ?? Infinity;
  }

  /** A box of 2 m around what these rows place. */
  boxAround(rows) {
    return new THREE.Box3().setFromCenterAndSize(
      new THREE.Vector3(rows[3], rows[7], rows[11]),
      new THREE.Vector3(2, 2, 2),
    );
  }

  showGrid(on) {
    if (!this.grid) {
      this.grid = new THREE.GridHelper(100, 100, 0x7f8896, 0x7f8896);
      this.grid.rotation.x = Math.PI / 2;
      this.grid.material.transparent = true;
      this.grid.material.opacity = 0.35;
      this.scene.add(this.grid);
    }
    this.grid.visible = on;
    this.dirty = true;
  }

  /** Nothing is drawn above this share of the scene's height; 1: all is drawn. */
  cutAbove(share) {
    const { min, max } = this.box();
    this.cut.constant = share >= 1 ? Infinity : min.z + share * (max.z - min.z);
    this.dirty = true;
  }

  /** The share of the scene's height at which a place is. */
  shareOfHeight(height_m) {
    const { min, max } = this.box();
    return (height_m - min.z) / (max.z - min.z);
  }

  /**
   * The closed room around a robot: its `box` and the height of its `ceiling_m`; null: no ceiling. Most rays from the
   * robot end at the room's walls: those that go much farther than others leave it by a window.
   */
  roomAround(place) {
    const from = new THREE.Vector3(...place),
      up = this.freeReach(from, new THREE.Vector3(0, 0, 1), FRONT_M);
    if (up === Infinity) return null;
    const ends = [];
    for (let i = 0; i < ROOM_RAYS; ++i) {
      const turn = (2 * Math.PI * i) / ROOM_RAYS;
      const direction = new THREE.Vector3(Math.cos(turn), Math.sin(turn), ROOM_SLOPE).normalize();
      ends.push({ direction, reach: this.freeReach(from, direction, FRONT_M) });
    }
    const median = ends.map(({ reach }) => reach).sort((a, b) => a - b)[ROOM_RAYS / 2],
      box = new THREE.Box3().setFromPoints([from, from.clone().add(new THREE.Vector3(0, 0, up))]);
    const down = new THREE.Vector3(0, 0, -1);
    for (const { direction, reach } of ends) {
      if (reach >= ROOM_WINDOW * median) continue;
      const inside = from.clone().addScaledVector(direction, ROOM_INSIDE * reach),
        floor = this.freeReach(inside, down, 0);
      box.expandByPoint(from.clone().addScaledVector(direction, reach));
      if (floor < Infinity) box.expandByPoint(inside.addScaledVector(down, floor));
    }
    const ceiling_m = box.max.z - CEILING_M;
    return { box: box.expandByScalar(WALL_M), ceiling_m };
  }

  /** From now on, nothing is drawn in front of a point; `place` gives it, or null. */
  setFront(place) {
    this.frontOf = place;
    this.dirty = true;
  }

  placeCuts() {
    const planes = Number.isFinite(this.cut.constant) ? [this.cut] : [],
      place = this.frontOf?.();
    if (place) {
      const ahead = this.camera.getWorldDirection(new THREE.Vector3());
      this.front.setFromNormalAndCoplanarPoint(ahead, new THREE.Vector3(...place).addScaledVector(ahead, -FRONT_M));
      planes.push(this.front);
    }
    this.renderer.clippingPlanes = planes;
  }

  /** Whether something is drawn between the camera and a point. */
  hides(place) {
    const to = new THREE.Vector3(...place).sub(this.camera.position),
      distance = to.length() - FRONT_M;
    return this.freeReach(this.camera.position, to.normalize(), 0, [this.cut]) < distance;
  }

  /** Marks a point of the world; null: none. */
  markPoint(place) {
    this.spot.visible = Boolean(place);
    if (place) {
      this.spot.geometry.setAttribute("position", new THREE.Float32BufferAttribute(place, 3));
      this.spot.material.color.set(getComputedStyle(document.documentElement).getPropertyValue("--accent").trim());
    }
    this.dirty = true;
  }

  /** What lies below a place of the window: { item, point, distance_m } or { sensor, distance_m }, or null. */
  pick(event) {
    return this.pickAlong(this.rayOf(event), this.renderer.clippingPlanes);
  }

  /** The ray of three.js through a place of the window. */
  rayOf(event) {
    const area = this.canvas.getBoundingClientRect();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(
      { x: (2 * (event.clientX - area.left)) / area.width - 1, y: 1 - (2 * (event.clientY - area.top)) / area.height },
      this.camera,
    );
    return ray;
  }

  /** What a ray of three.js meets first behind all of the planes. */
  pickAlong(ray, planes) {
    const handles = this.overlay.children.map((each) => each.userData.handle).filter(Boolean);
    const hit = this.firstHit(ray, handles, planes);
    if (!hit?.object.userData.sensor) return hit && this.itemOf(hit);
    return { sensor: hit.object.userData.sensor, distance_m: hit.distance };
  }

  /** The item that a ray of three.js meets first; null: none. */
  pickItem(ray) {
    const hit = this.firstHit(ray, [], []);
    return hit && this.itemOf(hit);
  }

  firstHit(ray, handles, planes) {
    for (const shape of this.items.children) shape.updateMatrixWorld();
    const hits = ray.intersectObjects([...handles, ...this.items.children.filter((each) => each.isMesh && each.visible)]);
    return hits.find(({ point }) => planes.every((plane) => plane.distanceToPoint(point) >= 0)) ?? null;
  }

  itemOf({ object, instanceId, point, distance }) {
    return { item: object.userData.all[instanceId ?? 0], point: point.toArray(), distance_m: distance };
  }

  /** Calls `chosen` with what pick() says, and the event, at each click that is no drag. */
  onClick(chosen) {
    let down = null;
    this.canvas.addEventListener("pointerdown", (event) => {
      down = event;
    });
    this.canvas.addEventListener("pointerup", (event) => {
      if (!down || event.button !== 0) return;
      if (Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < PICK_RADIUS_PX)
        chosen(this.pick(event), event);
    });
  }
}
