// The messages of `simvis.live.v1`, read from text or from bytes that begin at a multiple of 8.

const DECODERS = { 1: decodeTransforms, 2: decodeScan, 3: decodePicture };
export const PICTURE_KINDS = ["colour", "depth", "disparity"];
export const EYES = ["", "left", "right"];

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

function decodeScan(view, data, start) {
  const rings = view.getUint32(112, true), beams = view.getUint32(116, true), count = rings * beams;
  const floats = (first, size) => new Float32Array(data, start + 120 + 4 * first, size);
  return {
    op: "scan", sensor: view.getUint32(4, true), rings, beams,
    world_from_sensor: new Float64Array(data, start + 16, 12),
    range: floats(0, count), intensity: floats(count, count), bound: floats(2 * count, count),
    points: floats(3 * count, 3 * count),
  };
}

function decodePicture(view, data, start, length) {
  const kind = PICTURE_KINDS[view.getUint8(1)];
  const picture = {
    op: "picture", kind, eye: EYES[view.getUint8(2)], sensor: view.getUint32(4, true),
    width: view.getUint32(16, true), height: view.getUint32(20, true),
  };
  if (kind === "colour") return { ...picture, png: new Uint8Array(data, start + 24, length - 24) };
  return { ...picture, values: new Float32Array(data, start + 24, picture.width * picture.height) };
}
