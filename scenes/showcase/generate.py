"""Makes the parts of the showcase scenes: small things that each show an effect.

    generate.py            writes the files beside it
    generate.py --out DIR  writes them into DIR
    generate.py --check    makes them in memory and compares them with the files beside this one

It needs Python 3.9 or newer and nothing else. The .xml files are written by hand.
"""
import argparse
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE), str(HERE.parent)]

import committed
import gltf_writer
from gltf_writer import Material, Texture, linear
from shapes import Model, moved, picture, rounded_box, sphere, turned

GOLD, STEEL, CLAY = linear("#ffd891"), linear("#c4c7c7"), linear("#a8513a")


def studs(side_px, count):
    """A normal map of `count` x `count` round studs."""
    pixels = bytearray()
    for row in range(side_px):
        for column in range(side_px):
            x, y = (((i + 0.5) / side_px * count) % 1 * 2 - 1 for i in (column, row))
            radius = math.hypot(x, y)
            # Up in the picture is +y of the map. The slope rises and falls along the rim.
            steep = 0.8 * math.sin(math.pi * radius / 0.9) if radius < 0.9 else 0.0
            slope = (steep * x / radius, -steep * y / radius) if radius else (0.0, 0.0)
            length = math.sqrt(1 + slope[0] ** 2 + slope[1] ** 2)
            pixels += bytes(round((v / length * 0.5 + 0.5) * 255) for v in (*slope, 1))
    return Texture("studs", side_px, side_px, bytes(pixels))


def relief():
    """An upright panel of 1 x 1 m that faces -x, flat but for its normal map; the origin is in its middle."""
    model = Model("relief")
    model.add(Material("panel", CLAY, normals=studs(128, 5), roughness=0.6), turned(picture(1, 1), "z", 180))
    return model


def metal():
    """Spheres: above metal, below a dielectric, polished to rough from left (+y) to right; faces -x."""
    model = Model("metal")
    for column, roughness in enumerate((0.1, 0.3, 0.5, 0.75, 1.0)):
        for z, name, color, metallic in ((0.22, "gold", GOLD, 1.0), (-0.22, "clay", CLAY, 0.0)):
            material = Material(f"{name} {roughness}", color, roughness=roughness, metallic=metallic)
            model.add(material, moved(sphere(0.2, 32, 20), 0, 0.88 - 0.44 * column, z))
    model.add(Material("base", STEEL, roughness=0.4, metallic=1.0), rounded_box(0.5, 2.4, 0.06, 0.02), (0, 0, -0.45))
    return model


def make():
    """The files by name."""
    return {f"{model.name}.glb": gltf_writer.glb(model.name, model.faces) for model in (relief(), metal())}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=HERE, metavar="DIR")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    files = make()
    if arguments.check:
        problems = committed.problems(HERE, files)
        if problems:
            sys.exit("\n".join(problems))
        return
    for name, data in files.items():
        (arguments.out / name).write_bytes(data)
        print(f"{name:24} {len(data):8} bytes")


if __name__ == "__main__":
    main()
