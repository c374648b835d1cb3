"""Grass, weeds, stones, a fallen trunk, and the wood's edge far away."""
import math
import random

import ground
import materials as m
from gltf_writer import Surface
from shapes import dot, sub, subdivided, unit
from trees import Crown, Growth, add, card, polar, twig_card, wood

SHADES = 3  # grass comes sunlit, half shaded and shaded


def _tuft(growth, material, at, width, tall, azimuth, tint, light, blades=2):
    """Crossed cards; their normals point up, so that grass is lit as the ground is."""
    for k in range(blades):
        across = polar(azimuth + math.pi * k / blades, 0)
        lean = polar(azimuth + math.pi * (k / blades + 0.5), 0)
        corners, uvs = [], []
        for t, bend in ((0.0, 0.0), (1.0, 0.12 * (1 if k % 2 else -1))):
            middle = add(add(at, (0, 0, 1), tall * t - 0.05), lean, tall * bend)
            corners.append((add(middle, across, -width / 2), add(middle, across, width / 2)))
            uvs.append(((0, 1 - t), (1, 1 - t)))
        foot = at[2]
        normal = unit((0.25 * math.cos(azimuth), 0.25 * math.sin(azimuth), 1))
        card(growth, material, corners, uvs, lambda p: normal,
             lambda p: tuple(min(1.0, c * light * (1.0 if p[2] > foot + 0.1 else 0.5)) for c in tint))


def clump(seed, radius, tufts, width, tall, light, materials):
    """Several tufts, each of a material drawn from (material, share)."""
    rng, growth = random.Random(seed), Growth()
    for _ in range(tufts):
        r, a = radius * math.sqrt(rng.random()), 2 * math.pi * rng.random()
        draw, material = rng.random(), materials[-1][0]
        for candidate, share in materials:
            if draw < share:
                material = candidate
                break
            draw -= share
        size = 0.7 + 0.6 * rng.random()
        warm = 0.12 * (2 * rng.random() - 1)
        tint = (0.95 * (1 + warm), 0.95, 0.85 * (1 - warm))
        _tuft(growth, material, (r * math.cos(a), r * math.sin(a), 0.0), width * size,
              tall * size * (0.8 + 0.4 * rng.random()), math.pi * rng.random(), tint, light)
    return growth.list()


def grass_kinds():
    """By (name, shade)."""
    green, dry, flowers = m.GRASS, m.DRY_GRASS, m.FLOWERS
    recipes = {"lawn": (201, 0.55, 11, 0.62, 0.20, [(green, 0.8), (dry, 0.12), (flowers, 0.08)]),
               "meadow": (202, 0.65, 10, 0.85, 0.42, [(green, 0.74), (dry, 0.26)]),
               "straw": (203, 0.6, 8, 0.8, 0.52, [(dry, 0.62), (green, 0.38)]),
               "flowers": (204, 0.6, 8, 0.6, 0.34, [(flowers, 0.66), (green, 0.34)]),
               "tall": (205, 0.7, 8, 1.2, 0.72, [(green, 0.66), (dry, 0.34)])}
    return {(name, shade): clump(seed + 10 * shade, radius, tufts, width, tall, (1.0, 0.72, 0.48)[shade], shares)
            for name, (seed, radius, tufts, width, tall, shares) in recipes.items() for shade in range(SHADES)}


def rock(seed, flat, detail=3):
    """A lump with facets and bulges, about 1 m wide, its origin where the ground cuts it."""
    rng = random.Random(seed)
    axes = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = []
    for x in (0, 1):
        for y in (2, 3):
            for z in (4, 5):
                points = (axes[x], axes[y], axes[z])
                a, b = sub(points[1], points[0]), sub(points[2], points[0])
                turned = dot((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]),
                             points[0]) < 0
                points = points[::-1] if turned else points
                faces.append((points, points, None))
    for _ in range(detail):
        faces = subdivided(faces)
    cuts = [(unit((rng.random() - 0.5, rng.random() - 0.5, rng.random() - 0.35)), 0.66 + 0.22 * rng.random())
            for _ in range(13)]
    waves = [(unit((rng.random() - 0.5, rng.random() - 0.5, rng.random() - 0.5)), 3 + 8 * rng.random(),
              6.28 * rng.random()) for _ in range(7)]

    def place(p):
        p = unit(p)
        reach = min([1.0] + [distance / dot(p, n) for n, distance in cuts if dot(p, n) > 0.05])
        reach *= 1 + sum(0.018 * math.sin(k * dot(p, n) + phase) for n, k, phase in waves)
        return (0.62 * reach * p[0], 0.5 * reach * p[1], flat * reach * p[2] + 0.12)
    known, points, indices = {}, [], []
    for corners, _, _ in faces:
        for corner in corners:
            key = tuple(round(v, 5) for v in unit(corner))
            if key not in known:
                known[key] = len(points)
                points.append(place(corner))
            indices.append(known[key])
    return [Surface(m.STONE, points, _smooth(points, indices), [(p[0] + 0.4 * p[2], p[1] + 0.7 * p[2]) for p in points],
                    [(max(0.32, min(1.0, 0.42 + 1.7 * p[2])),) * 3 for p in points], indices)]


def _smooth(points, indices):
    sums = [(0.0, 0.0, 0.0)] * len(points)
    for i in range(0, len(indices), 3):
        a, b, c = indices[i:i + 3]
        u, v = sub(points[b], points[a]), sub(points[c], points[a])
        n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        for k in (a, b, c):
            sums[k] = add(sums[k], n)
    return [unit(n) for n in sums]


def log():
    """A trunk that lies along x, with stumps of boughs and a few shoots."""
    rng, growth = random.Random(221), Growth()
    path = [(-2.2 + 0.55 * i, 0.05 * math.sin(1.3 * i), 0.16 + 0.012 * i) for i in range(9)]
    wood(growth, m.BARK, path, [0.21 - 0.009 * i for i in range(9)], 10, [0.75] * 9, 0.55)
    for k, (at, azimuth, elevation) in enumerate(((2, 1.3, 0.5), (4, -1.2, 0.4), (6, 1.6, 0.9), (7, -1.5, 0.3))):
        stump = [path[at], add(path[at], polar(azimuth, elevation), 0.35 + 0.12 * k)]
        wood(growth, m.BARK, stump, [0.06, 0.04], 6, [0.7, 0.8], 0.4)
    crown = Crown((2.2, 0, 0.2), 0.9, 0.8)
    for k in range(5):
        twig_card(growth, m.BEECH, path[-1], polar(k - 2, 0.3), 0.7, rng.random(), crown, (0.9, 0.9, 0.7))
    return growth.list()


def far_forest():
    """Rows of the wood's edge, the farther the hazier. They stand on the hills and look at the origin."""
    growth = Growth()
    rng = random.Random(231)
    for ring, (distance, tall) in enumerate(((78, 12.5), (104, 14), (140, 15), (190, 16), (265, 17), (360, 19))):
        count = round(2 * math.pi * distance / (tall * 4 * 0.98))
        haze = min(1.0, (distance - 60) / 420)
        skip = 0.34 if ring == 0 else 0.2
        for k in range(count):
            if rng.random() < skip:
                continue
            a0, a1 = 2 * math.pi * (k - 0.04) / count, 2 * math.pi * (k + 1.04) / count
            r0, r1 = distance * (0.93 + 0.14 * rng.random()), distance * (0.93 + 0.14 * rng.random())
            shift, scale = rng.random(), 0.8 + 0.35 * rng.random()
            corners, uvs = [], []
            legs = 4
            for i in range(legs + 1):
                t = i / legs
                a, r = a0 + (a1 - a0) * t, r0 + (r1 - r0) * t
                x, y = r * math.cos(a), r * math.sin(a)
                z = ground.height(x, y) - 0.8
                corners.append(((x, y, z), (x, y, z + tall * scale)))
                uvs.append(((shift + t, 0.998), (shift + t, 0.004)))
            tint = [0.86 + 0.12 * rng.random()] * 3
            color = tuple(t + (h - t) * 0.62 * haze for t, h in zip(tint, (0.62, 0.80, 1.0)))
            card(growth, m.FOREST, corners, uvs, lambda p: unit((-p[0] / distance, -p[1] / distance, 2.2)),
                 lambda p: color)
    return growth.list()


def clouds():
    """Fair weather: heaps of cloud all around, lit from above."""
    growth = Growth()
    rng = random.Random(241)
    for k in range(20):
        a, distance = 2 * math.pi * (k + 0.8 * rng.random()) / 20, 640 + 160 * rng.random()
        base, wide = 60 + 200 * rng.random() ** 1.3, 210 + 170 * rng.random()
        half, tall = wide / 2 / distance, wide * (0.24 + 0.14 * rng.random())
        mirrored = rng.random() < 0.5
        corners, uvs = [], []
        for i in range(5):
            t = i / 4
            x, y = distance * math.cos(a + half * (1 - 2 * t)), distance * math.sin(a + half * (1 - 2 * t))
            corners.append(((x, y, base), (x, y, base + tall)))
            uvs.append(((1 - t if mirrored else t, 1), (1 - t if mirrored else t, 0)))
        for _ in range(2):
            card(growth, m.CLOUD, corners, uvs, lambda p: (0, 0, 1),
                 lambda p: (1, 1, 1) if p[2] > base + 1 else (0.62, 0.68, 0.78))
            corners = [tuple((x * 1.01, y * 1.01, z) for x, y, z in pair) for pair in corners]
    return growth.list()
