"""What stands on tables and hangs on walls. On tables: origin at the foot, front to +x. On walls: origin on the wall's
surface, looking into the room along +x."""
import math
import random

import materials as m
from shapes import (Model, along, box, cylinder, filleted, lathe, moved, picture, quad, rounded_box, sphere, tube,
                    turned, unit, cross, sub)


def monitor(name, screen):
    """0.54 m wide; the screen's middle is 0.33 m above the table."""
    model = Model(name)
    head = rounded_box(0.03, 0.54, 0.335, 0.01, 1)
    model.add(m.BLACK, turned(head, "y", -5), (0, 0, 0.33))
    model.add(screen, turned(moved(picture(0.515, 0.305), 0.0158, 0, 0.005), "y", -5), (0, 0, 0.33))
    model.add(m.DARK_STEEL, turned(rounded_box(0.03, 0.2, 0.14, 0.012, 1), "y", -5), (-0.022, 0, 0.32))
    model.add(m.STEEL, tube(filleted([(-0.075, 0, 0.0), (-0.075, 0, 0.3), (-0.01, 0, 0.32)], 0.04, 4), 0.018, 12))
    model.add(m.STEEL, lathe([(0, 0), (0.11, 0), (0.11, 0.006), (0.1, 0.012), (0, 0.012)], 28), (-0.05, 0, 0))
    return model


def computer():
    """A tower, on the floor."""
    model = Model("computer")
    model.add(m.BLACK, rounded_box(0.42, 0.18, 0.4, 0.008, 1), (0, 0, 0.215))
    model.add(m.DARK_STEEL, rounded_box(0.02, 0.165, 0.385, 0.008, 1), (0.212, 0, 0.215))
    model.add(m.GREY, rounded_box(0.008, 0.14, 0.035, 0.003, 1), (0.222, 0, 0.36))
    model.add(m.STATUS, turned(cylinder(0.006, 0.005, 12), "y", 90), (0.22, -0.05, 0.3))
    model.add(m.CHROME, turned(cylinder(0.014, 0.005, 16), "y", 90), (0.22, 0.05, 0.3))
    for i in range(7):
        model.add(m.HOLE, box(0.004, 0.12, 0.006), (0.2215, 0, 0.08 + 0.02 * i))
    for x in (-0.16, 0.16):
        for y in (-0.07, 0.07):
            model.add(m.RUBBER, cylinder(0.015, 0.016, 8), (x, y, 0))
    return model


def keyboard():
    """With a mouse at its right."""
    model = Model("keyboard")
    model.add(m.BLACK, rounded_box(0.15, 0.44, 0.018, 0.006, 1), (0, 0, 0.010))
    keys = quad([(0.066, -0.21, 0), (0.066, 0.21, 0), (-0.066, 0.21, 0), (-0.066, -0.21, 0)],
                uvs=[(0, 1), (1, 1), (1, 0), (0, 0)])
    model.add(m.KEYS, keys, (0, 0, 0.0196))
    model.add(m.BLACK, rounded_box(0.105, 0.06, 0.034, 0.0165, 2), (0.0, 0.32, 0.018))
    return model


def mug():
    model = Model("mug")
    model.add(m.MUG, lathe([(0, 0), (0.036, 0), (0.040, 0.006), (0.041, 0.09), (0.039, 0.093), (0.037, 0.09),
                            (0.036, 0.012), (0, 0.01)], 24))
    model.add(m.COFFEE, cylinder(0.0364, 0.002, 24), (0, 0, 0.068))
    handle = [(0, -0.037 - 0.028 * math.sin(math.pi * i / 10), 0.048 + 0.028 * math.cos(math.pi * i / 10))
              for i in range(11)]
    model.add(m.MUG, tube(handle, 0.0055, 8))
    return model


def oscilloscope():
    model = Model("oscilloscope")
    model.add(m.LIGHT_GREY, rounded_box(0.22, 0.36, 0.2, 0.015, 2), (0, 0, 0.112))
    model.add(m.DARK_STEEL, rounded_box(0.01, 0.21, 0.15, 0.004, 1), (0.11, -0.06, 0.115))
    model.add(m.SCAN_SCREEN, picture(0.19, 0.13), (0.1158, -0.06, 0.115))
    for i in range(3):
        for k in range(2):
            model.add(m.DARK_STEEL, turned(cylinder(0.014, 0.022, 16), "y", 90),
                      (0.105, 0.08 + 0.045 * k, 0.06 + 0.045 * i))
    for y in (-0.13, 0.13):
        model.add(m.RUBBER, cylinder(0.014, 0.016, 8), (0.07, y, 0))
        model.add(m.RUBBER, cylinder(0.014, 0.016, 8), (-0.07, y, 0))
    lever = filleted([(0, -0.19, 0.1), (0, -0.19, 0.25), (0, 0.19, 0.25), (0, 0.19, 0.1)], 0.03, 4)
    model.add(m.BLACK, tube(lever, 0.008, 8))
    return model


def cardboard_box():
    """0.4 x 0.5 x 0.32 m, closed with tape."""
    model = Model("cardboard_box")
    model.add(m.CARDBOARD, rounded_box(0.4, 0.5, 0.32, 0.004, 1), (0, 0, 0.16))
    model.add(m.TAPE, box(0.402, 0.05, 0.001), (0, 0, 0.3205))
    for side in (-1, 1):
        model.add(m.TAPE, box(0.001, 0.05, 0.06), (side * 0.2005, 0, 0.291))
        model.add(m.PAPER, box(0.1, 0.001, 0.07), (0.06, side * 0.2505, 0.2))
    return model


def waste_bin():
    model = Model("waste_bin")
    model.add(m.DARK_STEEL, lathe([(0, 0), (0.105, 0), (0.11, 0.006), (0.145, 0.31), (0.15, 0.318), (0.146, 0.324),
                                   (0.141, 0.318), (0.107, 0.012), (0, 0.01)], 28))
    for i, (x, y) in enumerate(((0.02, 0.03), (-0.04, -0.02), (0.03, -0.05))):
        model.add(m.PAPER, sphere(0.045, 7, 5), (x, y, 0.06 + 0.05 * i))
    return model


def _leaf(length, width, droop, fold=0.25):
    """A blade along +x from the origin that rises and bends down; one layer of a double-sided material."""
    steps = 6
    spine = [(length * i / steps, length * (0.45 * i / steps - droop * (i / steps) ** 2)) for i in range(steps + 1)]
    half = [width / 2 * math.sin(math.pi * (0.06 + 0.94 * i / steps)) ** 0.8 if i < steps else 0.0
            for i in range(steps + 1)]
    rows = [[(x, -w, z + fold * w), (x, 0.0, z), (x, w, z + fold * w)] for (x, z), w in zip(spine, half)]

    def normal(i, k):
        forward = sub(rows[min(i + 1, steps)][1], rows[max(i - 1, 0)][1])
        across = ((0, 1, -fold), (0, 1, 0), (0, 1, fold))[k]
        return unit(cross(forward, across))
    faces = []
    for i in range(steps):
        for k in range(2):
            corners = [(i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)]
            faces += quad([rows[a][b] for a, b in corners], [normal(a, b) for a, b in corners])
    return faces


def plant():
    """About 1.5 m high, in a pot."""
    model = Model("plant")
    rng = random.Random(17)
    model.add(m.POT, lathe([(0, 0), (0.13, 0), (0.14, 0.01), (0.18, 0.3), (0.19, 0.305), (0.19, 0.33), (0.182, 0.336),
                            (0.172, 0.33), (0.168, 0.29), (0, 0.285)], 32))
    model.add(m.SOIL, cylinder(0.168, 0.02, 32, 0.006), (0, 0, 0.27))
    for s in range(5):
        turn = 72 * s + rng.uniform(-15, 15)
        height, lean = rng.uniform(0.55, 1.0), rng.uniform(0.05, 0.16)
        c, w = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        top = (lean * c, lean * w, 0.28 + height)
        foot = (0.05 * c, 0.05 * w, 0.28)
        bent = [along(foot, top, t) for t in (0, 0.5, 1)]
        bent[1] = (bent[1][0] * 0.7, bent[1][1] * 0.7, bent[1][2])
        model.add(m.STALK, tube(bent, 0.008, 7))
        count = 7
        for i in range(count):
            at = along(bent[1], top, i / (count - 1)) if i > 1 else along(bent[0], bent[1], 0.5 + 0.4 * i)
            blade = turned(_leaf(rng.uniform(0.28, 0.42), rng.uniform(0.09, 0.14), rng.uniform(0.35, 0.7)), "y",
                           rng.uniform(-35, 5) if i < count - 1 else -55)
            model.add(rng.choice((m.LEAF, m.LEAF, m.LEAF_DARK)), turned(blade, "z", turn + 137.5 * i), at)
    return model


def whiteboard():
    """2.4 x 1.2 m, its middle at the origin's height."""
    model = Model("whiteboard")
    w, h, bar = 2.4, 1.2, 0.03
    model.add(m.GREY, box(0.014, w, h), (0.011, 0, 0))
    model.add(m.WHITEBOARD, picture(w - 2 * bar, h - 2 * bar), (0.0195, 0, 0))
    for side in (-1, 1):
        model.add(m.ALUMINIUM, rounded_box(0.026, w + 0.01, bar, 0.006, 1), (0.014, 0, side * (h - bar) / 2))
        model.add(m.ALUMINIUM, rounded_box(0.026, bar, h - 2 * bar, 0.006, 1), (0.014, side * (w - bar) / 2, 0))
    model.add(m.ALUMINIUM, rounded_box(0.08, 1.0, 0.014, 0.005, 1), (0.04, 0, -h / 2 - 0.01))
    for y, material in ((-0.3, m.MARKER), (-0.12, m.FIRE_RED), (0.05, m.BLACK)):
        model.add(material, turned(cylinder(0.009, 0.13, 12, 0.003), "x", 90), (0.05, y, -h / 2 + 0.006))
    model.add(m.BLACK, rounded_box(0.05, 0.13, 0.035, 0.01, 2), (0.045, 0.3, -h / 2 + 0.0145))
    return model


def poster():
    model = Model("poster")
    model.add(m.POSTER, picture(0.6, 0.85), (0.013, 0, 0))
    model.add(m.BLACK, box(0.012, 0.6, 0.85), (0.006, 0, 0))
    for side in (-1, 1):
        model.add(m.DARK_STEEL, rounded_box(0.022, 0.64, 0.02, 0.004, 1), (0.011, 0, side * 0.435))
        model.add(m.DARK_STEEL, rounded_box(0.022, 0.02, 0.85, 0.004, 1), (0.011, side * 0.31, 0))
    return model


def clock():
    model = Model("clock")
    rim = lathe([(0, 0), (0.155, 0), (0.16, 0.006), (0.16, 0.034), (0.154, 0.04), (0.146, 0.04), (0.142, 0.026),
                 (0, 0.026)], 36)
    model.add(m.DARK_STEEL, turned(rim, "y", 90))
    count = 36
    for i in range(count):
        a, b = 2 * math.pi * i / count, 2 * math.pi * (i + 1) / count
        points = [(0.028, 0, 0)] + [(0.028, 0.1415 * math.cos(t), 0.1415 * math.sin(t)) for t in (a, b)]
        uvs = [(0.5 + p[1] / 0.284, 0.5 - p[2] / 0.284) for p in points]
        model.add(m.CLOCK, quad([*points, points[0]], uvs=[*uvs, uvs[0]]))
    return model


def extinguisher():
    """On the wall, its foot at the origin's height."""
    model = Model("extinguisher")
    x = 0.1
    model.add(m.FIRE_RED, lathe([(0, 0), (0.07, 0), (0.078, 0.01), (0.078, 0.38), (0.07, 0.42), (0.045, 0.45),
                                 (0.025, 0.46), (0.022, 0.49), (0, 0.49)], 28), (x, 0, 0))
    model.add(m.BLACK, cylinder(0.03, 0.05, 20, 0.006), (x, 0, 0.49))
    model.add(m.BLACK, rounded_box(0.13, 0.022, 0.016, 0.005, 1), (x + 0.04, 0, 0.56))
    model.add(m.BLACK, turned(rounded_box(0.12, 0.02, 0.012, 0.004, 1), "y", -20), (x + 0.04, 0, 0.53))
    hose = filleted([(x, 0.02, 0.52), (x, 0.11, 0.52), (x, 0.11, 0.12), (x, 0.085, 0.08)], 0.05, 5)
    model.add(m.RUBBER, tube(hose, 0.011, 10))
    model.add(m.PAPER, moved(box(0.004, 0.09, 0.12), x + 0.0775, 0, 0.24))
    model.add(m.DARK_STEEL, box(0.03, 0.05, 0.3), (0.014, 0, 0.25))
    return model
