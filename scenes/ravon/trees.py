"""Trees and bushes: trunks and boughs as tapered tubes, leaves as cards with normals that point out of the crown."""
import math
import random

import materials as m
from gltf_writer import Surface
from shapes import cross, dot, sub, unit


class Growth:
    """Surfaces under construction, by material."""

    def __init__(self):
        self.surfaces = {}

    def surface(self, material):
        return self.surfaces.setdefault(material, Surface(material, [], [], [], [], []))

    def list(self):
        return list(self.surfaces.values())


def add(a, b, scale=1.0):
    return (a[0] + b[0] * scale, a[1] + b[1] * scale, a[2] + b[2] * scale)


def polar(azimuth, elevation):
    return (math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation))


def wood(growth, material, path, radii, sides, shades, tile_m):
    """A tapered tube along a path, open at its ends; one shade per point."""
    surface = growth.surface(material)
    side = (1.0, 0.0, 0.0)
    first, length = len(surface.points), 0.0
    turns = [(math.cos(2 * math.pi * k / sides), math.sin(2 * math.pi * k / sides)) for k in range(sides + 1)]
    around = max(1, round(2 * math.pi * radii[0] / tile_m))
    for i, point in enumerate(path):
        tangent = unit(sub(path[min(i + 1, len(path) - 1)], path[max(i - 1, 0)]))
        side = add(side, tangent, -dot(side, tangent))
        side = unit(side) if dot(side, side) > 1e-6 else unit(cross(tangent, (0.3, 1, 0.2)))
        other = cross(tangent, side)
        if i:
            length += math.dist(path[i - 1], point)
        for k, (c, s) in enumerate(turns):
            normal = tuple(c * a + s * b for a, b in zip(side, other))
            surface.points.append(add(point, normal, radii[i]))
            surface.normals.append(normal)
            surface.uvs.append((around * k / sides, -length / (2 * tile_m)))
            surface.colors.append((shades[i],) * 3)
    row = sides + 1
    for i in range(len(path) - 1):
        for k in range(sides):
            a = first + i * row + k
            surface.indices += [a, a + 1, a + row + 1, a, a + row + 1, a + row]


def card(growth, material, corners, uvs, normal_at, color_at):
    """A strip of quads, given from one end to the other as pairs of corners (left, right); seen from both sides."""
    surface = growth.surface(material)
    first = len(surface.points)
    for pair, uv_pair in zip(corners, uvs):
        for point, uv in zip(pair, uv_pair):
            surface.points.append(point)
            surface.normals.append(normal_at(point))
            surface.uvs.append(uv)
            surface.colors.append(color_at(point))
    for i in range(0, 2 * len(corners) - 2, 2):
        a, b, c, d = first + i, first + i + 1, first + i + 3, first + i + 2
        surface.indices += [a, b, c, a, c, d, c, b, a, d, c, a]


class Crown:
    """An ellipsoid full of leaves: light on its outside and top, dark within."""

    def __init__(self, centre, radius, half_height, darkest=0.22):
        self.centre, self.radius, self.half_height, self.darkest = centre, radius, half_height, darkest

    def _relative(self, point):
        d = sub(point, self.centre)
        return (d[0] / self.radius, d[1] / self.radius, d[2] / self.half_height)

    def normal(self, point):
        x, y, z = self._relative(point)
        return unit((x / self.radius + 1e-6, y / self.radius, z / self.half_height + 0.32 / self.radius))

    def light(self, point):
        r = self._relative(point)
        out = min(1.15, math.sqrt(dot(r, r)))
        return max(self.darkest, min(1.0, self.darkest + (1 - self.darkest) * out ** 2.1 + 0.20 * r[2]))


def twig_card(growth, material, foot, direction, size, roll, crown, tint):
    """A twig's card from its foot along `direction`, turned about it by `roll`; it hangs a little at its end."""
    along = unit(direction)
    level = cross(along, (0, 0, 1))
    level = unit(level) if dot(level, level) > 1e-4 else (1.0, 0.0, 0.0)
    across = tuple(math.cos(roll) * a + math.sin(roll) * b for a, b in zip(level, cross(level, along)))
    corners, uvs = [], []
    for t, droop in ((0.0, 0.0), (0.55, 0.0), (1.0, -0.10)):
        middle = add(add(foot, along, size * t), (0, 0, 1), size * droop)
        corners.append((add(middle, across, -size / 2), add(middle, across, size / 2)))
        uvs.append(((0, 1 - t), (1, 1 - t)))
    card(growth, material, corners, uvs, crown.normal,
         lambda p: tuple(min(1.0, c * crown.light(p)) for c in tint))


def _tint(rng, base, spread=0.16):
    light, warm = 1 + spread * (2 * rng.random() - 1), 0.10 * (2 * rng.random() - 1)
    return (base[0] * light * (1 + warm), base[1] * light, base[2] * light * (1 - warm))


def _bent(rng, start, direction, length, legs, sway, lift):
    path, at, heading = [start], start, direction
    for _ in range(legs):
        heading = unit(add(heading, (sway * (rng.random() - 0.5), sway * (rng.random() - 0.5),
                                     sway * (rng.random() - 0.5) + lift)))
        at = add(at, heading, length / legs)
        path.append(at)
    return path


def broadleaf(seed, tall, bare, spread, trunk_radius, bark, leaves, tile_m, boughs, card_m, tint, lift=0.06):
    """A tree `tall` metres high, without boughs below `bare` of that, its crown `spread` in radius."""
    rng, growth = random.Random(seed), Growth()
    trunk = _bent(rng, (0, 0, -0.5), (0, 0, 1), tall * 0.9 + 0.5, 10, 0.16, 0.10)
    radii = [trunk_radius * (1 - 0.93 * i / 10) for i in range(11)]
    radii[0], radii[1] = trunk_radius * 1.75, trunk_radius * 1.08
    wood(growth, bark, trunk, radii, 9, [0.5, 0.8] + [0.8 - 0.05 * i for i in range(9)], tile_m)
    base = tall * bare
    crown = Crown((trunk[7][0] * 0.8, trunk[7][1] * 0.8, (tall + base) / 2), spread, (tall - base) / 2 * 1.06)
    golden = math.pi * (3 - math.sqrt(5))
    for b in range(boughs):
        t = (b + 0.5) / boughs
        at = base * 0.85 + (tall * 0.88 - base * 0.85) * t
        start = _on(trunk, at)
        reach = spread * (0.45 + 0.65 * math.sin(math.pi * min(1.0, 0.25 + 0.8 * t))) * (0.85 + 0.3 * rng.random())
        azimuth, elevation = b * golden + 0.5 * rng.random(), 0.15 + 0.95 * t + 0.25 * (rng.random() - 0.5)
        bough = _bent(rng, start, polar(azimuth, elevation), reach, 5, 0.35, lift)
        thick = trunk_radius * (0.40 - 0.27 * t)
        wood(growth, bark, bough, [thick * (1 - 0.17 * i) for i in range(6)], 5, [0.55] * 6, tile_m)
        _leaves_of_bough(growth, rng, bough, reach, bark, leaves, thick, crown, card_m, tint, tile_m)
    for k in range(7):
        twig_card(growth, leaves, _on(trunk, tall * (0.72 + 0.03 * k)), polar(k * golden, 0.9), card_m,
                  math.pi * rng.random(), crown, _tint(rng, tint))
    return growth.list()


def _on(trunk, z):
    for a, b in zip(trunk, trunk[1:]):
        if b[2] >= z:
            t = (z - a[2]) / (b[2] - a[2])
            return add(a, sub(b, a), t)
    return trunk[-1]


def _leaves_of_bough(growth, rng, bough, reach, bark, leaves, thick, crown, card_m, tint, tile_m):
    for i in range(2, 6):
        start, heading = bough[i], unit(sub(bough[i], bough[i - 1]))
        for side in (-1, 1):
            across = unit(add(cross(heading, (0, 0, 1)), (0, 0, 1), 0.5 * (rng.random() - 0.3)))
            direction = unit(add(heading, across, side * (0.9 + 0.5 * rng.random())))
            branch = _bent(rng, start, direction, reach * (0.34 + 0.12 * rng.random()), 2, 0.3, 0.04)
            wood(growth, bark, branch, [thick * 0.30, thick * 0.2, thick * 0.08], 3, [0.45] * 3, tile_m)
            for foot in branch[1:]:
                twig_card(growth, leaves, add(foot, direction, -0.25 * card_m), add(direction, (0, 0, 1), 0.1),
                          card_m * (0.8 + 0.4 * rng.random()), math.pi * rng.random(), crown, _tint(rng, tint))
    twig_card(growth, leaves, bough[-2], sub(bough[-1], bough[-2]), card_m * 1.1, math.pi * rng.random(), crown,
              _tint(rng, tint))


def spruce(seed, tall, spread, whorls, tint):
    """A straight trunk with whorls of boughs that hang and lift their tips."""
    rng, growth = random.Random(seed), Growth()
    trunk = [(0.05 * math.sin(i), 0.05 * math.cos(i), -0.5 + (tall + 0.3) * i / 8) for i in range(9)]
    radius = 0.017 * tall
    wood(growth, m.SPRUCE_BARK, trunk, [radius * (1.5 if i == 0 else 1 - 0.118 * i) for i in range(9)], 8,
         [0.5] + [0.6] * 8, 0.5)
    for w in range(whorls):
        t = w / whorls
        z = tall * (0.07 + 0.91 * t ** 0.92)
        reach = spread * (1 - t) ** 0.82 * (0.9 + 0.2 * rng.random()) + 0.22
        count = 9 if t < 0.6 else 7 if t < 0.85 else 5
        for k in range(count):
            azimuth = 2 * math.pi * (k + 0.5 * (w % 2)) / count + 0.4 * rng.random()
            _bough_card(growth, rng, z + 0.1 * rng.random(), azimuth, reach * (0.85 + 0.3 * rng.random()), t,
                        _tint(rng, tint, 0.2))
    return growth.list()


def _bough_card(growth, rng, z, azimuth, reach, t, tint):
    outward, across = polar(azimuth, 0), polar(azimuth + math.pi / 2, 0)
    tilt = 0.5 * (rng.random() - 0.5)
    width = 0.48 * reach + 0.1
    corners, uvs = [], []
    for u, drop in ((0.0, 0.0), (0.4, -0.12 - 0.14 * (1 - t)), (0.8, -0.26 - 0.16 * (1 - t)),
                    (1.04, -0.27 - 0.12 * (1 - t))):
        middle = add(tuple(reach * u * v for v in outward), (0, 0, 1), z + reach * (drop + 0.5 * t * u))
        half = (across[0] * width / 2, across[1] * width / 2, tilt * width / 2)
        corners.append((add(middle, half, -1), add(middle, half)))
        uvs.append(((u / 1.04, 0), (u / 1.04, 1)))
    crown = lambda p: unit((p[0] / max(reach, 0.3), p[1] / max(reach, 0.3), 0.75))
    shade = lambda p: tuple(c * (0.34 + 0.62 * min(1.0, math.hypot(p[0], p[1]) / reach) ** 1.3) for c in tint)
    card(growth, m.NEEDLES, corners, uvs, crown, shade)


def bush(seed, radius, tall, leaves, count, card_m, tint):
    """Stems from one foot, leaves down to the ground."""
    rng, growth = random.Random(seed), Growth()
    crown = Crown((0, 0, tall * 0.38), radius, tall * 0.64, 0.26)
    for k in range(7):
        path = _bent(rng, (0.1 * math.cos(k), 0.1 * math.sin(k), -0.2), polar(2.4 * k, 0.75 + 0.4 * rng.random()),
                     tall * 0.8, 4, 0.3, 0.05)
        wood(growth, m.BARK, path, [0.03, 0.026, 0.02, 0.014, 0.006], 4, [0.4] * 5, 0.3)
    golden = math.pi * (3 - math.sqrt(5))
    for k in range(count):
        up = 1 - 1.15 * (k + 0.5) / count
        elevation, azimuth = math.asin(max(-0.15, up)), golden * k + 0.4 * rng.random()
        inner = 0.25 + 0.42 * rng.random()
        direction = polar(azimuth, elevation + 0.3)
        foot = (radius * inner * math.cos(azimuth) * math.cos(elevation),
                radius * inner * math.sin(azimuth) * math.cos(elevation),
                max(0.05, crown.centre[2] + crown.half_height * inner * math.sin(elevation)))
        twig_card(growth, leaves, foot, direction, card_m * (0.75 + 0.5 * rng.random()), math.pi * rng.random(), crown,
                  _tint(rng, tint))
    return growth.list()


def kinds():
    """The surfaces of every kind of tree and bush."""
    return {
        "beech_1": broadleaf(101, 9.5, 0.26, 3.5, 0.21, m.BARK, m.BEECH, 0.55, 15, 1.75, (0.95, 0.95, 0.85)),
        "beech_2": broadleaf(102, 7.6, 0.22, 3.1, 0.17, m.BARK, m.BEECH, 0.55, 13, 1.6, (1.0, 0.92, 0.75)),
        "hazel_tree": broadleaf(103, 6.2, 0.2, 2.6, 0.13, m.BARK, m.HAZEL, 0.45, 12, 1.4, (0.92, 1.0, 0.85)),
        "birch_1": broadleaf(104, 10.5, 0.30, 2.3, 0.13, m.BIRCH_BARK, m.BIRCH, 0.6, 16, 1.35, (1.0, 1.0, 0.8), -0.05),
        "birch_2": broadleaf(105, 8.0, 0.28, 1.9, 0.10, m.BIRCH_BARK, m.BIRCH, 0.6, 14, 1.25, (1.0, 0.95, 0.7), -0.05),
        "spruce_1": spruce(106, 12.5, 2.5, 25, (1.0, 1.0, 0.95)),
        "spruce_2": spruce(107, 8.0, 1.9, 19, (1.0, 1.0, 0.9)),
        "spruce_3": spruce(108, 3.2, 1.0, 12, (1.0, 1.0, 0.8)),
        "bush_hazel": bush(111, 1.35, 1.9, m.HAZEL, 80, 0.95, (0.95, 1.0, 0.85)),
        "bush_beech": bush(112, 1.0, 1.25, m.BEECH, 64, 0.75, (1.0, 0.95, 0.8)),
        "bush_low": bush(113, 0.75, 0.75, m.BIRCH, 52, 0.55, (0.9, 0.95, 0.8)),
    }
