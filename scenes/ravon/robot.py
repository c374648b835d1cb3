"""RAVON, an off-road robot: origin on the ground in the middle between its four wheels, x forward.

The places of the joints and sensors are stated here and again in ravon.xml.
"""
import math

from gltf_writer import Material, linear
import pictures
from shapes import (Model, box, cylinder, filleted, lathe, moved, rounded_box, rounded_rectangle, slab, sphere, tube,
                    turned)
from trees import Growth, card

WHEEL_X, WHEEL_Y, WHEEL_RADIUS = 0.68, 0.62, 0.39  # contact points: (+-WHEEL_X, +-WHEEL_Y, 0)
HEAD = (0.02, 0.0, 1.84)  # where the axes of the head's pan and tilt joints meet
STEREO = (0.115, 0.15, 0.0)  # the left camera in the head's frame; the right one is its mirror image
FRONT_SCANNER = (1.20, 0.0, 0.74, 18.0)  # x, y, z, pitch: it looks down at the path
REAR_SCANNER = (-1.17, 0.0, 0.62)


def _plain(name, color, **more):
    return Material(name, linear(color), **more)


RUBBER = _plain("rubber", "#232426")
RIM = _plain("rim", "#b4b8ba")
PAINT = _plain("paint", "#d8621c")
PAINT_DARK = _plain("dark paint", "#2f3437")
FRAME = _plain("frame", "#44494c")
STEEL = _plain("steel", "#8e9498")
ALUMINIUM = _plain("aluminium", "#c2c6c8")
BLACK = _plain("black", "#1b1d1f")
CASE = _plain("case", "#dfe2e0")
YELLOW = _plain("scanner yellow", "#f0be14")
WINDOW = _plain("scanner window", "#3a0f14")
LENS = _plain("lens", "#121c2e")
GLASS = _plain("lamp glass", "#e8e6da")
RED = _plain("signal red", "#c2211c")
AMBER = Material("warning lamp", linear("#ff9a1e"), emissive=(0.45, 0.2, 0.02))
SHADE = Material("shade", texture=pictures.veil(), blend=True, unlit=True)
STATUS = Material("status light", linear("#38e07a"), emissive=(0.05, 0.6, 0.2))


def _wheel():
    """About the y axis, its outside at +y: a balloon tyre with lugs, a dished rim with bolts."""
    half, r = 0.14, WHEEL_RADIUS - 0.022
    tyre = lathe([(0.21, -half + 0.02), (0.25, -half), (0.31, -half - 0.004), (r - 0.03, -half + 0.025),
                  (r - 0.006, -half + 0.06), (r, -0.03), (r, 0.03), (r - 0.006, half - 0.06), (r - 0.03, half - 0.025),
                  (0.31, half + 0.004), (0.25, half), (0.21, half - 0.02)], 40, 40)
    model = Model("wheel")
    model.add(RUBBER, turned(tyre, "x", -90))
    for i in range(20):
        for side in (-1, 1):
            lug = turned(box(0.05, 0.115, 0.032), "z", 24 * side)
            lug = turned(moved(lug, 0, side * 0.062, WHEEL_RADIUS - 0.017), "y", 18 * i + (9 if side > 0 else 0))
            model.add(RUBBER, lug)
            shoulder = turned(moved(box(0.052, 0.022, 0.09), 0, side * (half - 0.004), WHEEL_RADIUS - 0.07), "y",
                              18 * i + (9 if side > 0 else 0))
            model.add(RUBBER, shoulder)
    model.add(RIM, turned(lathe([(0.215, 0.10), (0.215, 0.125), (0.195, 0.115), (0.165, 0.055), (0.10, 0.04),
                                 (0, 0.035)], 32, 30), "x", -90))
    model.add(FRAME, turned(cylinder(0.21, 0.02, 28), "x", -90), (0, -0.12, 0))
    model.add(FRAME, turned(cylinder(0.06, 0.05, 20, 0.012), "x", -90), (0, 0.035, 0))
    for i in range(6):
        a = 2 * math.pi * i / 6
        model.add(STEEL, turned(cylinder(0.013, 0.018, 6), "x", -90), (0.1 * math.cos(a), 0.04, 0.1 * math.sin(a)))
    return model


def _running_gear(model):
    wheel = _wheel()
    for x in (-WHEEL_X, WHEEL_X):
        for side in (-1, 1):
            model.merge(wheel, lambda shape, x=x, s=side: moved(turned(shape, "z", 0 if s > 0 else 180), x,
                                                                s * WHEEL_Y, WHEEL_RADIUS))
            for dx in (-0.11, 0.11):
                for z0, z1 in ((0.37, 0.33), (0.50, 0.43)):
                    model.add(FRAME, tube([(x + dx, side * 0.26, z0), (x + dx * 0.3, side * 0.50, z1)], 0.017, 8))
            spring = [(x + 0.028 * math.cos(k * 1.1), side * (0.33 + 0.0032 * k) + 0.028 * math.sin(k * 1.1),
                       0.68 - 0.0068 * k) for k in range(42)]
            model.add(RED, tube(spring, 0.008, 5))
            model.add(STEEL, tube([(x, side * 0.32, 0.70), (x, side * 0.47, 0.38)], 0.014, 8))
        model.add(FRAME, turned(cylinder(0.06, 0.56, 16, 0.01), "x", 90), (x, 0.28, 0.42))
    model.add(FRAME, rounded_box(1.75, 0.46, 0.14, 0.02, 1), (0, 0, 0.46))


def _body(model):
    model.add(PAINT_DARK, slab(rounded_rectangle(2.02, 0.78, 0.07, 4), 0.14, 0.02), (0, 0, 0.56))
    model.add(PAINT, slab(rounded_rectangle(0.74, 0.74, 0.10, 6), 0.26, 0.06, 4), (0.63, 0, 0.69))
    model.add(PAINT, slab(rounded_rectangle(1.18, 0.80, 0.08, 6), 0.36, 0.05, 4), (-0.38, 0, 0.69))
    model.add(PAINT_DARK, slab(rounded_rectangle(0.96, 0.60, 0.06, 6), 0.02, 0.006), (-0.38, 0, 1.045))
    for side in (-1, 1):
        for i in range(7):
            model.add(BLACK, box(0.20, 0.006, 0.012), (-0.62, side * 0.4015, 0.78 + 0.026 * i))
        model.add(PAINT_DARK, rounded_box(0.36, 0.012, 0.20, 0.005, 1), (-0.16, side * 0.402, 0.86))
        model.add(ALUMINIUM, rounded_box(0.05, 0.014, 0.02, 0.004, 1), (-0.02, side * 0.409, 0.86))
        for x in (-WHEEL_X, WHEEL_X):  # mudguards
            path = [(x + 0.47 * math.cos(a), side * 0.60, 0.40 + 0.46 * math.sin(a))
                    for a in (math.radians(25 + 13 * k) for k in range(11))]
            for a, b in zip(path, path[1:]):
                middle, angle = [(p + q) / 2 for p, q in zip(a, b)], math.degrees(math.atan2(b[2] - a[2], b[0] - a[0]))
                model.add(PAINT_DARK, turned(box(0.122, 0.30, 0.012), "y", -angle), middle)
        model.add(GLASS, turned(cylinder(0.045, 0.03, 20, 0.008), "y", 90), (0.985, side * 0.27, 0.80))
        model.add(BLACK, turned(cylinder(0.054, 0.02, 20, 0.004), "y", 90), (0.98, side * 0.27, 0.80))
        model.add(RED, rounded_box(0.012, 0.10, 0.05, 0.004, 1), (-0.975, side * 0.29, 0.84))
        model.add(RED, turned(cylinder(0.028, 0.035, 18, 0.008), "x", -90 * side), (-0.42, side * 0.40, 0.96))
        model.add(YELLOW, turned(cylinder(0.042, 0.01, 18, 0.003), "x", -90 * side), (-0.42, side * 0.398, 0.96))
    for i in range(5):
        model.add(BLACK, box(0.16, 0.34, 0.008), (0.62, 0, 0.952 + 0.0001 * i))
    model.add(STATUS, rounded_box(0.01, 0.16, 0.02, 0.004, 1), (0.212, 0, 0.99))


def _bumper(model, sign):
    """A padded bar, and the tube that guards it."""
    bar = slab(rounded_rectangle(0.10, 1.18, 0.045, 5), 0.15, 0.03, 3)
    model.add(BLACK, bar, (sign * 1.10, 0, 0.40))
    for y in (-0.42, -0.14, 0.14, 0.42):
        model.add(YELLOW, turned(box(0.104, 0.05, 0.14), "x", 28), (sign * 1.10, y, 0.475))
    for y in (-0.3, 0.3):
        model.add(FRAME, rounded_box(0.16, 0.06, 0.06, 0.01, 1), (sign * 1.0, y, 0.48))
    guard = filleted([(sign * 0.98, -0.5, 0.6), (sign * 1.16, -0.5, 0.66), (sign * 1.16, 0.5, 0.66),
                      (sign * 0.98, 0.5, 0.6)], 0.06, 4)
    if sign > 0:
        model.add(STEEL, tube(guard, 0.02, 10))


def _scanner():
    """Looks along +x; its mount is the origin. Nothing stands before the window."""
    model = Model("scanner")
    model.add(YELLOW, slab(rounded_rectangle(0.15, 0.17, 0.025, 4), 0.10, 0.01), (-0.06, 0, 0.036))
    model.add(YELLOW, slab(rounded_rectangle(0.15, 0.17, 0.025, 4), 0.05, 0.008), (-0.06, 0, -0.086))
    model.add(WINDOW, slab(rounded_rectangle(0.10, 0.14, 0.045, 6), 0.076, 0.002), (-0.06, 0, -0.038))
    model.add(BLACK, box(0.002, 0.09, 0.03), (0.016, 0, 0.085))
    return model


def _tower(model):
    """Four posts on the rear deck, a case with computers, a plate with aerials; it carries the head."""
    for x in (-0.62, -0.06):
        for y in (-0.24, 0.24):
            model.add(ALUMINIUM, rounded_box(0.04, 0.04, 0.66, 0.005, 1), (x, y, 1.39))
    for z in (1.12, 1.70):
        model.add(FRAME, rounded_box(0.64, 0.56, 0.03, 0.008, 1), (-0.34, 0, z))
    model.add(CASE, slab(rounded_rectangle(0.46, 0.40, 0.03, 4), 0.36, 0.015), (-0.34, 0, 1.145))
    for i in range(9):
        model.add(FRAME, box(0.3, 0.003, 0.012), (-0.34, 0.2012, 1.22 + 0.026 * i))
        model.add(FRAME, box(0.3, 0.003, 0.012), (-0.34, -0.2012, 1.22 + 0.026 * i))
    for side in (-1, 1):
        model.add(STEEL, tube([(-0.62, side * 0.262, 1.12), (-0.06, side * 0.262, 1.69)], 0.012, 8))
    model.add(ALUMINIUM, rounded_box(0.16, 0.3, 0.03, 0.006, 1), (-0.02, 0, 1.715))
    model.add(PAINT_DARK, cylinder(0.07, 0.05, 28, 0.01), (HEAD[0], 0, 1.725))
    model.add(CASE, lathe([(0, 0), (0.085, 0), (0.09, 0.02), (0.07, 0.05), (0, 0.062)], 28), (-0.52, 0.14, 1.78))
    model.add(BLACK, cylinder(0.03, 0.07, 16), (-0.52, 0.14, 1.715))
    model.add(AMBER, cylinder(0.045, 0.085, 20, 0.015), (-0.52, -0.16, 1.735))
    model.add(BLACK, cylinder(0.05, 0.025, 20, 0.004), (-0.52, -0.16, 1.712))
    for y in (-0.25, 0.25):
        model.add(BLACK, tube([(-0.63, y, 1.70), (-0.65, y * 1.04, 2.35)], 0.007, 8))
        model.add(BLACK, sphere(0.012, 10, 6), (-0.65, y * 1.04, 2.35))
    cable = filleted([(-0.1, 0.12, 1.70), (-0.1, 0.21, 1.66), (-0.09, 0.22, 1.2), (-0.14, 0.2, 1.14)], 0.03, 4)
    model.add(BLACK, tube(cable, 0.009, 8))


def robot():
    model = Model("robot")
    _running_gear(model)
    _body(model)
    for sign in (-1, 1):
        _bumper(model, sign)
    _tower(model)
    x, y, z, pitch = FRONT_SCANNER
    model.merge(_scanner(), lambda shape: moved(turned(shape, "y", pitch), x, y, z))
    for side in (-1, 1):
        model.add(FRAME, tube([(0.98, side * 0.1, 0.62), (x - 0.07, side * 0.1, z - 0.02)], 0.014, 8))
    model.add(FRAME, rounded_box(0.03, 0.24, 0.1, 0.006, 1), (x - 0.15, 0, z))
    x, y, z = REAR_SCANNER
    model.merge(_scanner(), lambda shape: moved(turned(shape, "z", 180), x, y, z))
    model.add(FRAME, rounded_box(0.16, 0.14, 0.1, 0.01, 1), (-1.02, 0, 0.60))
    return model


def head():
    """What pan and tilt move: a bar with two cameras, between the brackets of the tilt joint."""
    model = Model("head")
    model.add(PAINT_DARK, rounded_box(0.10, 0.12, 0.09, 0.012, 2), (0, 0, -0.02))
    model.add(CASE, rounded_box(0.12, 0.46, 0.10, 0.03, 3), (0.03, 0, 0.0))
    model.add(BLACK, rounded_box(0.02, 0.42, 0.07, 0.008, 2), (0.086, 0, 0))
    for side in (-1, 1):
        barrel = lathe([(0, 0), (0.032, 0), (0.032, 0.020), (0.030, 0.024), (0.024, 0.024), (0.021, 0.012), (0, 0.012)],
                       28)
        model.add(FRAME, turned(barrel, "y", 90), (0.090, side * STEREO[1], 0))
        model.add(LENS, turned(lathe([(0.0208, 0), (0.015, 0.004), (0.008, 0.0062), (0, 0.0068)], 24), "y", 90),
                  (0.1025, side * STEREO[1], 0))
    model.add(STATUS, turned(cylinder(0.008, 0.006, 14), "y", 90), (0.094, 0, 0))
    model.add(PAINT, rounded_box(0.13, 0.48, 0.012, 0.005, 1), (0.03, 0, 0.053))
    return model


def shade():
    """The shade under the robot, which moves along: a veil over the ruts and the hump between them.

    Nowhere is it half solid, so that depth cameras and lasers do not see it.
    """
    growth = Growth()
    profile = [(-1.15, 0.13), (-0.82, 0.09), (-WHEEL_Y, 0.04), (-0.38, 0.08), (0.0, 0.11), (0.38, 0.08),
               (WHEEL_Y, 0.04), (0.82, 0.09), (1.15, 0.13)]
    corners = [((-1.6, y, z), (1.6, y, z)) for y, z in profile]
    uvs = [((0, (y + 1.15) / 2.3), (1, (y + 1.15) / 2.3)) for y, _ in profile]
    card(growth, SHADE, corners, uvs, lambda p: (0, 0, 1), lambda p: (1, 1, 1))
    return growth.list()
