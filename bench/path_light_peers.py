#!/usr/bin/env python3
"""Compares pictures by paths of light with Mitsuba 3, an independent path tracer, on the same meshes.

    python3 bench/path_light_peers.py >bench/results/path_light_peers.csv

needs the packages mitsuba and numpy. Both render rooms of rectangles with a box, balls and a lamp with a size or a sky;
SCENES has what each room compares. Both give the standard deviation of each pixel: SimVis as an output, and Mitsuba by the
spread of independent pictures. Where both are right, the mean of the squares of (SimVis - Mitsuba) over the variance of this
difference is that of Student's distributions with their numbers of samples, printed as `expected`.
`difference_over_deviation` is that of the means, of the colour with the largest. `largest_tile` is that of the sums over a
tile of 12 x 12 pixels, of 48 tiles and three colours: 2 to 3.5 where both are right. The folder of each scene has a picture
of both side by side with four times their difference.

Differences of the models:
- SimVis's microfacets shadow and mask together, as the appendix of glTF 2.0 defines. Mitsuba's `roughconductor` and
  `principled` multiply both as if they were independent.
- SimVis averages the reflectance of a pane over both polarisations after the reflections inside it, Mitsuba's
  `thindielectric` before: they differ by less than 0.001 up to 30 degrees, and by 0.012 at 60 degrees.
- Mirrors have flat faces here: SimVis mirrors at faces, as scanners see them, and Mitsuba at interpolated normals. Of a
  blend of a mirror with a matte surface, `blendbsdf` of Mitsuba 3.9.1 loses light: a mirror of 0.8 shows a lamp of
  radiance 1 with 0.74, so that the mirrors here are black beside their reflection.
- A path through a pane is a bounce in Mitsuba. The scene with glass is dark and has many bounces.
- SimVis takes the nearest pixel of the picture of a sky, Mitsuba interpolates between pixels. The picture is smooth.
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
PICTURES = 16  # of Mitsuba
TILE = 12


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


def texture():
    """Without symmetry, in sRGB: stripes along one axis, a ramp along the other, a red corner."""
    rows, columns = np.mgrid[0:32, 0:32]
    image = np.stack([40 + 6 * rows, np.where(columns % 8 < 4, 200, 60), 220 - 5 * columns], 2).astype("u1")
    image[:8, :8] = (230, 30, 30)
    return image


UV = np.array([(0, 0), (3, 0), (3, 2.5), (0, 2.5)], float)
GREY, RED, BLUE = {"color": (0.5, 0.5, 0.5)}, {"color": (0.7, 0.3, 0.2)}, {"color": (0.2, 0.3, 0.7)}
DARK = {"color": (0.3, 0.3, 0.3)}
WHITE_METAL = {"color": (1, 1, 1), "metallic": 1, "roughness": 0.4}
FLOOR = rectangle((-4, -3, 0), (8, 0, 0), (0, 6, 0))
LAMP = {"LAMP": (rectangle((-1.2, -0.8, 2.6), (0, 1.6, 0), (1.6, 0, 0)), {"color": (0, 0, 0), "emission": 1})}
BALL, TALL_BOX = ball((0, 0.2, 0.6), 0.6), box((0.6, -1.6, 0), (1.4, -0.8, 1.2))


def room(floor=GREY, back=RED, side=BLUE, box_look=GREY, **others):
    return {"FLOOR": (FLOOR, floor), "BACK": (rectangle((2, -3, 0), (0, 0, 3), (0, 6, 0)), back),
            "SIDE": (rectangle((-4, 2, 0), (8, 0, 0), (0, 0, 3)), side), "BOX": (TALL_BOX, box_look), **others}


def metal_balls(*balls):
    return {f"BALL_{i}": (ball(middle, radius), {"color": color, "metallic": 1, "roughness": roughness})
            for i, (middle, radius, color, roughness) in enumerate(balls)}


def behind_pane(pane):
    return room(DARK, DARK, DARK, DARK, BALL=(BALL, DARK),
                PANE=(rectangle((-1.2, -1.6, 0.1), (0, 2.4, 0), (0, 0, 1.6)), pane), **LAMP)


def sky_radiance(directions):
    """Blue above, brown below, and a bright warm spot."""
    up = directions[..., 2:]
    spot = np.exp(30 * (directions @ np.array([-0.48, -0.6, 0.64]) - 1))[..., None]
    return 0.2 + 0.1 * up * np.array([-1, 0.5, 2]) + 6 * spot * np.array([1, 0.8, 0.5])


SCENES = {  # name: objects, bounces, whether a sky lights them
    "matte": (room(BALL=(BALL, {"color": (0.8, 0.8, 0.8)}), **LAMP), 3, False),
    "polished metal": (room(BALL=(BALL, WHITE_METAL), **LAMP), 3, False),
    "coloured metals": (room(**metal_balls(((0, 0.9, 0.6), 0.6, (0.9, 0.6, 0.2), 0.25),
                                           ((-0.4, -0.5, 0.5), 0.5, (0.9, 0.4, 0.3), 0.7)), **LAMP), 3, False),
    "textures": (room(floor={"texture": texture(), "uv": UV}, back={"texture": texture(), "uv": UV},
                      BALL=(BALL, {"color": (0.8, 0.8, 0.8)}), **LAMP), 3, False),
    "mirrors": (room(back={"color": (0, 0, 0), "mirror": 0.8}, box_look={"color": (0, 0, 0), "mirror": 0.5},
                     BALL=(BALL, {"color": (0.8, 0.8, 0.8)}), **LAMP), 6, False),
    "tinted pane": (behind_pane({"color": (0.9, 0.7, 0.5), "transmission": 1, "ior": 1.0}), 10, False),
    "glass": (behind_pane({"color": (0.9, 1, 0.8), "transmission": 1, "ior": 1.5}), 10, False),
    "sky": ({"FLOOR": (FLOOR, GREY), "BOX": (TALL_BOX, RED), "BALL": (BALL, {"color": (0.8, 0.8, 0.8)})}, 4, True),
    "sky and metal": ({"FLOOR": (FLOOR, GREY), "BOX": (TALL_BOX, RED), "BALL": (BALL, WHITE_METAL)}, 4, True),
}


def png(image):
    stream = mi.MemoryStream()
    mi.Bitmap(image).write(stream, mi.Bitmap.FileFormat.PNG)
    return bytes(stream.raw_buffer())


def write_glb(path, objects):
    """glTF has y up."""
    data, views, accessors, materials, meshes, nodes, images = b"", [], [], [], [], [], []

    def view(content):
        nonlocal data
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(content)})
        data += content + b"\0" * (-len(content) % 4)
        return len(views) - 1

    def accessor(array, kind, component):
        components = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[kind]
        entry = {"bufferView": view(array.tobytes()), "componentType": component, "count": array.size // components,
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
        surface = {"metallicFactor": look.get("metallic", 0), "roughnessFactor": look.get("roughness", 1)}
        if "texture" in look:
            images.append({"bufferView": view(png(look["texture"])), "mimeType": "image/png"})
            surface["baseColorTexture"] = {"index": len(images) - 1}
            attributes["TEXCOORD_0"] = accessor(look["uv"].astype("<f4"), "VEC2", 5126)
        else:
            surface["baseColorFactor"] = [*look["color"], 1]
        materials.append({"name": name, "pbrMetallicRoughness": surface, "emissiveFactor": [look.get("emission", 0)] * 3})
        if "transmission" in look:
            materials[-1]["doubleSided"] = True  # rays of the camera pass the backs of others
            materials[-1]["extensions"] = {"KHR_materials_transmission": {"transmissionFactor": look["transmission"]},
                                           "KHR_materials_ior": {"ior": look["ior"]}}
        meshes.append({"primitives": [{"attributes": attributes, "indices": indices, "material": len(materials) - 1}]})
        nodes.append({"name": name, "mesh": len(meshes) - 1})
    text = json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
                       "meshes": meshes, "materials": materials, "accessors": accessors, "bufferViews": views,
                       "buffers": [{"byteLength": len(data)}], "extensionsUsed": ["KHR_materials_transmission", "KHR_materials_ior"],
                       **({"images": images, "textures": [{"source": i} for i in range(len(images))]} if images else {})}).encode()
    text += b" " * (-len(text) % 4)
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


def write_sky(path):
    """Its middle is +x, its left half +y, its upper edge +z."""
    height, width = 1024, 2048
    elevation = math.pi * (0.5 - (np.arange(height) + 0.5) / height)[:, None]
    azimuth = 2 * math.pi * (0.5 - (np.arange(width) + 0.5) / width)[None, :]
    directions = np.stack(np.broadcast_arrays(np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth),
                                              np.sin(elevation)), 2)
    mi.Bitmap(sky_radiance(directions).astype("f4")).write(str(path))


def mitsuba_sky():
    """The picture's columns begin at -z and go to +x, its upper row is +y; pixels lie on its edges."""
    height, width = 1025, 2048
    polar = math.pi * (np.arange(height) / (height - 1))[:, None]
    around = 2 * math.pi * (np.arange(width) / width)[None, :]
    x, y, z = np.broadcast_arrays(np.sin(polar) * np.sin(around), np.cos(polar), -np.sin(polar) * np.cos(around))
    frame = np.array([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)
    return {"type": "envmap", "bitmap": mi.Bitmap(sky_radiance(np.stack([z, x, y], 2)).astype("f4")),
            "to_world": mi.ScalarTransform4f(frame)}


def by_simvis(simvis, folder, objects, bounces, sky, samples):
    mirrors = "".join(f'  <element type="material" name="{name}_MIRROR" insert_at="ROOT" part="ROOM" material="{name}" '
                      f'mirror="{look["mirror"]}"/>\n' for name, (_, look) in objects.items() if "mirror" in look)
    lit = '<element type="sky_light" name="DAY" insert_at="ROOT" picture="sky.exr"/>' if sky else ""
    (folder / "scene.xml").write_text(f"""<simvis>
  <part file="scene.glb" name="ROOM" insert_at="ROOT"/>
{mirrors}  <element type="light" name="OFF" insert_at="ROOT" kind="point" intensity="0"/>
  <element type="sky" name="SKY" insert_at="ROOT" red="0" green="0" blue="0" ambient_red="0" ambient_green="0" ambient_blue="0"/>
  {lit}
  <sensor type="camera" name="CAM" insert_at="ROOT" pose_offset="{pose()}" width="{WIDTH}" height="{HEIGHT}"
          hfov="{HFOV_DEG}" light="path" samples="{samples}" bounces="{bounces}" outputs="color color_stddev"/>
</simvis>
""")
    start = children_cpu_s()
    subprocess.run([simvis, folder / "scene.xml", "--out", folder / "out", "--format", "color=exr", "--quiet"], check=True)
    cpu_s = children_cpu_s() - start
    color = np.array(mi.Bitmap(str(folder / "out/CAM/000000.exr")))[..., :3]
    stddev = np.array(mi.Bitmap(str(folder / "out/CAM_color_stddev/000000.exr")))[..., :3]
    return color.astype(float), stddev.astype(float), cpu_s


def rgb(color):
    return {"type": "rgb", "value": list(color)}


def mitsuba_bsdf(look):
    if "transmission" in look:
        return {"type": "thindielectric", "int_ior": look["ior"], "ext_ior": 1.0, "specular_transmittance": rgb(look["color"])}
    if "mirror" in look:  # the rest of it is black
        bsdf = {"type": "conductor", "material": "none", "specular_reflectance": rgb([look["mirror"]] * 3)}
    elif look.get("metallic", 0) == 1 and look["color"] == (1, 1, 1):
        bsdf = {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": look["roughness"] ** 2}
    elif look.get("metallic", 0) == 1:
        bsdf = {"type": "principled", "base_color": rgb(look["color"]), "metallic": 1.0, "roughness": look["roughness"]}
    elif "texture" in look:
        bsdf = {"type": "diffuse", "reflectance": {"type": "bitmap", "bitmap": mi.Bitmap(look["texture"])}}
    else:
        bsdf = {"type": "diffuse", "reflectance": rgb(look["color"])}
    return {"type": "twosided", "nested": bsdf}


def by_mitsuba(folder, objects, bounces, sky, samples):
    parts = {"type": "scene", "integrator": {"type": "path", "max_depth": bounces + 1, "rr_depth": 1000}}
    for name, ((points, normals, faces), look) in objects.items():
        mesh = mi.Mesh(name, len(points), len(faces), has_vertex_normals=True, has_vertex_texcoords="uv" in look)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = points.astype("f4").ravel()
        parameters["vertex_normals"] = normals.astype("f4").ravel()
        if "uv" in look:
            parameters["vertex_texcoords"] = look["uv"].astype("f4").ravel()
        parameters["faces"] = faces.astype("u4").ravel()
        parameters.update()
        file = str(folder / f"{name}.ply")
        mesh.write_ply(file)
        parts[name] = {"type": "ply", "filename": file, "bsdf": mitsuba_bsdf(look)}
        if look.get("emission", 0) > 0:
            parts[name]["emitter"] = {"type": "area", "radiance": rgb([look["emission"]] * 3)}
    if sky:
        parts["sky"] = mitsuba_sky()
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


def in_tiles(image):
    return image.reshape(HEIGHT // TILE, TILE, WIDTH // TILE, TILE, 3).sum((1, 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--simvis", type=Path, default=Path("build/release/bin/simvis-run"))
    parser.add_argument("--out", type=Path, default=Path("build/path_light"))
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--scene", choices=SCENES, action="append", help="default: all")
    options = parser.parse_args()
    print("scene,bounces,samples,simvis_mean,mitsuba_mean,difference_over_deviation,mean_square,expected,largest_tile,"
          "simvis_paths_per_s,mitsuba_paths_per_s")
    for name in options.scene or SCENES:
        folder = options.out / name.replace(" ", "_")
        folder.mkdir(parents=True, exist_ok=True)
        objects, bounces, sky = SCENES[name]
        write_glb(folder / "scene.glb", objects)
        if sky:
            write_sky(folder / "sky.exr")
        own, own_stddev, own_s = by_simvis(options.simvis, folder, objects, bounces, sky, options.samples)
        peer, peer_stddev, peer_s = by_mitsuba(folder, objects, bounces, sky, options.samples)
        variance = own_stddev ** 2 + peer_stddev ** 2
        lit = variance > 0
        off = (own - peer)[lit] / np.sqrt(variance[lit])
        # By colour, since the colours of a pixel have the same paths.
        shifts = (own - peer).sum((0, 1)) / np.sqrt(variance.sum((0, 1)))
        shift = shifts[np.abs(shifts).argmax()]
        share = (peer_stddev ** 2)[lit] / variance[lit]
        degrees = 1 / (share ** 2 / (PICTURES - 1) + (1 - share) ** 2 / (options.samples - 1))  # Welch and Satterthwaite
        expected = (degrees / (degrees - 2)).mean()
        paths = WIDTH * HEIGHT * options.samples
        tiles = np.abs(in_tiles(own - peer)) / np.sqrt(np.maximum(in_tiles(variance), 1e-30))
        print(f"{name},{bounces},{options.samples},{own.mean():.5f},{peer.mean():.5f},{shift:.2f},{(off ** 2).mean():.3f},"
              f"{expected:.3f},{tiles.max():.1f},{paths / own_s:.3g},{paths / peer_s:.3g}", flush=True)
        both = np.concatenate([own, peer, 0.5 + 4 * (own - peer)], 1)
        mi.util.write_bitmap(str(folder / "simvis_mitsuba_difference.png"), both.astype("f4"))


if __name__ == "__main__":
    main()
