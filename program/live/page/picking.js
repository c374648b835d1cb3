// What a click means: a link or another object of a part, a part, a sensor, the beam of a scan, the pixel of a camera. Each is an object that can be selected:
// { kind, name }, with `hit` or `read()` for the facts that the selection panel shows, `place()` for its mark, and `link`
// for the link of the page if kind and name do not say all.
import { NO_WHOLE, isWhole, short } from "simvis/color_ramp.js";
import { rayBetween, rayOfPixel } from "simvis/sensor_shapes.js";

const POINT_REACH_PX = 6, // a click so near to a point of a scan means its beam
  POINT_BEHIND_M = 0.05, // unless something stands so far in front of it
  RANGE_DIGITS = 5,
  SAME_PLACE_M = 0.05; // what is drawn so near to where a beam ends is what the beam met

const placeText = (point) => `${[...point].map((value) => value.toFixed(3)).join(", ")} m`;

/** Where the point of a beam is in the world. */
function pointOf({ points, world_from_sensor: w }, beam) {
  const [x, y, z] = points.subarray(3 * beam, 3 * beam + 3);
  return [0, 4, 8].map((row) => w[row] * x + w[row + 1] * y + w[row + 2] * z + w[row + 3]);
}

const originOf = ({ world_from_sensor: w }) => [w[3], w[7], w[11]];

/** In degrees, from the point in the sensor's frame. */
function anglesOf({ points }, beam) {
  const [x, y, z] = points.subarray(3 * beam, 3 * beam + 3),
    degrees = (radians) => `${(Math.round((radians * 18000) / Math.PI) / 100 + 0).toFixed(2)}°`;
  return `${degrees(Math.atan2(y, x))}, ${degrees(Math.atan2(z, Math.hypot(x, y)))}`;
}

export class Picking {
  /** `sceneOf()` gives the scene, `objectsOf()` its Objects, `rowsOf(transform)` the rows of a transform. */
  constructor({ view, shapes, scans, names, images, sceneOf, objectsOf, rowsOf }) {
    Object.assign(this, { view, shapes, scans, names, images, sceneOf, objectsOf, rowsOf });
  }

  /** The object under a click; null: nothing. `hit` is what view.pick() says. */
  thingOf(hit, event) {
    const beam = this.beamUnder(hit, event);
    if (beam || !hit) return beam;
    if (hit.sensor) return { kind: "sensor", name: hit.sensor };
    const { kind, name } = this.objectsOf().listedAt(hit.item.point) ?? { kind: "part", name: hit.item.part };
    return { kind, name, hit: this.factsOf(hit, "the eye"), place: () => hit.point };
  }

  /** Facts of what was hit in the view or in a picture. */
  factsOf({ item, point, distance_m }, from) {
    return [
      ["object", this.objectsOf().listedAt(item.point)?.path],
      ["shape", this.names.meshOf(item.item)],
      ["label", this.names.labelOf(item.item)],
      [`from ${from}`, `${short(distance_m)} m`, distance_m],
      ["at", placeText(point)],
    ];
  }

  beamUnder(hit, event) {
    const area = this.view.canvas.getBoundingClientRect();
    let nearest = null;
    for (const [name, shape] of this.shapes) {
      const found = shape.beamAt(event.clientX - area.left, event.clientY - area.top, POINT_REACH_PX);
      if (found && (!nearest || found.distance_m < nearest.distance_m)) nearest = { ...found, name };
    }
    if (!nearest || (hit && hit.distance_m < nearest.distance_m - POINT_BEHIND_M)) return null;
    return this.beamOf(nearest.name, nearest.beam);
  }

  /** A beam, with what it measures in each scan. */
  beamOf(name, beam) {
    const sensor = this.sceneOf().sensors.findIndex((each) => each.name === name);
    const place = () => {
      const point = this.scans.has(sensor) ? pointOf(this.scans.get(sensor), beam) : [NaN];
      return point.every(Number.isFinite) ? point : null;
    };
    const read = () => this.readBeam(this.scans.get(sensor), beam);
    return { kind: "beam", name, link: `beam:${name}:${beam}`, read, place };
  }

  readBeam(scan, beam) {
    if (!scan) return [["state", "not measured"]];
    if (beam >= scan.rings * scan.beams) return [["state", "the scan has no such beam"]];
    const bound = scan.columns.get("error_bound_m")?.values[beam],
      range = scan.columns.get("range_m").values[beam];
    const rest = [...scan.columns].filter(([column]) => column !== "range_m" && column !== "error_bound_m");
    return [
      ["ring, beam", `${Math.floor(beam / scan.beams)}, ${beam % scan.beams}`],
      ["azimuth, elevation", Number.isFinite(range) ? anglesOf(scan, beam) : null],
      ["range", Number.isFinite(range) ? `${short(range, RANGE_DIGITS)} m` : short(range), range],
      ["true range within", bound === undefined ? null : `± ${bound.toExponential(2)} m`, bound],
      ...rest.map(([column, { unit, type, values }]) => [
        column,
        this.textOf(column, unit, type, values[beam]),
        values[beam],
      ]),
      ["at", Number.isFinite(range) ? placeText(pointOf(scan, beam)) : null],
      ["part", this.partAt(scan, beam)],
    ];
  }

  /** The part that the page draws where a beam ends; null: none. */
  partAt(scan, beam) {
    const hit = this.view.pickItem(rayBetween(originOf(scan), pointOf(scan, beam)));
    const range = scan.columns.get("range_m").values[beam];
    return hit && Math.abs(hit.distance_m - range) < SAME_PLACE_M ? hit.item.part : null;
  }

  textOf(output, unit, type, value) {
    if (!isWhole(type)) return `${short(value)} ${unit}`;
    return value === NO_WHOLE ? "–" : `${value} ${this.names.of(output, value)}`;
  }

  /** A pixel of a camera: what its images have there, and the part that a ray through it meets. */
  pixelOf(name, x, y) {
    const sensor = this.sceneOf().sensors.find((each) => each.name === name),
      size = this.images.sizeOf(name);
    let met = null;
    const read = () => {
      const ray = size && sensor.transform !== null && rayOfPixel(sensor, this.rowsOf(sensor.transform), size, x, y);
      met = ray ? this.view.pickItem(ray) : null;
      return [
        ["pixel", `${x}, ${y}`],
        ...this.images.factsAt(name, x, y),
        ...(met ? [["part", met.item.part], ...this.factsOf(met, "the camera")] : []),
      ];
    };
    return { kind: "pixel", name, link: `pixel:${name}:${x},${y}`, read, place: () => met?.point ?? null };
  }

  /** Returns the object that a link names, or null. */
  thingOfLink(text) {
    const [, kind, name, rest] = /^(\w+):(.*?)(?::(\d+(?:,\d+)?))?$/s.exec(text) ?? [],
      numbers = (rest ?? "").split(",").map(Number);
    const { list, sensors } = this.sceneOf();
    if (kind === "beam" || kind === "pixel") {
      if (!rest || !sensors.some((each) => each.name === name)) return null;
      return kind === "beam" ? this.beamOf(name, numbers[0]) : this.pixelOf(name, numbers[0], numbers[1]);
    }
    const whole = text.slice(kind?.length + 1),
      object = this.objectsOf().byName.get(whole);
    if (object && kind !== "part" && object.kind === kind) return { kind, name: whole };
    return (list[`${kind}s`] ?? []).some((each) => each.name === whole) ? { kind, name: whole } : null;
  }
}
