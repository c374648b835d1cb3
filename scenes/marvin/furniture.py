"""Tables, chairs, shelves, cupboards. Origin on the floor; the side that one uses faces +x, a chair's sitter looks +x.
Tables stand around their origin; what stands against a wall has its back at x = 0."""
import math
import random

import materials as m
from pictures import BOOK_COLUMNS
from shapes import (Model, box, cylinder, filleted, lathe, moved, quad, rounded_box, rounded_rectangle, slab,
                    subdivided, tube, turned, warped)

TABLE_HEIGHT = 0.74


def table():
    """0.8 x 1.6 m, on two columns with feet."""
    model = Model("table")
    model.add(m.TABLE_WOOD, slab(rounded_rectangle(0.8, 1.6, 0.04, 5), 0.028, 0.006), (0, 0, TABLE_HEIGHT - 0.028),
              swap=True)
    for side in (-1, 1):
        y = side * 0.64
        model.add(m.DARK_STEEL, rounded_box(0.7, 0.07, 0.03, 0.012, 1), (0, y, 0.027))
        model.add(m.STEEL, rounded_box(0.09, 0.05, 0.66, 0.012, 1), (-0.05, y, 0.37))
        model.add(m.DARK_STEEL, rounded_box(0.62, 0.06, 0.025, 0.008, 1), (0, y, 0.699))
        for x in (-0.31, 0.31):
            model.add(m.RUBBER, cylinder(0.022, 0.014, 10), (x, y, 0))
    model.add(m.STEEL, rounded_box(0.03, 1.24, 0.05, 0.008, 1), (-0.05, 0, 0.66))
    model.add(m.LACQUER, rounded_box(0.018, 1.16, 0.34, 0.005, 1), (-0.16, 0, 0.5))
    model.add(m.STEEL, box(0.08, 0.05, 0.02), (-0.12, -0.3, 0.6))
    model.add(m.STEEL, box(0.08, 0.05, 0.02), (-0.12, 0.3, 0.6))
    model.add(m.BLACK, cylinder(0.04, 0.004, 20), (-0.3, 0.45, TABLE_HEIGHT))
    return model


def round_table():
    model = Model("round_table")
    model.add(m.TABLE_WOOD, cylinder(0.6, 0.03, 48, 0.008), (0, 0, TABLE_HEIGHT - 0.03))
    model.add(m.DARK_STEEL, lathe([(0, 0), (0.3, 0), (0.3, 0.012), (0.28, 0.02), (0.07, 0.035), (0.045, 0.06),
                                   (0.04, 0.1), (0.04, 0.66), (0.09, 0.70), (0.2, 0.71), (0, 0.71)], 32))
    return model


def _cushion(sx, sy, sz, radius, bend):
    return warped(subdivided(rounded_box(sx, sy, sz, radius, 2)), bend)


def _caster():
    """A wheel whose axle runs along y, behind a swivel at the origin."""
    wheel = lathe([(0, -0.025), (0.022, -0.025), (0.027, -0.02), (0.027, 0.02), (0.022, 0.025), (0, 0.025)], 12)
    return moved(turned(wheel, "x", 90), -0.015, 0, 0.027)


def swivel_chair():
    model = Model("swivel_chair")
    for i in range(5):
        angle = 72 * i + 36
        spoke = warped(rounded_box(0.30, 0.05, 0.034, 0.012, 1),
                       lambda p: (p[0], p[1] * (1.05 - 1.1 * (p[0] + 0.15)), p[2] - 0.12 * (p[0] + 0.15)))
        model.add(m.BLACK, turned(moved(spoke, 0.16, 0, 0.1), "z", angle))
        caster = moved(turned(_caster(), "z", 40 * i), 0.29, 0, 0)
        model.add(m.RUBBER, turned(caster, "z", angle))
        model.add(m.STEEL, turned(moved(cylinder(0.008, 0.035, 8), 0.29, 0, 0.045), "z", angle))
    model.add(m.BLACK, lathe([(0, 0.075), (0.05, 0.075), (0.05, 0.11), (0.035, 0.14), (0.028, 0.28), (0.022, 0.29),
                              (0, 0.29)], 20))
    model.add(m.CHROME, cylinder(0.016, 0.14, 16), (0, 0, 0.285))
    model.add(m.BLACK, rounded_box(0.24, 0.18, 0.05, 0.02, 2), (0, 0, 0.425))
    model.add(m.CHROME, tube([(0.02, -0.08, 0.425), (0.02, -0.21, 0.425)], 0.006, 8))
    model.add(m.SEAT_BLUE, _cushion(0.47, 0.48, 0.085, 0.04, lambda p: (
        p[0], p[1] * (1 - 0.12 * (0.235 - p[0])), p[2] - 0.35 * max(0.0, p[0] - 0.05) ** 2 * 1.5)), (0.02, 0, 0.485))
    bar = filleted([(-0.08, 0, 0.43), (-0.27, 0, 0.43), (-0.275, 0, 0.80)], 0.07, 6)
    model.add(m.BLACK, tube(bar, 0.02, 10))
    back = _cushion(0.06, 0.45, 0.52, 0.028, lambda p: (
        p[0] + 1.1 * p[1] ** 2 - 0.35 * (p[2] + 0.1) ** 2, p[1] * (1 - 0.18 * (p[2] + 0.26)), p[2]))
    model.add(m.SEAT_BLUE, turned(back, "y", -8), (-0.235, 0, 0.82))
    for side in (-1, 1):
        arm = filleted([(-0.02, side * 0.1, 0.43), (-0.02, side * 0.28, 0.43), (-0.02, side * 0.28, 0.66)], 0.05, 4)
        model.add(m.BLACK, tube(arm, 0.014, 7))
        model.add(m.BLACK, rounded_box(0.25, 0.075, 0.03, 0.012, 1), (0.0, side * 0.28, 0.672))
    return model


def visitor_chair():
    """A bent steel tube that carries a seat and a back."""
    model = Model("visitor_chair")
    r, w = 0.0125, 0.22
    side = [(-0.25, w, 0.82), (-0.19, w, 0.45), (0.22, w, 0.45), (0.24, w, r), (-0.22, w, r)]
    path = filleted(side + [(x, -y, z) for x, y, z in reversed(side)], 0.05, 5)
    model.add(m.CHROME, tube(path, r, 8))
    model.add(m.CHROME, tube([(0.15, -w, 0.445), (0.15, w, 0.445)], 0.009, 8))
    model.add(m.CHROME, tube([(-0.14, -w, 0.445), (-0.14, w, 0.445)], 0.009, 8))
    model.add(m.SEAT_RED, _cushion(0.44, 0.42, 0.05, 0.022, lambda p: (
        p[0], p[1], p[2] - 0.5 * max(0.0, p[0] - 0.08) ** 2)), (0.01, 0, 0.478))
    model.add(m.SEAT_RED, turned(_cushion(0.04, 0.42, 0.28, 0.018, lambda p: (p[0] + 0.7 * p[1] ** 2, p[1], p[2])),
                                 "y", -9), (-0.252, 0, 0.74))
    return model


def _book(thickness, height, depth, column):
    """Stands on z = 0, spine at x = 0 towards +x, from y = 0 to `thickness`. Gives (cover, pages)."""
    u0, u1 = column / BOOK_COLUMNS, (column + 1) / BOOK_COLUMNS
    t, h, d = thickness, height, depth
    plain = [(u0 + 0.006, 0.5)] * 4  # a bare place of the spine's cloth
    cover = quad([(0, 0, 0), (0, t, 0), (0, t, h), (0, 0, h)], uvs=[(u0, 1), (u1, 1), (u1, 0), (u0, 0)])
    cover += quad([(-d, 0, 0), (0, 0, 0), (0, 0, h), (-d, 0, h)], uvs=plain)
    cover += quad([(0, t, 0), (-d, t, 0), (-d, t, h), (0, t, h)], uvs=plain)
    pages = quad([(0, 0, h), (0, t, h), (-d, t, h), (-d, 0, h)]) + quad([(0, 0, 0), (-d, 0, 0), (-d, t, 0), (0, t, 0)])
    pages += quad([(-d, t, 0), (-d, 0, 0), (-d, 0, h), (-d, t, h)])
    return cover, pages


def _row_of_books(model, rng, x, y, y_end, z, clearance):
    while True:
        thickness = rng.uniform(0.02, 0.05)
        if y + thickness > y_end:
            return
        height = rng.uniform(0.62, 0.88) * clearance
        cover, pages = _book(thickness - 0.0008, height, rng.uniform(0.16, 0.21), rng.randrange(BOOK_COLUMNS))
        at = (x - rng.uniform(0.0, 0.02), y, z)
        model.add(m.BOOK, cover, at)
        model.add(m.PAPER, pages, at)
        y += thickness


def _storage_box(model, rng, x, y, z, width, height):
    color = rng.choice((m.BOX_BLUE, m.BOX_GREEN, m.BOX_GREY))
    model.add(color, rounded_box(0.24, width, height * 0.85, 0.012, 1), (x - 0.12, y, z + height * 0.425))
    model.add(color, rounded_box(0.255, width + 0.012, 0.03, 0.01, 1), (x - 0.12, y, z + height * 0.85 + 0.0))
    model.add(m.PAPER, box(0.004, 0.09, 0.05), (x + 0.001, y, z + height * 0.45))


def shelf(name, seed, kinds):
    """1.0 m wide, 2.0 m high; `kinds` says per board from below what stands there: b books, x boxes, m mixed."""
    model = Model(name)
    rng = random.Random(seed)
    width, depth, height, t = 1.0, 0.32, 2.0, 0.022
    for side in (-1, 1):
        model.add(m.TABLE_WOOD, rounded_box(depth, t, height, 0.003, 1),
                  (depth / 2, side * (width - t) / 2, height / 2), swap=True)
    inner = width - 2 * t
    model.add(m.LACQUER, box(0.008, inner, height - 0.08), (0.006, 0, height / 2 + 0.03))
    pitch = (height - 0.08 - t) / len(kinds)
    for i in range(len(kinds) + 1):
        model.add(m.TABLE_WOOD, rounded_box(depth - 0.012, inner, t, 0.003, 1),
                  (depth / 2 + 0.004, 0, 0.08 + t / 2 + i * pitch), swap=True)
    model.add(m.TABLE_WOOD, box(0.02, inner, 0.08), (depth - 0.04, 0, 0.04), swap=True)
    for i, kind in enumerate(kinds):
        z, clearance, front = 0.08 + t + i * pitch, pitch - t, depth - 0.03
        if kind in "bm":
            end = inner / 2 - 0.01 if kind == "b" else -0.05
            _row_of_books(model, rng, front, -inner / 2 + 0.004, end - rng.uniform(0.0, 0.12), z, clearance)
        if kind == "m":
            _storage_box(model, rng, front, 0.24, z, 0.32, clearance * 0.8)
        if kind == "x":
            for y in (-0.31, 0.0, 0.31):
                if rng.random() < 0.85:
                    _storage_box(model, rng, front, y, z, 0.27, clearance * rng.uniform(0.6, 0.9))
    return model


def cupboard():
    """1.0 m wide, 1.15 m high, two doors."""
    model = Model("cupboard")
    width, depth, height = 1.0, 0.45, 1.15
    model.add(m.BLACK, box(depth - 0.05, width - 0.06, 0.07), (depth / 2 - 0.01, 0, 0.035))
    model.add(m.LACQUER, rounded_box(depth - 0.024, width, height - 0.07, 0.004, 1),
              ((depth - 0.024) / 2, 0, 0.07 + (height - 0.07) / 2))
    for side in (-1, 1):
        model.add(m.LACQUER_TEAL, rounded_box(0.02, width / 2 - 0.006, height - 0.1, 0.004, 1),
                  (depth - 0.013, side * width / 4, 0.07 + (height - 0.07) / 2))
        handle = filleted([(0, 0, -0.08), (0.035, 0, -0.08), (0.035, 0, 0.08), (0, 0, 0.08)], 0.015, 3)
        model.add(m.CHROME, tube(handle, 0.006, 8), (depth - 0.004, side * 0.06, 0.72))
    model.add(m.TABLE_WOOD, rounded_box(depth + 0.01, width + 0.02, 0.025, 0.006, 1),
              ((depth + 0.01) / 2, 0, height + 0.0125), swap=True)
    return model


def carpet():
    """A round one, for under the round table."""
    model = Model("carpet")
    model.add(m.CARPET_RIM, lathe([(0, 0), (1.345, 0), (1.35, 0.003), (1.343, 0.008), (0, 0.008)], 64))
    model.add(m.CARPET, lathe([(0, 0.004), (1.28, 0.004), (1.278, 0.0105), (0, 0.0105)], 64))
    return model


def stool():
    model = Model("stool")
    model.add(m.TABLE_WOOD, cylinder(0.17, 0.035, 28, 0.01), (0, 0, 0.47))
    for i in range(4):
        a = math.radians(45 + 90 * i)
        c, s = math.cos(a), math.sin(a)
        model.add(m.DARK_STEEL, tube([(0.2 * c, 0.2 * s, 0.0), (0.12 * c, 0.12 * s, 0.475)], 0.012, 10))
    ring = [(0.173 * math.cos(math.pi * i / 12), 0.173 * math.sin(math.pi * i / 12), 0.16) for i in range(25)]
    model.add(m.DARK_STEEL, tube(ring, 0.007, 8))
    return model
