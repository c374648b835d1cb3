// The messages of `simvis.live.v1`, read from text or from bytes that begin at a multiple of 8.

const DECODERS = { 1: decodeTransforms, 2: decodeScan, 3: decodeImage, 4: decodePhysics, 5: decodeShapes };
const ARRAYS = { f32: Float32Array, f64: Float64Array, u8: Uint8Array, u32: Uint32Array, i32: Int32Array };

/** `data` is a text, or an ArrayBuffer; `start` and `length` say where the message lies in it. */
export function decode(data, start = 0, length = data.byteLength - start) {
  if (typeof data === "string") return JSON.parse(data);
  const view = new DataView(data, start, length);
  const decoder = DECODERS[view.getUint8(0)];
  if (!decoder) throw new Error(`a message of unknown kind ${view.getUint8(0)}`);
  return decoder(view, data, start, length);
}

function decodeTransforms(view, data, start) {
  const count = Number(view.getBigUint64(16, true));
  const transforms = [];
  for (let i = 0; i < count; ++i) {
    const place = start + 24 + i * 104;
    const index = Number(view.getBigUint64(place - start, true));
    transforms.push([index, new Float64Array(data, place + 8, 12)]);
  }
  return { op: "transforms", transforms };
}

/** What the message says of its numbers, and where these begin. */
function description(view, data, start, place) {
  const length = view.getUint32(place, true),
    text = new TextDecoder().decode(new Uint8Array(data, start + place + 8, length));
  return [JSON.parse(text), start + place + 8 + length];
}

function decodeScan(view, data, start) {
  const rings = view.getUint32(112, true),
    beams = view.getUint32(116, true),
    count = rings * beams,
    [{ columns, origins }, first] = description(view, data, start, 120);
  const numbers = (column, size, type = "f32") => new ARRAYS[type](data, first + 4 * count * column, size);
  return {
    op: "scan",
    sensor: view.getUint32(4, true),
    rings,
    beams,
    world_from_sensor: new Float64Array(data, start + 16, 12),
    columns: new Map(columns.map(([name, unit, type], i) => [name, { unit, type, values: numbers(i, count, type) }])),
    points: numbers(columns.length, 3 * count),
    origins: origins ? numbers(columns.length + 3, 3 * count) : null, // where beams start; null: at the sensor
  };
}

function decodeShapes(view, data, start) {
  const shapes = [];
  let place = 8;
  while (shapes.length < view.getUint32(4, true)) {
    const count = 3 * view.getUint32(place + 4, true),
      first = start + place + 8;
    shapes.push({
      mesh: view.getUint32(place, true),
      position: new Float32Array(data, first, count),
      normal: new Float32Array(data, first + 4 * count, count),
    });
    place += 8 + 8 * count;
  }
  return { op: "shapes", shapes };
}

function decodePhysics(view, data, start) {
  const bodies = view.getUint32(4, true),
    count = Number(view.getBigUint64(16, true)),
    first = 24 + bodies * 96;
  const poses = Array.from({ length: bodies }, (_, i) => new Float64Array(data, start + 24 + i * 96, 12));
  const contacts = Array.from({ length: count }, (_, i) => {
    const place = first + i * 72,
      [x, y, z, nx, ny, nz, depth_m, force_n] = new Float64Array(data, start + place, 8);
    const [a, b] = [view.getUint32(place + 64, true), view.getUint32(place + 68, true)];
    return { point: [x, y, z], normal: [nx, ny, nz], depth_m, force_n, a, b };
  });
  return { op: "physics", poses, contacts };
}

function decodeImage(view, data, start, length) {
  const [described, first] = description(view, data, start, 16),
    image = { op: "image", sensor: view.getUint32(4, true), ...described };
  if (image.form === "png") return { ...image, png: new Uint8Array(data, first, start + length - first) };
  return { ...image, values: new ARRAYS[image.form](data, first, image.width * image.height * image.channels) };
}
