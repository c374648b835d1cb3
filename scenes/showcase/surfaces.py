"""Metal, plastic and relief: what light shows of surfaces."""
import math

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


def relief(bumps):
    """An upright panel of 1 x 1 m that faces -x, flat except for its normal map; the origin is in its middle."""
    model = Model("relief" if bumps else "relief_flat")
    model.add(Material("panel", CLAY, bumps=studs(128, 5) if bumps else None, roughness=0.6),
              turned(picture(1, 1), "z", 180))
    return model


def metal(shines):
    """Spheres: above metal, below a dielectric, polished to rough from left (+y) to right; faces -x. Or all matte."""
    model = Model("metal" if shines else "metal_matte")
    for column, roughness in enumerate((0.1, 0.3, 0.5, 0.75, 1.0)):
        for z, name, color, metallic in ((0.22, "gold", GOLD, 1.0), (-0.22, "clay", CLAY, 0.0)):
            material = Material(f"{name} {roughness}", color, roughness=roughness if shines else 1.0,
                                metallic=metallic if shines else 0.0)
            model.add(material, moved(sphere(0.2, 32, 20), 0, 0.88 - 0.44 * column, z))
    model.add(Material("base", STEEL, roughness=0.4 if shines else 1.0, metallic=1.0 if shines else 0.0), rounded_box(0.5, 2.4, 0.06, 0.02), (0, 0, -0.45))
    return model


def models():
    return [relief(True), relief(False), metal(True), metal(False)]
