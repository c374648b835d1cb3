"""The laboratory without its furniture: a closed room of 12 x 9 x 3 m, its openings, a corridor and the view outside.

Walls: north y = 4.5 with three windows, east x = 6 with the door to the corridor, south y = -4.5 with a second door,
west x = -6. Parts that hang on a wall have their origin on its surface and look into the room along +x.
"""
import math

import materials as m
from gltf_writer import Light
from shapes import (Model, box, cylinder, filleted, grid, lathe, moved, picture, quad, rounded_box, tube, turned)

HALF_X, HALF_Y, HEIGHT = 6.0, 4.5, 3.0
WALL = 0.25
WINDOWS_X = (-3.6, 0.0, 3.6)
WINDOW_WIDTH, WINDOW_SILL, WINDOW_HEIGHT = 2.2, 0.9, 1.5
DOOR_WIDTH, DOOR_HEIGHT = 0.96, 2.08
EAST_DOOR_Y, SOUTH_DOOR_X = -2.8, -3.5


def _span(centre, width):
    return (centre - width / 2, centre + width / 2)


_WINDOWS = [(*_span(x, WINDOW_WIDTH), WINDOW_SILL, WINDOW_SILL + WINDOW_HEIGHT) for x in WINDOWS_X]
_EAST_DOOR = (*_span(EAST_DOOR_Y, DOOR_WIDTH), 0.0, DOOR_HEIGHT)
_SOUTH_DOOR = (*_span(SOUTH_DOOR_X, DOOR_WIDTH), 0.0, DOOR_HEIGHT)

# Every face of the room is cut at the same places, so that faces meet corner to corner and no seam can leak.
_X_CUTS = sorted({-HALF_X, HALF_X, *(v for w in _WINDOWS for v in w[:2]), *_SOUTH_DOOR[:2]})
_Y_CUTS = sorted({-HALF_Y, HALF_Y, *_EAST_DOOR[:2]})
_Z_CUTS = [0.0, WINDOW_SILL, DOOR_HEIGHT, WINDOW_SILL + WINDOW_HEIGHT, HEIGHT]


def _in_any(openings):
    return lambda u, v: any(o[0] < u < o[1] and o[2] < v < o[3] for o in openings)


def _reveal(place, opening, depth, normals):
    """The inner sides of an opening; `place(u, depth, v)` gives the point, `normals` the frame's u and v axes."""
    u0, u1, v0, v1 = opening
    u_axis, v_axis = normals
    minus = lambda n: tuple(-c for c in n)
    faces = []
    for u, n in ((u0, u_axis), (u1, minus(u_axis))):
        faces += grid([0, depth], [v0, v1], lambda d, v, u=u: place(u, d, v), n)
    for v, n in ((v0, v_axis), (v1, minus(v_axis))):
        faces += grid([u0, u1], [0, depth], lambda u, d, v=v: place(u, d, v), n)
    return faces


def _shell(model):
    model.add(m.FLOOR, grid(_X_CUTS, _Y_CUTS, lambda x, y: (x, y, 0), (0, 0, 1)))
    model.add(m.CEILING, grid(_X_CUTS, _Y_CUTS, lambda x, y: (x, y, HEIGHT), (0, 0, -1)))
    north = lambda x, z: (x, HALF_Y, z)
    south = lambda x, z: (x, -HALF_Y, z)
    model.add(m.WALL, grid(_X_CUTS, _Z_CUTS, north, (0, -1, 0), _in_any(_WINDOWS)))
    model.add(m.WALL, grid(_X_CUTS, _Z_CUTS, south, (0, 1, 0), _in_any([_SOUTH_DOOR])))
    model.add(m.WALL, grid(_Y_CUTS, _Z_CUTS, lambda y, z: (HALF_X, y, z), (-1, 0, 0), _in_any([_EAST_DOOR])))
    model.add(m.WALL_ACCENT, grid(_Y_CUTS, _Z_CUTS, lambda y, z: (-HALF_X, y, z), (1, 0, 0)))
    for opening in _WINDOWS:
        model.add(m.WALL, _reveal(lambda x, d, z: (x, HALF_Y + d, z), opening, WALL, ((1, 0, 0), (0, 0, 1))))
    model.add(m.DOOR_FRAME, _reveal(lambda x, d, z: (x, -HALF_Y - d, z), _SOUTH_DOOR, WALL, ((1, 0, 0), (0, 0, 1))))
    model.add(m.DOOR_FRAME, _reveal(lambda y, d, z: (HALF_X + d, y, z), _EAST_DOOR, WALL, ((0, 1, 0), (0, 0, 1))))


def _outer_faces(model):
    """What gives the walls, the floor and the roof their thickness. The south door's opening ends at the outer face."""
    x, y, z0, z1 = HALF_X + WALL, HALF_Y + WALL, -WALL, HEIGHT + WALL
    xs, ys, zs = [-x, *_X_CUTS, x], [-y, *_Y_CUTS, y], [z0, *_Z_CUTS, z1]
    model.add(m.WALL, grid(xs, zs, lambda u, v: (u, y, v), (0, 1, 0), _in_any(_WINDOWS)))
    model.add(m.WALL, grid(xs, zs, lambda u, v: (u, -y, v), (0, -1, 0), _in_any([_SOUTH_DOOR])))
    model.add(m.HOLE, grid(_SOUTH_DOOR[:2], _SOUTH_DOOR[2:], lambda u, v: (u, -y, v), (0, 1, 0)))
    model.add(m.WALL, grid(ys, zs, lambda u, v: (x, u, v), (1, 0, 0), _in_any([_EAST_DOOR])))
    model.add(m.WALL, grid(ys, zs, lambda u, v: (-x, u, v), (-1, 0, 0)))
    model.add(m.WALL, grid(xs, ys, lambda u, v: (u, v, z1), (0, 0, 1)))
    model.add(m.WALL, grid(xs, ys, lambda u, v: (u, v, z0), (0, 0, -1)))


def _corridor(model):
    """Behind the east door; closed, so that no beam leaves the house."""
    x0, x1, y0, y1, z1 = HALF_X + WALL, 8.2, -4.3, -1.3, 2.5
    ys, zs = [y0, *_EAST_DOOR[:2], y1], [0, DOOR_HEIGHT, z1]
    model.add(m.CORRIDOR_FLOOR, grid([x0, x1], ys, lambda x, y: (x, y, 0), (0, 0, 1)))
    model.add(m.CEILING, grid([x0, x1], ys, lambda x, y: (x, y, z1), (0, 0, -1)))
    model.add(m.WALL_ACCENT, grid(ys, zs, lambda y, z: (x1, y, z), (-1, 0, 0)))
    model.add(m.WALL, grid([x0, x1], zs, lambda x, z: (x, y0, z), (0, 1, 0)))
    model.add(m.WALL, grid([x0, x1], zs, lambda x, z: (x, y1, z), (0, -1, 0)))
    model.add(m.SKIRTING, box(0.015, y1 - y0, 0.08), (x1 - 0.0075, (y0 + y1) / 2, 0.04))


def _skirting(model):
    """Boards along the walls, which stop at the doors' frames."""
    frame = 0.07
    t, h = 0.016, 0.085

    def along_x(x0, x1, y):
        model.add(m.SKIRTING, box(x1 - x0, t, h), ((x0 + x1) / 2, y, h / 2))

    def along_y(y0, y1, x):
        model.add(m.SKIRTING, box(t, y1 - y0, h), (x, (y0 + y1) / 2, h / 2))
    along_x(-HALF_X, HALF_X, HALF_Y - t / 2)
    along_x(-HALF_X, _SOUTH_DOOR[0] - frame, -HALF_Y + t / 2)
    along_x(_SOUTH_DOOR[1] + frame, HALF_X, -HALF_Y + t / 2)
    along_y(-HALF_Y + t, HALF_Y - t, -HALF_X + t / 2)
    along_y(-HALF_Y + t, _EAST_DOOR[0] - frame, HALF_X - t / 2)
    along_y(_EAST_DOOR[1] + frame, HALF_Y - t, HALF_X - t / 2)


def _door_casing():
    """The frame around a door on the wall's inner face, in the frame of things that hang on a wall."""
    w, t = 0.07, 0.02
    half = DOOR_WIDTH / 2
    faces = []
    for side in (-1, 1):
        faces += moved(rounded_box(t, w, DOOR_HEIGHT + w, 0.005, 1), t / 2, side * (half + w / 2),
                       (DOOR_HEIGHT + w) / 2)
    return faces + moved(rounded_box(t, DOOR_WIDTH, w, 0.005, 1), t / 2, 0, DOOR_HEIGHT + w / 2)


def _pipes(model):
    """Heating pipes that rise in the north-east corner and run under the ceiling, and a cable tray in the west."""
    for offset, radius in ((0.1, 0.03), (0.2, 0.022)):
        path = filleted([(HALF_X - offset, HALF_Y - 0.1, 0.0), (HALF_X - offset, HALF_Y - 0.1, 2.78 - offset / 4),
                         (HALF_X - offset, -HALF_Y, 2.78 - offset / 4)], 0.12, 5)
        model.add(m.FRAME_WHITE, tube(path, radius, 12))
        for z in (0.4, 1.5, 2.4):
            model.add(m.STEEL, cylinder(radius + 0.008, 0.03, 12), (HALF_X - offset, HALF_Y - 0.1, z))
        for y in (-3.5, -1.0, 1.5, 3.5):
            model.add(m.STEEL, turned(cylinder(radius + 0.008, 0.03, 12), "x", 90),
                      (HALF_X - offset, y, 2.78 - offset / 4))
    model.add(m.GREY, rounded_box(0.12, 2 * HALF_Y, 0.06, 0.01, 1), (-HALF_X + 0.06, 0, 2.72))
    for y in (-3.0, 0.0, 3.0):
        model.add(m.GREY, rounded_box(0.05, 0.05, 0.25, 0.008, 1), (-HALF_X + 0.06, y, 2.866))


def _wall_details(model):
    """Sockets and light switches."""
    places = [((-HALF_X, y, 0.3), 0) for y in (-3.4, -0.8, 2.6)]
    places += [((x, HALF_Y, 0.3), -90) for x in (-4.9, -1.8, 1.8, 4.9)]
    places += [((HALF_X, EAST_DOOR_Y + 0.8, 1.1), 180), ((SOUTH_DOOR_X + 0.8, -HALF_Y, 1.1), 90)]
    for at, yaw in places:
        model.add(m.FRAME_WHITE, turned(rounded_box(0.016, 0.085, 0.085, 0.006, 1), "z", yaw), at)
        model.add(m.GREY, turned(rounded_box(0.024, 0.05, 0.05, 0.004, 1), "z", yaw), at)


def _view(model):
    """What the windows look out on: a bent backdrop, a meadow and the sky, closed. It is bright by itself."""
    y0, radius_x, radius_y, z0, z1 = HALF_Y + WALL, 14.0, 7.0, -1.2, 8.0
    steps = 24
    rim = [(radius_x * math.cos(math.pi * i / steps), y0 + radius_y * math.sin(math.pi * i / steps))
           for i in range(steps + 1)]
    for i, ((xa, ya), (xb, yb)) in enumerate(zip(rim, rim[1:])):
        u0, u1 = 1 - i / steps, 1 - (i + 1) / steps
        model.add(m.OUTSIDE, quad([(xb, yb, z0), (xa, ya, z0), (xa, ya, z1), (xb, yb, z1)],
                                  uvs=[(u1, 1), (u0, 1), (u0, 0), (u1, 0)]))
        model.add(m.OUTSIDE_GROUND, quad([(0, y0, z0), (xa, ya, z0), (xb, yb, z0), (0, y0, z0)]))
        model.add(m.OUTSIDE_SKY, quad([(0, y0, z1), (xb, yb, z1), (xa, ya, z1), (0, y0, z1)]))


def laboratory():
    model = Model("laboratory")
    _shell(model)
    _outer_faces(model)
    _corridor(model)
    _skirting(model)
    casing = _door_casing()
    model.add(m.DOOR_FRAME, turned(casing, "z", 180), (HALF_X, EAST_DOOR_Y, 0))
    model.add(m.DOOR_FRAME, turned(casing, "z", 90), (SOUTH_DOOR_X, -HALF_Y, 0))
    _pipes(model)
    _wall_details(model)
    _view(model)
    # Daylight through the windows. Nothing casts shadows yet, so it is faint.
    model.lights.append(Light("SUN", "directional", 0.55, (1.0, 0.95, 0.86), (0, 6, 4), (0.35, -0.75, -0.56)))
    return model


def window():
    """Frame, two sashes, panes and a sill, for an opening whose lower edge's middle on the inner wall face is 0."""
    model = Model("window")
    w, h, bar, depth = WINDOW_WIDTH, WINDOW_HEIGHT, 0.06, -0.13

    def frame(width, height, y, thickness, x, size):
        for side in (-1, 1):
            model.add(m.FRAME_WHITE, rounded_box(thickness, size, height, 0.006, 1),
                      (x, y + side * (width - size) / 2, h / 2))
            model.add(m.FRAME_WHITE, rounded_box(thickness, width - 2 * size, size, 0.006, 1),
                      (x, y, h / 2 + side * (height - size) / 2))
    frame(w, h, 0, 0.07, depth, bar)
    model.add(m.FRAME_WHITE, rounded_box(0.07, bar, h - 2 * bar, 0.006, 1), (depth, 0, h / 2))
    sash_width, sash_height = (w - 3 * bar) / 2, h - 2 * bar
    for side in (-1, 1):
        y = side * (sash_width + bar) / 2
        frame(sash_width, sash_height, y, 0.05, depth + 0.02, 0.05)
        model.add(m.GLASS, moved(picture(sash_width - 0.1, sash_height - 0.1), depth, y, h / 2))
        lever = filleted([(0, 0, 0), (0.05, 0, 0), (0.05, 0, -0.12)], 0.02, 3)
        model.add(m.CHROME, tube(lever, 0.009, 8), (depth + 0.045, side * (bar / 2 + 0.025), h / 2))
    model.add(m.LACQUER, rounded_box(0.32, w + 0.1, 0.035, 0.012, 2), (0.03, 0, 0.0))
    return model


def door():
    """A leaf with handles. The hinge is the z axis; the leaf runs along +y and faces +x and -x."""
    model = Model("door")
    width, height, thick = DOOR_WIDTH - 0.01, DOOR_HEIGHT - 0.008, 0.042
    model.add(m.DOOR_WOOD, rounded_box(thick, width, height, 0.003, 1), (-thick / 2, width / 2, height / 2 + 0.004),
              swap=True)
    for side in (-1, 1):
        x = 0 if side > 0 else -thick
        handle = filleted([(0, 0, 0), (side * 0.055, 0, 0), (side * 0.055, -0.13, 0)], 0.02, 4)
        model.add(m.CHROME, tube(handle, 0.01, 10), (x, width - 0.07, 1.04))
        model.add(m.CHROME, rounded_box(0.012, 0.045, 0.22, 0.005, 1), (x + side * 0.004, width - 0.07, 1.0))
    for z in (0.25, 1.85):
        model.add(m.CHROME, cylinder(0.011, 0.1, 10, 0.002), (0.008, 0.0, z))
    return model


def lamp():
    """Hangs from the ceiling at the origin; its light goes down in a wide cone."""
    model = Model("lamp")
    drop = 0.32
    for y in (-0.5, 0.5):
        model.add(m.STEEL, tube([(0, y, 0), (0, y, -drop)], 0.003, 6))
        model.add(m.FRAME_WHITE, turned(cylinder(0.035, 0.03, 16), "x", 180), (0, y, 0))
    model.add(m.LACQUER, rounded_box(0.22, 1.4, 0.05, 0.014, 1), (0, 0, -drop - 0.025))
    model.add(m.LAMP, rounded_box(0.18, 1.34, 0.03, 0.012, 1), (0, 0, -drop - 0.045))
    model.lights.append(Light("LAMP", "spot", 5.6, (1.0, 0.95, 0.86), (0, 0, -drop - 0.07), (0, 0, -1),
                              0.9, 1.5))
    return model


def radiator():
    """Eighteen sections between two pipes, with a valve; it hangs on a wall, z = 0 on the floor."""
    model = Model("radiator")
    count, pitch = 18, 0.085
    for i in range(count):
        model.add(m.RADIATOR, rounded_box(0.09, 0.066, 0.56, 0.024, 1), (0.085, (i - (count - 1) / 2) * pitch, 0.43))
    half = count * pitch / 2
    for z in (0.2, 0.66):
        model.add(m.RADIATOR, tube([(0.085, -half, z), (0.085, half, z)], 0.024, 10))
    for y in (-0.5, 0.5):
        model.add(m.RADIATOR, box(0.06, 0.03, 0.04), (0.03, y, 0.6))
    model.add(m.CHROME, tube(filleted([(0.085, half, 0.2), (0.085, half + 0.06, 0.2), (0.085, half + 0.06, 0.0)],
                                      0.03, 4), 0.012, 10))
    model.add(m.LACQUER, turned(lathe([(0, 0), (0.02, 0), (0.026, 0.02), (0.024, 0.06), (0.018, 0.07), (0, 0.07)], 16),
                                "x", -90), (0.085, half, 0.66))
    return model
