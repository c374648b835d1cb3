"""Where everything stands, and the shade that it throws on ground and grass."""
import math
import random

import ground
from gltf_writer import Place
from shapes import cross, dot, unit

SUN = unit((0.22, -0.74, -0.60))  # the way its light travels; ravon.xml has it as azimuth and elevation
EXTENT_X, EXTENT_Y = (-58.0, 54.0), (-34.0, 34.0)  # where single plants stand; the far forest lies beyond

# Of each kind: radius and middle height of its crown, how much light it takes, share of the wood.
TREES = {"beech_1": (3.5, 6.0, 0.62, 0.18), "beech_2": (3.1, 4.7, 0.6, 0.18), "hazel_tree": (2.6, 3.8, 0.6, 0.12),
         "birch_1": (2.2, 6.8, 0.5, 0.16), "birch_2": (1.8, 5.2, 0.45, 0.14), "spruce_1": (2.0, 5.0, 0.6, 0.10),
         "spruce_2": (1.5, 3.2, 0.55, 0.12)}
BUSHES = {"bush_hazel": (1.4, 0.9, 0.5, 0.34), "bush_beech": (1.0, 0.6, 0.5, 0.30), "bush_low": (0.75, 0.35, 0.4, 0.28),
          "spruce_3": (0.8, 1.2, 0.5, 0.08)}
WORLD_CAM = (-19.0, 0.2)
LOG = (2.2, 6.6, 28.0)  # x, y, yaw in degrees


def turned(up, yaw_rad):
    """A quaternion that turns by `yaw_rad` about z, then z to `up`."""
    axis, w = cross((0, 0, 1), up), 1 + up[2]
    length = math.sqrt(dot(axis, axis) + w * w)
    ax, ay, az, aw = axis[0] / length, axis[1] / length, axis[2] / length, w / length
    s, c = math.sin(yaw_rad / 2), math.cos(yaw_rad / 2)
    return (ax * c + ay * s, ay * c - ax * s, aw * s + az * c, aw * c - az * s)


class Shade:
    """Soft blots where plants keep the sun away."""
    CELL_M = 4.0

    def __init__(self):
        self.cells = {}

    def add(self, x, y, middle_height, radius, strength, flat=1.0):
        reach = -middle_height / SUN[2]
        along = unit((SUN[0], SUN[1], 0))
        blot = (x + SUN[0] * reach, y + SUN[1] * reach, along[0], along[1], radius * 1.25 * flat, radius, strength)
        self._enter(blot, 1.5 * max(blot[4], radius))

    def foot(self, x, y, radius, strength):
        self._enter((x, y, 1.0, 0.0, radius, radius, strength), 1.5 * radius)

    def _enter(self, blot, reach):
        cells = lambda at: range(math.floor((at - reach) / self.CELL_M), math.floor((at + reach) / self.CELL_M) + 1)
        for i in cells(blot[0]):
            for j in cells(blot[1]):
                self.cells.setdefault((i, j), []).append(blot)

    def at(self, x, y):
        """1 in the sun, down to 0.42."""
        light = 1.0
        for bx, by, ax, ay, long, wide, strength in self.cells.get((math.floor(x / self.CELL_M),
                                                                    math.floor(y / self.CELL_M)), ()):
            dx, dy = x - bx, y - by
            square = ((dx * ax + dy * ay) / long) ** 2 + ((dy * ax - dx * ay) / wide) ** 2
            if square < 2.25:
                light *= 1 - strength * math.exp(-square * square * 1.6)
        if light < 0.98:
            # Flecks of sun.
            flecks = math.sin(3.1 * x + 1.3 * math.sin(2.2 * y)) * math.sin(3.7 * y + 1.1 * math.sin(1.9 * x))
            light = min(1.0, light + 0.30 * (1 - light) * flecks)
        return max(0.42, light)


def _draw(rng, table):
    draw = rng.random() * sum(row[3] for row in table.values())
    for kind, row in table.items():
        draw -= row[3]
        if draw < 0:
            return kind
    return kind


class Layout:
    """The places of everything, by kind."""

    def __init__(self):
        self.plants, self.rocks, self.grass = {}, {}, {}
        self.shade = Shade()
        self._taken, self._cells = [], {}
        self._trees(random.Random(301))
        self._rocks(random.Random(302))
        self._bushes(random.Random(303))
        x, y, yaw = LOG
        self.log = [Place((x, y, ground.height(x, y) - 0.02), turned(ground.normal(x, y, 1.0), math.radians(yaw)))]
        self.shade.foot(x, y - 0.2, 1.6, 0.3)
        self._grass(random.Random(304))

    def _free(self, x, y, radius):
        return all(math.hypot(x - a, y - b) > radius + r for a, b, r in self._taken)

    def _take(self, x, y, radius):
        self._taken.append((x, y, radius))
        for i in range(math.floor(x - radius - 1), math.floor(x + radius + 1) + 1):
            for j in range(math.floor(y - radius - 1), math.floor(y + radius + 1) + 1):
                self._cells.setdefault((i, j), []).append((x, y, radius))

    def _is_bare(self, x, y):
        """No trunk and no stone stands here."""
        near = self._cells.get((math.floor(x), math.floor(y)), ())
        return all(math.hypot(x - a, y - b) > 0.35 * r for a, b, r in near)

    def _plant(self, table, kind, x, y, size, rng):
        radius, middle, strength, _ = table[kind]
        lean = unit((0.05 * (rng.random() - 0.5), 0.05 * (rng.random() - 0.5), 1))
        place = Place((x, y, ground.height(x, y)), turned(lean, 2 * math.pi * rng.random()),
                      (size, size, size * (0.92 + 0.16 * rng.random())))
        self.plants.setdefault(kind, []).append(place)
        self.shade.add(x, y, middle * size, radius * size, strength)
        self.shade.foot(x, y, 0.55 * radius * size, 0.35)

    def _trees(self, rng):
        for _ in range(1800):
            x = EXTENT_X[0] + (EXTENT_X[1] - EXTENT_X[0]) * rng.random()
            y = EXTENT_Y[0] + (EXTENT_Y[1] - EXTENT_Y[0]) * rng.random()
            kind, size = _draw(rng, TREES), 0.8 + 0.45 * rng.random()
            radius = 0.75 * TREES[kind][0] * size
            d = abs(ground.from_path(x, y))
            thin = 0.35 + 0.65 * min(1.0, d / 22) - 0.5 * ground.patchiness(0.13 * x, 0.16 * y)
            if d < 4.0 + radius or rng.random() > thin or not self._free(x, y, radius) or is_kept_clear(x, y):
                continue
            self._take(x, y, radius)
            self._plant(TREES, kind, x, y, size, rng)

    def _rocks(self, rng):
        for _ in range(180):
            x, y = EXTENT_X[0] + 100 * rng.random(), -16 + 32 * rng.random()
            kind, size = f"rock_{1 + int(3 * rng.random())}", 0.22 + 1.1 * rng.random() ** 3
            d = abs(ground.from_path(x, y))
            if d < 1.6 + 0.7 * size or not self._free(x, y, 0.4 * size):
                continue
            up = unit(tuple(n + 0.25 * (rng.random() - 0.5) for n in ground.normal(x, y)))
            place = Place((x, y, ground.height(x, y) - 0.10 * size), turned(up, 6.28 * rng.random()),
                          (size, size * (0.8 + 0.4 * rng.random()), size * (0.75 + 0.5 * rng.random())))
            self.rocks.setdefault(kind, []).append(place)
            self._take(x, y, 0.45 * size)
            self.shade.add(x, y, 0.3 * size, 0.55 * size, 0.5)
            self.shade.foot(x, y, 0.85 * size, 0.35)

    def _bushes(self, rng):
        for _ in range(400):
            x, y = EXTENT_X[0] + 106 * rng.random(), -26 + 52 * rng.random()
            kind, size = _draw(rng, BUSHES), 0.75 + 0.5 * rng.random()
            radius = BUSHES[kind][0] * size
            d = abs(ground.from_path(x, y))
            if d < 1.9 + radius or rng.random() > 0.25 + 0.75 * min(1.0, (d - 2) / 8) or is_kept_clear(x, y):
                continue
            if not self._free(x, y, 0.55 * radius):
                continue
            self._take(x, y, 0.55 * radius)
            self._plant(BUSHES, kind, x, y, size, rng)

    def _grass(self, rng):
        for spacing, nearest, farthest in ((0.60, 0.0, 7.0), (0.95, 7.0, 16.0), (1.7, 16.0, 34.0)):
            x = EXTENT_X[0] + 3
            while x < EXTENT_X[1]:
                y = EXTENT_Y[0]
                while y < EXTENT_Y[1]:
                    px, py = x + spacing * (rng.random() - 0.5), y + spacing * (rng.random() - 0.5)
                    d = abs(ground.from_path(px, py))
                    y += spacing
                    if nearest <= d < farthest and self._is_bare(px, py):
                        self._tuft(rng, px, py, d)
                x += spacing

    def _tuft(self, rng, x, y, d):
        green = ground.greenness(x, y)
        if green < 0.3 + 0.4 * rng.random():
            return
        patch, draw = ground.patchiness(0.45 * x + 3, 0.4 * y), rng.random()
        size = 0.75 + 0.5 * rng.random()
        if d < 0.9:
            if draw < 0.35:
                return
            kind, size = "lawn", 0.62 * size
        elif d < 2.0 + 0.5 * patch:
            kind = "flowers" if draw < 0.10 else "lawn"
        elif d > 9 and draw < 0.55:
            kind = "tall"
        elif patch > 0.25:
            kind = "straw" if draw < 0.7 else "meadow"
        elif patch < -0.3:
            kind = "flowers" if draw < 0.45 else "lawn"
        else:
            kind = "meadow" if draw < 0.75 else "lawn"
        light = self.shade.at(x, y)
        shade = 0 if light > 0.85 else 1 if light > 0.62 else 2
        place = Place((x, y, ground.height(x, y)), turned(ground.normal(x, y, 0.3), 2 * math.pi * rng.random()),
                      (size, size, size * (0.8 + 0.4 * rng.random())))
        self.grass.setdefault((kind, shade), []).append(place)


def is_kept_clear(x, y):
    """Around the camera that overlooks the scene, and before it where it looks."""
    dx, dy = x - WORLD_CAM[0], y - WORLD_CAM[1]
    return math.hypot(dx, dy) < 6.5 or (0 < dx < 34 and abs(dy - 0.02 * dx) < 2.4 + 0.2 * dx)
