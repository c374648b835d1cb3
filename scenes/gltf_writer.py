"""Writes glTF 2.0 binary files (.glb) with embedded PNG textures, with the Python standard library alone.

Models are built z up (x forward, y left, metres) and written y up, as glTF asks: (x, y, z) becomes (x, z, -y). The
importer turns them back. The same model gives the same file; only the compressed bytes of the pictures depend on the
version of zlib, so `content` gives what a file holds with its pictures unpacked, for comparisons.
"""
import json
import math
import struct
import zlib
from dataclasses import dataclass


@dataclass(frozen=True, eq=False)
class Texture:
    """8-bit pixels, rows from the top: palette indices where there is a palette, else grey (1) or RGB (3 bytes)."""
    name: str
    width: int
    height: int
    pixels: bytes
    palette: tuple = ()  # of (r, g, b), 0 to 255
    clamp: bool = False  # a picture that is not repeated


@dataclass(frozen=True, eq=False)
class Material:
    name: str
    color: tuple = (1.0, 1.0, 1.0, 1.0)  # linear RGBA, multiplies the texture
    texture: Texture = None
    tile_m: tuple = (1.0, 1.0)  # a texture's width and height on the surface; (1, 1) for 0..1 coordinates
    emissive: tuple = (0.0, 0.0, 0.0)
    roughness: float = 0.8
    metallic: float = 0.0
    normals: Texture = None  # a normal map, on the same coordinates as the texture
    blend: bool = False
    double_sided: bool = False
    unlit: bool = False


@dataclass(frozen=True)
class Light:
    """A light at a place. `direction` is the way it travels, in the model's z-up frame."""
    name: str
    kind: str  # directional, point or spot
    intensity: float  # lux (directional) or candela
    color: tuple = (1.0, 1.0, 1.0)
    position: tuple = (0.0, 0.0, 0.0)
    direction: tuple = (0.0, 0.0, -1.0)
    inner_cone_rad: float = 0.0
    outer_cone_rad: float = 0.785


def linear(hex_color, alpha=1.0):
    """Linear RGBA of an sRGB colour written "#rrggbb"."""
    channels = [int(hex_color[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    return tuple(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels) + (alpha,)


def png(texture):
    """The texture as a PNG file."""
    channels = 1 if texture.palette else len(texture.pixels) // (texture.width * texture.height)
    row_bytes = texture.width * channels
    rows, above = [], bytes(row_bytes)
    for y in range(texture.height):
        row = texture.pixels[y * row_bytes:(y + 1) * row_bytes]
        left = bytes(channels) + row[:-channels]
        # Filters 0 (none), 1 (the pixel to the left) and 2 (the pixel above): the one with the smallest residues.
        choices = [(0, row), (1, bytes((a - b) & 255 for a, b in zip(row, left))),
                   (2, bytes((a - b) & 255 for a, b in zip(row, above)))]
        if texture.palette:
            choices = choices[:1]
        kind, filtered = min(choices, key=lambda c: sum(v if v < 128 else 256 - v for v in c[1]))
        rows.append(bytes([kind]) + filtered)
        above = row
    color_type = 3 if texture.palette else {1: 0, 3: 2}[channels]
    header = struct.pack(">IIBBBBB", texture.width, texture.height, 8, color_type, 0, 0, 0)
    chunks = [(b"IHDR", header)]
    if texture.palette:
        chunks.append((b"PLTE", bytes(v for entry in texture.palette for v in entry)))
    chunks += [(b"IDAT", zlib.compress(b"".join(rows), 9)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in chunks)


def _y_up(v):
    return (v[0], v[2], -v[1] + 0.0)


def _turn_from_minus_z(direction):
    """The quaternion (x, y, z, w) that turns a light's own -z to `direction` (y up, unit length)."""
    x, y, z = direction
    if z > 1 - 1e-9:
        return [0.0, 1.0, 0.0, 0.0]
    w = 1 - z
    length = math.sqrt(x * x + y * y + w * w)
    return [round(v / length, 9) + 0.0 for v in (y, -x, 0.0, w)]


class _File:
    """A glTF document under construction: its JSON and its one buffer."""

    def __init__(self, name):
        self.json = {"asset": {"version": "2.0", "generator": "SimVis scenes/gltf_writer.py"}, "scene": 0,
                     "scenes": [{"name": name, "nodes": []}], "nodes": [], "meshes": [], "materials": [],
                     "accessors": [], "bufferViews": [], "buffers": [{"byteLength": 0}]}
        self.blob = bytearray()
        self.extensions = set()

    def view(self, data, target=None):
        self.blob += bytes(-len(self.blob) % 4)
        view = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data)}
        if target:
            view["target"] = target
        self.blob += data
        self.json["bufferViews"].append(view)
        return len(self.json["bufferViews"]) - 1

    def accessor(self, values, components, bounds=False):
        accessor = {"componentType": 5126, "count": len(values), "type": {2: "VEC2", 3: "VEC3"}[components]}
        flat = [v for value in values for v in value]
        data = struct.pack(f"<{len(flat)}f", *flat)
        if bounds:
            flat = struct.unpack(f"<{len(flat)}f", data)
            accessor["min"] = [min(flat[i::components]) for i in range(components)]
            accessor["max"] = [max(flat[i::components]) for i in range(components)]
        accessor["bufferView"] = self.view(data, 34962)
        self.json["accessors"].append(accessor)
        return len(self.json["accessors"]) - 1

    def indices(self, values, count):
        kind, letter = (5123, "H") if count < 65536 else (5125, "I")
        view = self.view(struct.pack(f"<{len(values)}{letter}", *values), 34963)
        self.json["accessors"].append(
            {"bufferView": view, "componentType": kind, "count": len(values), "type": "SCALAR"})
        return len(self.json["accessors"]) - 1

    def node(self, **fields):
        self.json["nodes"].append(fields)
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)

    def material(self, material, textures):
        surface = {"baseColorFactor": [round(v, 6) for v in material.color], "metallicFactor": material.metallic,
                   "roughnessFactor": material.roughness}
        if material.texture:
            surface["baseColorTexture"] = {"index": textures.index(material.texture)}
        entry = {"name": material.name, "pbrMetallicRoughness": surface}
        if material.normals:
            entry["normalTexture"] = {"index": textures.index(material.normals)}
        if any(material.emissive):
            entry["emissiveFactor"] = list(material.emissive)
        if material.blend:
            entry["alphaMode"] = "BLEND"
        if material.double_sided:
            entry["doubleSided"] = True
        if material.unlit:
            entry["extensions"] = {"KHR_materials_unlit": {}}
            self.extensions.add("KHR_materials_unlit")
        self.json["materials"].append(entry)

    def bytes(self):
        self.blob += bytes(-len(self.blob) % 4)
        self.json["buffers"][0]["byteLength"] = len(self.blob)
        if self.extensions:
            self.json["extensionsUsed"] = sorted(self.extensions)
        text = json.dumps({k: v for k, v in self.json.items() if v}, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        total = 12 + 8 + len(text) + 8 + len(self.blob)
        return (struct.pack("<4sII", b"glTF", 2, total) + struct.pack("<I4s", len(text), b"JSON") + text +
                struct.pack("<I4s", len(self.blob), b"BIN\0") + bytes(self.blob))


def _indexed(faces, material):
    """Faces as vertex tables without repetition, and indices into them. Vertices are compared as float32."""
    known, vertices, indices = {}, [], []
    tile_u, tile_v = material.tile_m
    for points, normals, uvs in faces:
        for point, normal, uv in zip(points, normals, uvs):
            vertex = (*_y_up(point), *_y_up(normal), uv[0] / tile_u, uv[1] / tile_v)
            key = struct.pack("<8f", *(round(v, 6) + 0.0 for v in vertex))
            if key not in known:
                known[key] = len(vertices)
                vertices.append(struct.unpack("<8f", key))
            indices.append(known[key])
    return vertices, indices


def glb(name, faces_by_material, lights=()):
    """A .glb file: one node with one primitive per material, and a node per light.

    `faces_by_material` maps a Material to triangles (points, normals, uvs), each three, counter-clockwise from outside;
    uvs in metres on the surface, divided here by the material's tile.
    """
    file = _File(name)
    primitives, textures = [], []
    for index, (material, faces) in enumerate(faces_by_material.items()):
        vertices, indices = _indexed(faces, material)
        attributes = {"POSITION": file.accessor([v[:3] for v in vertices], 3, bounds=True),
                      "NORMAL": file.accessor([v[3:6] for v in vertices], 3)}
        shown = [texture for texture in (material.texture, material.normals) if texture]
        if shown:
            attributes["TEXCOORD_0"] = file.accessor([v[6:] for v in vertices], 2)
            textures += [texture for texture in shown if texture not in textures]
        primitives.append({"attributes": attributes, "indices": file.indices(indices, len(vertices)),
                           "material": index})
        file.material(material, textures)
    file.json["meshes"].append({"name": name, "primitives": primitives})
    file.node(name=name, mesh=0)
    _add_lights(file, lights)
    _add_textures(file, textures)
    return file.bytes()


def _add_lights(file, lights):
    if not lights:
        return
    entries = []
    for index, light in enumerate(lights):
        entry = {"name": light.name, "type": light.kind, "color": list(light.color), "intensity": light.intensity}
        if light.kind == "spot":
            entry["spot"] = {"innerConeAngle": light.inner_cone_rad, "outerConeAngle": light.outer_cone_rad}
        entries.append(entry)
        length = math.sqrt(sum(v * v for v in light.direction))
        file.node(name=light.name, translation=list(_y_up(light.position)),
                  rotation=_turn_from_minus_z([v / length for v in _y_up(light.direction)]),
                  extensions={"KHR_lights_punctual": {"light": index}})
    file.extensions.add("KHR_lights_punctual")
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": entries}}


def _add_textures(file, textures):
    """Pictures stand last in the buffer, so that the geometry's place does not depend on how well they compress."""
    if not textures:
        return
    repeat, clamp = 10497, 33071
    file.json["samplers"] = [{"magFilter": 9729, "minFilter": 9987, "wrapS": wrap, "wrapT": wrap}
                             for wrap in (repeat, clamp)]
    file.json["images"] = [{"name": t.name, "mimeType": "image/png", "bufferView": file.view(png(t))}
                           for t in textures]
    file.json["textures"] = [{"sampler": 1 if t.clamp else 0, "source": i} for i, t in enumerate(textures)]


def content(data):
    """What a .glb file holds, as values that compare equal whatever version of zlib packed the pictures."""
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + length])
    blob = data[28 + length:]
    pictures = {image["bufferView"] for image in document.get("images", ())}
    payload = []
    for index, view in enumerate(document["bufferViews"]):
        piece = blob[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]
        if index in pictures:
            piece = _unpacked_png(piece)
            del view["byteOffset"], view["byteLength"]
        payload.append(piece)
    del document["buffers"]
    return document, payload


def _unpacked_png(data):
    chunks, offset = [], 8
    while offset < len(data):
        length, name = struct.unpack_from(">I4s", data, offset)
        body = data[offset + 8:offset + 8 + length]
        chunks.append((name, zlib.decompress(body) if name == b"IDAT" else body))
        offset += 12 + length
    return chunks


@dataclass(frozen=True, eq=False)
class MaskedMaterial(Material):
    """What is seen where its texture's alpha reaches the cutoff. Its texture's palette is of (r, g, b, a)."""
    cutoff: float = 0.5


@dataclass
class Surface:
    """Triangles of one material, with vertex tables of equal length. Colours are linear RGB or RGBA, 0 to 1."""
    material: Material
    points: list
    normals: list
    uvs: list
    colors: list
    indices: list


@dataclass(frozen=True)
class Place:
    """Where an instance stands, in the model's z-up frame; `turn` is a quaternion (x, y, z, w)."""
    position: tuple
    turn: tuple = (0.0, 0.0, 0.0, 1.0)
    scale: tuple = (1.0, 1.0, 1.0)


def palette_png(texture):
    """A texture with a palette of (r, g, b) or (r, g, b, a) as a PNG file."""
    header = struct.pack(">IIBBBBB", texture.width, texture.height, 8, 3, 0, 0, 0)
    rows = b"".join(b"\0" + texture.pixels[y * texture.width:(y + 1) * texture.width] for y in range(texture.height))
    chunks = [(b"IHDR", header), (b"PLTE", bytes(v for entry in texture.palette for v in entry[:3]))]
    if len(texture.palette[0]) == 4:
        chunks.append((b"tRNS", bytes(entry[3] for entry in texture.palette)))
    chunks += [(b"IDAT", zlib.compress(rows, 6)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in chunks)


def _bytes_accessor(file, rows, code, component_type, kind):
    """Normalised 8-bit values, four bytes apart as glTF asks of vertices."""
    data = struct.pack(f"<{4 * len(rows)}{code}", *(v for row in rows for v in (*row, 0)[:4]))
    view = file.view(data, 34962)
    file.json["bufferViews"][view]["byteStride"] = 4
    file.json["accessors"].append({"bufferView": view, "componentType": component_type, "normalized": True,
                                   "count": len(rows), "type": kind})
    return len(file.json["accessors"]) - 1


def _packed_primitive(file, surface, materials, textures):
    """A primitive whose normals and colours take a byte per component."""
    rounded = lambda rows: [tuple(round(v, 5) + 0.0 for v in row) for row in rows]
    normals = [tuple(round(127 * v) for v in _y_up(n)) for n in surface.normals]
    colors = [tuple(max(0, min(255, round(255 * v))) for v in (*c, 1.0)[:4]) for c in surface.colors]
    attributes = {"POSITION": file.accessor(rounded(map(_y_up, surface.points)), 3, bounds=True),
                  "NORMAL": _bytes_accessor(file, normals, "b", 5120, "VEC3"),
                  "COLOR_0": _bytes_accessor(file, colors, "B", 5121, "VEC4")}
    texture = surface.material.texture
    if texture:
        attributes["TEXCOORD_0"] = file.accessor(rounded(surface.uvs), 2)
        if texture not in textures:
            textures.append(texture)
    if surface.material not in materials:
        materials.append(surface.material)
        file.material(surface.material, textures)
        if isinstance(surface.material, MaskedMaterial):
            file.json["materials"][-1].update(alphaMode="MASK", alphaCutoff=surface.material.cutoff)
    return {"attributes": attributes, "indices": file.indices(surface.indices, len(surface.points)),
            "material": materials.index(surface.material)}


def _instancing(file, places):
    def vec4(rows):
        flat = [v for row in rows for v in row]
        view = file.view(struct.pack(f"<{len(flat)}f", *flat))
        file.json["accessors"].append(
            {"bufferView": view, "componentType": 5126, "count": len(rows), "type": "VEC4"})
        return len(file.json["accessors"]) - 1
    exact = lambda v: round(v, 6) + 0.0
    return {"EXT_mesh_gpu_instancing": {"attributes": {
        "TRANSLATION": file.accessor([tuple(map(exact, _y_up(p.position))) for p in places], 3),
        "ROTATION": vec4([tuple(map(exact, (*_y_up(p.turn[:3]), p.turn[3]))) for p in places]),
        "SCALE": file.accessor([tuple(map(exact, (p.scale[0], p.scale[2], p.scale[1]))) for p in places], 3)}}}


def instanced_glb(name, kinds, lights=()):
    """A .glb file with a node per kind: `kinds` holds (name, surfaces, places). No places: it stands in the origin."""
    file = _File(name)
    materials, textures = [], []
    for kind, surfaces, places in kinds:
        primitives = [_packed_primitive(file, surface, materials, textures) for surface in surfaces]
        file.json["meshes"].append({"name": kind, "primitives": primitives})
        node = {"name": kind, "mesh": len(file.json["meshes"]) - 1}
        if places:
            node["extensions"] = _instancing(file, places)
            file.extensions.add("EXT_mesh_gpu_instancing")
        file.node(**node)
    file.extensions.add("KHR_mesh_quantization")
    file.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    if file.extensions & {"EXT_mesh_gpu_instancing"}:
        file.json["extensionsRequired"].insert(0, "EXT_mesh_gpu_instancing")
    _add_lights(file, lights)
    _add_palette_textures(file, textures)
    return file.bytes()


def _add_palette_textures(file, textures):
    """As _add_textures, for pictures with palettes."""
    if not textures:
        return
    repeat, clamp = 10497, 33071
    file.json["samplers"] = [{"magFilter": 9729, "minFilter": 9987, "wrapS": wrap, "wrapT": wrap}
                             for wrap in (repeat, clamp)]
    file.json["images"] = [{"name": t.name, "mimeType": "image/png", "bufferView": file.view(palette_png(t))}
                           for t in textures]
    file.json["textures"] = [{"sampler": 1 if t.clamp else 0, "source": i} for i, t in enumerate(textures)]
