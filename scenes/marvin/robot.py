"""Marvin, an indoor robot: origin on the floor between the drive wheels, x forward.

The laser scanners' places are stated here and again in marvin.xml. Around a scan plane the robot leaves its scanner
free sight: the window lies behind the mount, hood and foot above and below the plane.
"""
import math

import materials as m
from shapes import (Model, box, cylinder, filleted, lathe, moved, rounded_box, rounded_rectangle, slab, sphere, tube,
                    turned)

SCAN_HEIGHT = 0.10  # of the front and rear scanners' planes
SCANNER_X = 0.33  # their mounts, before and behind the middle
TILT_AXIS = (0.10, 0.0, 1.0)  # of the upper scanner's joint; it turns about y
TILT_SCANNER_X = 0.14  # the mount, before the joint's axis
LENGTH, WIDTH = 0.72, 0.62  # of the whole robot, seen from above


def _scanner_housing(scale_height):
    """A scanner that looks along +x: foot, window and hood; the mount's place is the origin, the plane z = 0.

    Nothing of it stands before x = 0 between hood and foot, which reach 3 cm further.
    """
    model = Model("scanner")
    depth, x = 0.13, -0.035
    h = scale_height
    model.add(m.SCANNER_YELLOW, slab(rounded_rectangle(depth, 0.16, 0.02, 4), 0.075 * h, 0.008),
              (x, 0, 0.032))
    model.add(m.BLACK, slab(rounded_rectangle(depth, 0.16, 0.02, 4), 0.036, 0.006), (x, 0, -0.068))
    window = slab(rounded_rectangle(0.085, 0.13, 0.04, 6), 0.068, 0.002)
    model.add(m.SCANNER_WINDOW, window, (x - 0.028, 0, -0.034))
    model.add(m.BLACK, box(0.002, 0.06, 0.014), (x + depth / 2, 0, 0.032 + 0.04 * h))
    model.add(m.STATUS, turned(cylinder(0.004, 0.003, 10), "y", 90), (x + depth / 2 - 0.001, 0.055, 0.032 + 0.04 * h))
    return model


def _drive_wheel():
    """About the y axis."""
    tyre = lathe([(0, -0.024), (0.07, -0.024), (0.112, -0.024), (0.125, -0.016), (0.13, -0.006), (0.13, 0.006),
                  (0.125, 0.016), (0.112, 0.024), (0.085, 0.024), (0.08, 0.016), (0, 0.016)], 32, 40)
    model = Model("wheel")
    model.add(m.RUBBER, turned(tyre, "x", -90))
    hub = lathe([(0, 0.015), (0.08, 0.015), (0.078, 0.02), (0.045, 0.022), (0.03, 0.032), (0, 0.034)], 28)
    model.add(m.ALUMINIUM, turned(hub, "x", -90))
    for i in range(5):
        a = 2 * math.pi * i / 5
        model.add(m.DARK_STEEL, turned(cylinder(0.006, 0.006, 8), "x", -90),
                  (0.06 * math.cos(a), 0.0205, 0.06 * math.sin(a)))
    return model


def _caster_wheel(x, y):
    model = Model("caster")
    wheel = lathe([(0, -0.012), (0.03, -0.012), (0.036, -0.006), (0.036, 0.006), (0.03, 0.012), (0, 0.012)], 16)
    model.add(m.RUBBER, turned(wheel, "x", 90), (x, y, 0.036))
    for side in (-1, 1):
        model.add(m.STEEL, rounded_box(0.03, 0.004, 0.06, 0.0015, 1), (x, y + side * 0.017, 0.058))
    model.add(m.STEEL, cylinder(0.022, 0.012, 14, 0.003), (x, y, 0.082))
    return model


def _base(model):
    """Chassis between the wheels, deck above, scanners in the recesses under the deck's ends."""
    model.add(m.CHASSIS, rounded_box(0.44, 0.46, 0.16, 0.02, 2), (0, 0, 0.145))
    model.add(m.CHASSIS, slab(rounded_rectangle(0.66, 0.56, 0.09, 6), 0.06, 0.012), (0, 0, 0.22))
    model.add(m.ORANGE, slab(rounded_rectangle(0.67, 0.58, 0.095, 8), 0.085, 0.022, 3), (0, 0, 0.275))
    model.add(m.CHASSIS, slab(rounded_rectangle(0.58, 0.49, 0.07, 6), 0.012, 0.004), (0, 0, 0.356))
    model.add(m.RUBBER, slab(rounded_rectangle(0.69, 0.60, 0.1, 8), 0.022, 0.009), (0, 0, 0.238))
    wheel = _drive_wheel()
    for side in (-1, 1):
        place = lambda shape, s=side: moved(turned(shape, "z", 0 if s > 0 else 180), 0, s * 0.272, 0.13)
        model.merge(wheel, place)
        for x in (-0.17, 0.17):
            model.merge(_caster_wheel(x, side * 0.19))
        for i in range(6):
            model.add(m.HOLE, box(0.05, 0.003, 0.005), (0.21, side * 0.2905, 0.29 + 0.010 * i))
        model.add(m.SHELL, rounded_box(0.30, 0.004, 0.035, 0.0015, 1), (-0.03, side * 0.2905, 0.318))
    housing = _scanner_housing(1.0)
    for yaw, x in ((0, SCANNER_X), (180, -SCANNER_X)):
        model.merge(housing, lambda shape, yaw=yaw, x=x: moved(turned(shape, "z", yaw), x, 0, SCAN_HEIGHT))
    model.add(m.STATUS, rounded_box(0.006, 0.12, 0.012, 0.002, 1), (0.334, 0, 0.325))
    model.add(m.FIRE_RED, rounded_box(0.006, 0.12, 0.012, 0.002, 1), (-0.334, 0, 0.325))


def _rack(model):
    """Four profiles that carry the computers and the torso."""
    for x in (-0.17, 0.05):
        for y in (-0.17, 0.17):
            model.add(m.ALUMINIUM, rounded_box(0.03, 0.03, 0.48, 0.004, 1), (x, y, 0.607))
    for z in (0.47, 0.63):
        model.add(m.STEEL, rounded_box(0.25, 0.37, 0.008, 0.003, 1), (-0.06, 0, z))
    model.add(m.BLACK, rounded_box(0.2, 0.28, 0.085, 0.008, 1), (-0.06, 0, 0.412))
    model.add(m.GREY, rounded_box(0.2, 0.29, 0.1, 0.008, 1), (-0.06, 0, 0.526))
    model.add(m.BLACK, rounded_box(0.19, 0.26, 0.07, 0.008, 1), (-0.06, 0, 0.67))
    for i in range(6):
        model.add(m.HOLE, box(0.003, 0.2, 0.006), (0.0405, 0, 0.495 + 0.012 * i))
    for i in range(4):
        model.add(m.STATUS, box(0.003, 0.008, 0.008), (0.0405, -0.1 + 0.02 * i, 0.425))
    model.add(m.BLACK, rounded_box(0.008, 0.02, 0.02, 0.003, 1), (0.041, 0.1, 0.67))
    cable = filleted([(-0.16, 0.1, 0.4), (-0.2, 0.1, 0.4), (-0.2, 0.06, 0.68), (-0.15, 0.06, 0.68)], 0.025, 5)
    model.add(m.RUBBER, tube(cable, 0.006, 8))
    model.add(m.ORANGE, tube(moved_path(cable, 0.0, -0.16, 0.0), 0.005, 8))


def moved_path(path, x, y, z):
    return [(p[0] + x, p[1] + y, p[2] + z) for p in path]


def _torso(model):
    """Stays behind the upper scanner's sight: all of it before x = 0.10 is the joint's two brackets."""
    model.add(m.CHASSIS, slab(rounded_rectangle(0.32, 0.42, 0.06, 6), 0.03, 0.01), (-0.06, 0, 0.84))
    model.add(m.SHELL, slab(rounded_rectangle(0.25, 0.37, 0.1, 8), 0.36, 0.05, 5), (-0.085, 0, 0.865))
    model.add(m.ORANGE, slab(rounded_rectangle(0.256, 0.376, 0.103, 8), 0.035, 0.008), (-0.085, 0, 1.12))
    model.add(m.CHASSIS, rounded_box(0.02, 0.22, 0.18, 0.008, 2), (0.04, 0, 1.0))
    for side in (-1, 1):
        model.add(m.ALUMINIUM, rounded_box(0.09, 0.012, 0.06, 0.005, 2), (TILT_AXIS[0] - 0.025, side * 0.102, 1.0))
        model.add(m.DARK_STEEL, turned(cylinder(0.026, 0.022, 24, 0.004), "x", -90 * side),
                  (TILT_AXIS[0], side * 0.104, 1.0))
    model.add(m.FIRE_RED, turned(lathe([(0, 0), (0.018, 0), (0.018, 0.012), (0.028, 0.014), (0.03, 0.02), (0.026, 0.03),
                                        (0, 0.034)], 24), "y", -90), (-0.21, 0, 1.0))
    model.add(m.SCANNER_YELLOW, turned(cylinder(0.04, 0.006, 24, 0.002), "y", -90), (-0.207, 0, 1.0))
    antenna = [(-0.16, 0.1, 1.2), (-0.165, 0.105, 1.5)]
    model.add(m.BLACK, tube(antenna, 0.005, 8))
    model.add(m.BLACK, sphere(0.008, 10, 6), antenna[1])
    model.add(m.BLACK, cylinder(0.014, 0.03, 14, 0.004), (-0.16, 0.1, 1.195))


def _head(model):
    """A neck, and a bar with two cameras that looks 12 degrees down."""
    model.add(m.DARK_STEEL, cylinder(0.05, 0.03, 28, 0.006), (-0.06, 0, 1.215))
    model.add(m.ALUMINIUM, cylinder(0.026, 0.11, 20), (-0.06, 0, 1.24))
    model.add(m.DARK_STEEL, turned(cylinder(0.036, 0.09, 24, 0.006), "x", 90), (-0.06, 0.045, 1.355))
    head = Model("head")
    head.add(m.SHELL, rounded_box(0.12, 0.32, 0.105, 0.042, 4))
    head.add(m.CHASSIS, rounded_box(0.03, 0.27, 0.068, 0.014, 2), (0.05, 0, 0))
    for y in (-0.09, 0.09):
        barrel = lathe([(0, 0), (0.03, 0), (0.03, 0.036), (0.028, 0.04), (0.022, 0.04), (0.019, 0.03), (0, 0.03)], 28)
        head.add(m.BLACK, turned(barrel, "y", 90), (0.055, y, 0))
        head.add(m.LENS, turned(lathe([(0.0188, 0), (0.014, 0.004), (0.007, 0.006), (0, 0.0066)], 24), "y", 90),
                 (0.0851, y, 0))
        head.add(m.LENS_SHINE, turned(cylinder(0.003, 0.001, 10), "y", 90), (0.0903, y - 0.006, 0.007))
    head.add(m.STATUS, turned(cylinder(0.006, 0.004, 14), "y", 90), (0.0635, 0, 0))
    model.merge(head, lambda shape: moved(turned(shape, "y", 12), -0.03, 0, 1.43))


def robot():
    model = Model("robot")
    _base(model)
    _rack(model)
    _torso(model)
    _head(model)
    return model


def tilt_head():
    """What the tilt joint moves: origin on the joint's axis, the scanner's mount TILT_SCANNER_X before it."""
    model = Model("tilt_head")
    model.merge(_scanner_housing(0.8), lambda shape: moved(shape, TILT_SCANNER_X, 0, 0))
    model.add(m.DARK_STEEL, turned(cylinder(0.016, 0.196, 20, 0.003), "x", 90), (0, 0.098, 0))
    model.add(m.DARK_STEEL, rounded_box(0.05, 0.11, 0.06, 0.008, 2), (0.022, 0, 0))
    return model
