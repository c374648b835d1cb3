"""A yard with one thing for each effect: what is rough, bright, see-through, mirroring or full of holes.

The origin is on the ground in the middle: x to the house wall, y to the left, z up, metres.
"""
import math
import random

import painting
from gltf_writer import MaskedMaterial, Material, Texture, linear
from shapes import Model, box, cylinder, grid, lathe, moved, picture, rounded_box, sphere, turned

WALL_X = 3.6


def _courses(size, bricks, rows, mortar):
    """By pixel: how high a brick stands there (0 in the joints), and which brick it is."""
    high, which = [], []
    for y in range(size):
        row = y * rows // size
        for x in range(size):
            shifted = x / size * bricks + (0.5 if row % 2 else 0)
            u, v = shifted % 1, y / size * rows % 1
            edge = min(min(u, 1 - u) / bricks, min(v, 1 - v) / rows) * size
            high.append(min(1.0, max(0.0, (edge - mortar) / 3)))
            which.append((row, int(shifted) % bricks))
    return high, which


def _bumps(name, size, high, depth):
    """The normal map of a height field that repeats: v runs down."""
    pixels = bytearray()
    for y in range(size):
        for x in range(size):
            at = lambda dx, dy: high[(y + dy) % size * size + (x + dx) % size]
            slope_u, slope_v = (at(1, 0) - at(-1, 0)) * depth / 2, (at(0, 1) - at(0, -1)) * depth / 2
            length = math.sqrt(slope_u ** 2 + slope_v ** 2 + 1)
            pixels += bytes(round(127.5 + 127.5 * n) for n in (-slope_u / length, slope_v / length, 1 / length))
    return Texture(name, size, size, bytes(pixels))


def _bricks():
    rng, size = random.Random(5), 256
    high, which = _courses(size, 4, 8, 2.0)
    shades = {}
    grain = painting.layers(size, size, [(32, 32, 0.25), (96, 96, 0.25)], rng)
    pixels = bytearray()
    for i, (height, brick) in enumerate(zip(high, which)):
        shade = shades.setdefault(brick, 0.82 + 0.3 * rng.random()) * (1 + 0.4 * grain[i // size][i % size])
        for joint, clay in zip((188, 182, 172), (168, 84, 62)):
            pixels.append(max(0, min(255, round(joint + (clay * shade - joint) * height))))
    return Material("bricks", texture=Texture("bricks", size, size, bytes(pixels)), tile_m=(1.0, 0.6),
                    bumps=_bumps("brick bumps", size, high, 1.6), roughness=0.9)


def _paving():
    size = 128
    grain = painting.layers(size, size, [(6, 6, 0.10), (48, 48, 0.12)], random.Random(9))
    pixels = bytearray()
    for y in range(size):
        for x in range(size):
            joint = x < 2 or y < 2
            pixels.append(max(0, min(255, round((150 if joint else 214) * (1 + grain[y][x])))))
    return Material("paving", linear("#b7b2a6"), Texture("paving", size, size, bytes(pixels)), (0.6, 0.6))


def _wire():
    """A mesh fence: wires around holes, of which 69 % is hole."""
    size, wire = 64, 11
    pixels = bytes(1 if x < wire or y < wire else 0 for y in range(size) for x in range(size))
    palette = ((90, 110, 96, 0), (90, 110, 96, 255))
    return MaskedMaterial("wire", texture=Texture("wire", size, size, pixels, palette), tile_m=(0.12, 0.12),
                          double_sided=True, cutoff=0.5)


def _paint(name, color, **more):
    return Material(name, linear(color), **more)


def yard():
    model = Model("yard")
    cuts = [-6 + i for i in range(13)]
    model.add(_paving(), grid(cuts, cuts, lambda u, v: (u, v, 0), (0, 0, 1)))
    heights = [0, 0.6, 1.2, 1.8, 2.4, 3.0]
    model.add(_bricks(), grid(cuts, heights, lambda u, v: (WALL_X, -u, v), (-1, 0, 0)))
    model.add(_paint("coping", "#cfc9bd"), rounded_box(0.3, 12, 0.1, 0.02), (WALL_X + 0.05, 0, 3.05))
    crate = Material("crate", texture=painting.wood("crate", 128, ["#8a5f2f", "#b98a4e", "#d6ad72"], 3, 5),
                     tile_m=(0.9, 0.9))
    model.add(crate, turned(rounded_box(0.9, 0.9, 0.9, 0.02), "z", 24), (1.9, 2.5, 0.45))
    model.add(crate, turned(rounded_box(0.5, 0.5, 0.5, 0.02), "z", -8), (1.8, 2.4, 1.15))
    stone = _paint("stone", "#8f8a80", roughness=0.9)
    model.add(stone, lathe([(0, 0), (0.36, 0), (0.36, 0.06), (0.27, 0.12), (0.24, 0.62), (0.33, 0.68), (0.33, 0.74),
                            (0, 0.74)], 32), (1.4, 0.5, 0))
    model.add(_paint("bin", "#2f6d4f", roughness=0.4), rounded_box(0.45, 0.45, 0.8, 0.05, 3), (2.4, -3.4, 0.4))
    post = _paint("post", "#75797c", roughness=0.4)
    model.add(post, cylinder(0.03, 2.1, 12), (2.6, 1.2, 0))
    return model


def ball():
    model = Model("ball")
    model.add(Material("gold", linear("#e8c170"), metallic=1.0, roughness=0.35), sphere(0.36, 48, 32))
    return model


def fence():
    model = Model("fence")
    model.add(_wire(), turned(picture(1.8, 1.2), "z", 180), (0, 0, 0.7))
    frame = _paint("frame", "#52605a")
    for y in (-0.9, 0.9):
        model.add(frame, cylinder(0.025, 1.32, 10), (0, y, 0))
    return model


def pane():
    model = Model("pane")
    glass = Material("glass", linear("#bfe0e6", 0.25), blend=True, double_sided=True, roughness=0.1)
    model.add(glass, turned(picture(1.0, 1.6), "z", 180), (0, 0, 0.9))
    frame = _paint("window frame", "#e9e6df")
    for y in (-0.525, 0.525):
        model.add(frame, box(0.05, 0.05, 1.7), (0, y, 0.9))
    for z in (0.075, 1.725):
        model.add(frame, box(0.05, 1.1, 0.05), (0, 0, z))
    return model


def sails():
    """Three coloured sheets that cut through one another."""
    model = Model("sails")
    for turn, color in ((40, "#e0483e"), (100, "#3e8de0"), (160, "#f0c53a")):
        sheet = Material("sheet " + color, linear(color, 0.55), blend=True, double_sided=True)
        model.add(sheet, moved(turned(picture(0.9, 0.9), "z", turn), 0, 0, 0.75))
    return model


def mirror():
    model = Model("mirror")
    model.add(Material("silver", linear("#dfe5e8"), metallic=1.0, roughness=0.08), turned(picture(1.0, 1.5), "z", 180),
              (0, 0, 0.85))
    model.add(_paint("mirror frame", "#3b3f42"), box(0.04, 1.1, 1.6), (0.03, 0, 0.85))
    return model


def sign():
    model = Model("sign")
    model.add(_paint("sign face", "#f2b321"), turned(cylinder(0.32, 0.02, 40), "y", -90), (0, 0, 0))
    return model


def models():
    made = [yard(), ball(), fence(), pane(), sails(), mirror(), sign()]
    for model in made:
        model.check()
    return made
