#!/usr/bin/env python3
"""Compares pictures by paths of light with Mitsuba 3, an independent path tracer, on the same meshes.

    python3 bench/path_light_peers.py --simvis build/release/bin/simvis-run --out build/path_light

needs the packages mitsuba and numpy. Both render a room of rectangles with a box, a ball and a lamp with a size: once with a
matte ball and once with a ball of polished metal. Both give the standard deviation of each pixel: SimVis as an output, and
Mitsuba by the spread of independent pictures. Where both are right, the mean of the squares of (SimVis - Mitsuba) over the
variance of this difference is that of Student's distributions with their numbers of samples, printed as `expected`.

One difference of the models is known: SimVis's microfacets shadow and mask together, as the appendix of glTF 2.0 defines, and
Mitsuba's `roughconductor` multiplies both as if they were independent.
"""
import argparse
import json
import math
import resource
import struct
import subprocess
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

WIDTH, HEIGHT, HFOV_DEG = 96, 72, 60.0
EYE, TARGET = (-3.0, -0.6, 1.2), (0.0, 0.0, 0.6)
BOUNCES = 3
PICTURES = 16  # of Mitsuba


def rectangle(corner, side, other):
    corner, side, other = (np.array(v, float) for v in (corner, side, other))
    normal = np.cross(side, other) / np.linalg.norm(np.cross(side, other))
    points = [corner, corner + side, corner + side + other, corner + other]
    return np.array(points), np.array([normal] * 4), np.array([[0, 1, 2], [0, 2, 3]])


def joined(meshes):
    points, normals, faces, first = [], [], [], 0
    for p, n, f in meshes:
        points.append(p)
        normals.append(n)
        faces.append(f + first)
        first += len(p)
    return np.concatenate(points), np.concatenate(normals), np.concatenate(faces)


def box(low, high):
    low, high = np.array(low, float), np.array(high, float)
    sides = []
    for axis in range(3):
        first, second = np.zeros(3), np.zeros(3)
        first[(axis + 1) % 3] = (high - low)[(axis + 1) % 3]
        second[(axis + 2) % 3] = (high - low)[(axis + 2) % 3]
        far = low.copy()
        far[axis] = high[axis]
        sides += [rectangle(far, first, second), rectangle(low, second, first)]
    return joined(sides)


def ball(middle, radius, segments=96):
    rows = segments // 2
    normals = []
    for row in range(rows + 1):
        for column in range(segments + 1):
            e, a = math.pi * row / rows - math.pi / 2, 2 * math.pi * column / segments
            normals.append((math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)))
    faces = []
    for row in range(rows):
        for column in range(segments):
            i, above = row * (segments + 1) + column, (row + 1) * (segments + 1) + column
            if row > 0:
                faces.append((i, i + 1, above))
            if row < rows - 1:
                faces.append((i + 1, above + 1, above))
    normals = np.array(normals)
    return np.array(middle) + radius * normals, normals, np.array(faces)


def scene(metal):
    ball_material = {"color": (1, 1, 1), "metallic": 1, "roughness": 0.4} if metal else {"color": (0.8, 0.8, 0.8)}
    return {
        "FLOOR": (rectangle((-4, -3, 0), (8, 0, 0), (0, 6, 0)), {"color": (0.5, 0.5, 0.5)}),
        "BACK": (rectangle((2, -3, 0), (0, 0, 3), (0, 6, 0)), {"color": (0.7, 0.3, 0.2)}),
        "SIDE": (rectangle((-4, 2, 0), (8, 0, 0), (0, 0, 3)), {"color": (0.2, 0.3, 0.7)}),
        "BOX": (box((0.6, -1.6, 0), (1.4, -0.8, 1.2)), {"color": (0.6, 0.6, 0.6)}),
        "BALL": (ball((0, 0.2, 0.6), 0.6), ball_material),
        "LAMP": (rectangle((-1.2, -0.8, 2.6), (0, 1.6, 0), (1.6, 0, 0)), {"color": (0, 0, 0), "emission": 1}),
    }


def write_glb(path, objects):
    """glTF has y up."""
    data, views, accessors, materials, meshes, nodes = b"", [], [], [], [], []

    def accessor(array, kind, component):
        nonlocal data
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        data += array.tobytes()
        entry = {"bufferView": len(views) - 1, "componentType": component, "count": array.size // (3 if kind == "VEC3" else 1),
                 "type": kind}
        if kind == "VEC3":
            entry |= {"min": array.min(0).tolist(), "max": array.max(0).tolist()}
        accessors.append(entry)
        return len(accessors) - 1

    def turned(vectors):
        return np.stack([vectors[:, 0], vectors[:, 2], -vectors[:, 1]], 1).astype("<f4")

    for name, ((points, normals, faces), look) in objects.items():
        attributes = {"POSITION": accessor(turned(points), "VEC3", 5126), "NORMAL": accessor(turned(normals), "VEC3", 5126)}
        indices = accessor(faces.astype("<u4").ravel(), "SCALAR", 5125)
        materials.append({"pbrMetallicRoughness": {"baseColorFactor": [*look["color"], 1],
                                                   "metallicFactor": look.get("metallic", 0),
                                                   "roughnessFactor": look.get("roughness", 1)},
                          "emissiveFactor": [look.get("emission", 0)] * 3})
        meshes.append({"primitives": [{"attributes": attributes, "indices": indices, "material": len(materials) - 1}]})
        nodes.append({"name": name, "mesh": len(meshes) - 1})
    text = json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
                       "meshes": meshes, "materials": materials, "accessors": accessors, "bufferViews": views,
                       "buffers": [{"byteLength": len(data)}]}).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    length = 12 + 8 + len(text) + 8 + len(data)
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, length) + struct.pack("<II", len(text), 0x4E4F534A) + text +
                     struct.pack("<II", len(data), 0x004E4942) + data)


def pose():
    x = np.array(TARGET) - np.array(EYE)
    yaw, pitch = math.degrees(math.atan2(x[1], x[0])), -math.degrees(math.atan2(x[2], math.hypot(x[0], x[1])))
    return " ".join(str(v) for v in (*EYE, 0, pitch, yaw))


def children_cpu_s():
    use = resource.getrusage(resource.RUSAGE_CHILDREN)
    return use.ru_utime + use.ru_stime


def by_simvis(simvis, folder, samples):
    (folder / "scene.xml").write_text(f"""<simvis>
  <part file="scene.glb" name="ROOM" insert_at="ROOT"/>
  <element type="light" name="OFF" insert_at="ROOT" kind="point" intensity="0"/>
  <element type="sky" name="SKY" insert_at="ROOT" red="0" green="0" blue="0" ambient_red="0" ambient_green="0" ambient_blue="0"/>
  <sensor type="camera" name="CAM" insert_at="ROOT" pose_offset="{pose()}" width="{WIDTH}" height="{HEIGHT}"
          hfov="{HFOV_DEG}" light="path" samples="{samples}" bounces="{BOUNCES}" outputs="color color_stddev"/>
</simvis>
""")
    start = children_cpu_s()
    subprocess.run([simvis, folder / "scene.xml", "--out", folder / "out", "--format", "color=exr", "--quiet"], check=True)
    cpu_s = children_cpu_s() - start
    color = np.array(mi.Bitmap(str(folder / "out/CAM/000000.exr")))[..., :3]
    stddev = np.array(mi.Bitmap(str(folder / "out/CAM_color_stddev/000000.exr")))[..., :3]
    return color.astype(float), stddev.astype(float), cpu_s


def by_mitsuba(objects, samples):
    parts = {"type": "scene", "integrator": {"type": "path", "max_depth": BOUNCES + 1, "rr_depth": 1000}}
    for name, ((points, normals, faces), look) in objects.items():
        mesh = mi.Mesh(name, len(points), len(faces), has_vertex_normals=True)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = points.astype("f4").ravel()
        parameters["vertex_normals"] = normals.astype("f4").ravel()
        parameters["faces"] = faces.astype("u4").ravel()
        parameters.update()
        file = f"build/path_light_{name}.ply"
        mesh.write_ply(file)
        if look.get("metallic", 0) == 1:
            bsdf = {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": look["roughness"] ** 2}
        else:
            bsdf = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(look["color"])}}
        parts[name] = {"type": "ply", "filename": file, "bsdf": {"type": "twosided", "nested": bsdf}}
        if look.get("emission", 0) > 0:
            parts[name]["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": look["emission"]}}
    parts["camera"] = {"type": "perspective", "fov": HFOV_DEG, "fov_axis": "x", "near_clip": 0.05,
                       "to_world": mi.ScalarTransform4f().look_at(EYE, TARGET, (0, 0, 1)),
                       "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"},
                                "pixel_format": "rgb", "component_format": "float32"},
                       "sampler": {"type": "independent"}}
    loaded = mi.load_dict(parts)
    start = time.process_time()
    pictures = np.array([np.array(mi.render(loaded, spp=samples // PICTURES, seed=seed)) for seed in range(PICTURES)], float)
    cpu_s = time.process_time() - start
    return pictures.mean(0), pictures.std(0, ddof=1) / math.sqrt(PICTURES), cpu_s


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--simvis", type=Path, default=Path("build/release/bin/simvis-run"))
    parser.add_argument("--out", type=Path, default=Path("build/path_light"))
    parser.add_argument("--samples", type=int, default=256)
    options = parser.parse_args()
    print("| scene | mean of SimVis | of Mitsuba | difference of the means / deviation | mean square of pixels | expected | "
          "paths per second and thread of SimVis, with loading and files | of Mitsuba |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for metal in (False, True):
        name = "metal" if metal else "matte"
        folder = options.out / name
        folder.mkdir(parents=True, exist_ok=True)
        objects = scene(metal)
        write_glb(folder / "scene.glb", objects)
        own, own_stddev, own_s = by_simvis(options.simvis, folder, options.samples)
        peer, peer_stddev, peer_s = by_mitsuba(objects, options.samples)
        variance = own_stddev ** 2 + peer_stddev ** 2
        lit = variance > 0
        off = (own - peer)[lit] / np.sqrt(variance[lit])
        shift = (own - peer).sum() / math.sqrt(variance.sum())
        share = (peer_stddev ** 2)[lit] / variance[lit]
        degrees = 1 / (share ** 2 / (PICTURES - 1) + (1 - share) ** 2 / (options.samples - 1))  # Welch and Satterthwaite
        expected = (degrees / (degrees - 2)).mean()
        paths = WIDTH * HEIGHT * options.samples
        print(f"| {name} | {own.mean():.5f} | {peer.mean():.5f} | {shift:.2f} | {(off ** 2).mean():.3f} | {expected:.3f} | "
              f"{paths / own_s:.3g} | {paths / peer_s:.3g} |")
        both = np.concatenate([own, peer, 0.5 + 4 * (own - peer)], 1)
        mi.util.write_bitmap(str(folder / "simvis_mitsuba_difference.png"), both.astype("f4"))


if __name__ == "__main__":
    main()
