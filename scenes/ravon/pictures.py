"""The textures of the outdoor scene, all painted by code: bark, stone, earth, turf, leaves, needles, grass."""
import math
import random

from brush import Brush, palette
from gltf_writer import Texture
from painting import layers, ramp

BEECH = [(0, 0.02), (0.08, 0.42), (0.22, 0.8), (0.4, 1.0), (0.58, 0.92), (0.76, 0.62), (0.9, 0.26), (1, 0)]
BIRCH = [(0, 0.1), (0.1, 0.7), (0.24, 1.0), (0.42, 0.86), (0.62, 0.55), (0.82, 0.22), (1, 0)]
OVAL = [(0, 0.05), (0.12, 0.6), (0.32, 0.98), (0.55, 1.0), (0.78, 0.7), (0.93, 0.3), (1, 0)]


def _pick(start, count, shade):
    return start + max(0, min(count - 1, int(shade * count)))


def twig(name, seed, profile, greens, leaf_px, slender, leaves, clear):
    """A branch that grows from the middle of the lower edge, with side twigs and leaves in several layers."""
    size, levels = 1024, 26
    colors, (green, yellow, wood) = palette(clear, (greens[0], levels), (greens[1], levels),
                                            (["#2c2119", "#4a3a2b", "#6b5842"], 6))
    rng = random.Random(seed)
    brush = Brush(size, size)
    stems = [_stem(rng, (size / 2, size), -math.pi / 2, 0.80 * size)]
    for k in range(11):
        at = 0.1 + 0.078 * k
        x, y = _along(stems[0], at)
        side = 1 if k % 2 else -1
        angle = -math.pi / 2 + side * (0.95 - 0.035 * k + 0.25 * (rng.random() - 0.5))
        stems.append(_stem(rng, (x, y), angle, size * (0.42 - 0.24 * abs(at - 0.38)) * (0.85 + 0.3 * rng.random())))

    def one_leaf(shade, scale):
        stem = stems[int(rng.random() ** 0.8 * len(stems))]
        at = 0.12 + 0.9 * rng.random()
        x, y = _along(stem, min(at, 1.0))
        (x0, y0), (x1, y1) = stem[-2], stem[-1]
        angle = math.atan2(y1 - y0, x1 - x0) + (rng.random() - 0.5) * 2.6
        length = leaf_px * scale * (0.7 + 0.5 * rng.random())
        ramp_start = green if rng.random() < 0.72 else yellow
        tone = shade + 0.2 * (rng.random() - 0.5)
        lit = 0.13 * rng.random()
        # A stalk that would let its leaf leave the picture turns it inwards.
        reach_x, reach_y = x + 1.05 * length * math.cos(angle), y + 1.05 * length * math.sin(angle)
        if not (6 < reach_x < size - 6 and 6 < reach_y < size - 2):
            angle = math.atan2(size * 0.55 - y, size * 0.5 - x) + (rng.random() - 0.5)
        brush.leaf(x, y, angle, length, length * slender * (0.75 + 0.35 * rng.random()), profile,
                   (_pick(ramp_start, levels, tone + lit), _pick(ramp_start, levels, tone - 0.07)),
                   _pick(ramp_start, levels, tone + 0.2 if rng.random() < 0.6 else tone - 0.2))
    for i in range(leaves * 45 // 100):
        one_leaf(0.22 + 0.1 * i / leaves, 1.0)
    for k, stem in enumerate(stems):
        thick = 13 if k == 0 else 6
        brush.stroke(stem, [thick * (1 - 0.8 * i / (len(stem) - 1)) for i in range(len(stem))],
                     [wood + 1 + (i + k) % 4 for i in range(len(stem) - 1)])
    for i in range(leaves * 55 // 100):
        one_leaf(0.40 + 0.50 * i / leaves, 0.95)
    return brush.texture(name, colors, clamp=True)


def _stem(rng, start, angle, length, legs=9):
    points, (x, y) = [start], start
    for _ in range(legs):
        angle += 0.22 * (rng.random() - 0.5)
        x, y = x + length / legs * math.cos(angle), y + length / legs * math.sin(angle)
        points.append((x, y))
    return points


def _along(points, t):
    at = t * (len(points) - 1)
    k = min(int(at), len(points) - 2)
    (x0, y0), (x1, y1) = points[k], points[k + 1]
    return x0 + (x1 - x0) * (at - k), y0 + (y1 - y0) * (at - k)


def needles():
    """A spruce's bough from the left edge to the right, its side twigs hanging a little."""
    width, height, levels = 1024, 512, 28
    colors, (green, wood) = palette("#33452a", (["#0f1a12", "#24381f", "#3f5a2e", "#64803f", "#8aa355"], levels),
                                    (["#241a13", "#54402c"], 5))
    rng = random.Random(23)
    brush = Brush(width, height)
    stem = [(0, height * 0.5)] + [(width * 0.94 * (i + 1) / 10, height * (0.5 + 0.03 * math.sin(i))) for i in range(10)]
    twigs = [(stem, 7)]
    for i in range(34):
        at = 0.04 + 0.94 * i / 34
        x, y = _along(stem, at)
        side = 1 if i % 2 else -1
        length = height * (0.50 - 0.36 * at ** 1.6) * (0.85 + 0.25 * rng.random())
        twigs.append((_stem(rng, (x, y), side * (0.95 - 0.3 * at), length, 6), 4))
    for layer in range(2):
        for points, thick in twigs:
            reach = sum(math.dist(a, b) for a, b in zip(points, points[1:]))
            count = int(reach / 3.4)
            for k in range(count):
                t = k / count
                x, y = _along(points, t)
                (x0, y0), (x1, y1) = points[-2], points[-1]
                along = math.atan2(y1 - y0, x1 - x0)
                side = 1 if k % 2 else -1
                angle = along + side * (0.55 + 0.5 * rng.random())
                length = (26 + 12 * rng.random()) * (1 - 0.35 * t)
                tone = 0.15 + 0.3 * layer + 0.3 * rng.random() + 0.22 * t
                brush.stroke([(x, y), (x + length * math.cos(angle), y + length * math.sin(angle))], [4.6, 1.8],
                             [_pick(green, levels, tone)])
            if layer == 0:
                brush.stroke(points, [thick * (1 - 0.7 * i / len(points)) for i in range(len(points))],
                             [wood + i % 4 for i in range(len(points) - 1)])
    return brush.texture("needles", colors, clamp=True)


def grass(name, seed, greens, clear, blades, heads, tall):
    """A tuft that stands on the lower edge."""
    width, height, levels = 1024, 512, 22
    colors, (green, straw, flower) = palette(clear, (greens, levels),
                                             (["#4a4426", "#8a7c45", "#c6b470", "#e2d6a0"], 12),
                                             (["#e8c31c", "#fffdf2", "#ffffff"], 3))
    rng = random.Random(seed)
    brush = Brush(width, height)
    for i in range(blades):
        spread = (rng.random() + rng.random() + rng.random()) / 1.5 - 1
        lean = 0.55 * spread + 0.5 * (rng.random() - 0.5)
        length = height * tall * (0.45 + 0.5 * rng.random()) * (1 - 0.35 * abs(spread))
        start, count = (straw, 12) if rng.random() < 0.14 else (green, levels)
        tone = 0.10 + 0.4 * i / blades + 0.3 * rng.random()
        _blade(brush, (width * (0.5 + 0.40 * spread), height), lean, length, 7.5 + 5 * rng.random(),
               [_pick(start, count, tone * (0.35 + 0.9 * t / 6)) for t in range(7)], rng)
    for _ in range(heads):
        x = width * (0.5 + 0.34 * (2 * rng.random() - 1))
        lean, length = 0.4 * (rng.random() - 0.5), height * (0.72 + 0.2 * rng.random())
        tip = _blade(brush, (x, height), lean, length, 4.0, [straw + 4 + t for t in range(7)], rng)
        for k in range(16):
            along = k / 16
            brush.blob(tip[0] - 60 * lean * along + 5 * (rng.random() - 0.5), tip[1] + 75 * along, 4.5, 9,
                       straw + 6 + int(5 * rng.random()), 0.5 * (rng.random() - 0.5) + lean, 6)
    return brush, colors, (green, straw, flower), rng


def _blade(brush, foot, lean, length, width, indices, rng):
    legs, (x, y) = 7, foot
    points, angle, bend = [foot], -math.pi / 2 + 0.5 * lean, lean * (0.5 + 0.7 * rng.random()) / 4
    for _ in range(legs):
        x, y = x + length / legs * math.cos(angle), y + length / legs * math.sin(angle)
        angle += bend
        points.append((min(max(x, 4), brush.width - 4), max(y, 4)))
    brush.stroke(points, [width * (1 - (k / legs) ** 1.8) + 1.6 for k in range(legs + 1)], indices)
    return points[-1]


def green_grass():
    brush, colors, _, _ = grass("grass", 31, ["#141f0c", "#33471a", "#5d7a2b", "#8ba544", "#b4c766"], "#5f7a31", 165, 0,
                                0.98)
    return brush.texture("grass", colors, clamp=True)


def dry_grass():
    brush, colors, _, _ = grass("dry grass", 32, ["#2a2a12", "#5c5a28", "#8d8742", "#b9ae66", "#d8cc8c"], "#8b8446",
                                120, 16, 0.86)
    return brush.texture("dry grass", colors, clamp=True)


def flowers():
    """Broad-leaved weeds with daisies and buttercups."""
    brush, colors, (green, _, flower), rng = grass(
        "flowers", 33, ["#13200e", "#2f4a1c", "#4d7029", "#74953c", "#9db95a"], "#4f6f2c", 60, 0, 0.62)
    for i in range(46):
        x, angle = 130 + 764 * rng.random(), -math.pi / 2 + 2.1 * (rng.random() - 0.5)
        tone = 0.2 + 0.5 * i / 46 + 0.2 * rng.random()
        brush.leaf(x, 500 - 150 * rng.random(), angle, 90 + 60 * rng.random(), 34, OVAL,
                   (_pick(green, 22, tone + 0.1), _pick(green, 22, tone)), _pick(green, 22, tone + 0.2))
    for i in range(19):
        x, y = 110 + 804 * rng.random(), 60 + 230 * rng.random()
        brush.stroke([(x + 20 * (rng.random() - 0.5), 500), (x, y)], [4, 3], [_pick(green, 22, 0.5)])
        if i % 3:
            for k in range(13):
                a = 2 * math.pi * k / 13
                brush.stroke([(x, y), (x + 21 * math.cos(a), y + 15 * math.sin(a))], [5, 7], [flower + 1 + k % 2])
            brush.blob(x, y, 8, 6, flower)
        else:
            brush.blob(x, y, 15, 11, flower)
            brush.blob(x - 2, y - 3, 8, 5, flower)
    return brush.texture("flowers", colors, clamp=True)


def turf():
    """Short grass from above, tiled."""
    size, levels = 1024, 30
    colors, (green, straw) = palette("#46552a", (["#1d2411", "#38471c", "#57692b", "#7b8a41", "#a0a75e"], levels),
                                     (["#5d5432", "#93854f", "#c0b27c"], 8))
    rng = random.Random(41)
    brush = Brush(size, size, _pick(green, levels, 0.12), tiled=True)
    for i in range(90):
        brush.blob(size * rng.random(), size * rng.random(), 30 + 50 * rng.random(), 20 + 40 * rng.random(),
                   _pick(green, levels, 0.08 + 0.2 * rng.random()), 3 * rng.random())
    count = 11000
    for i in range(count):
        x, y, angle = size * rng.random(), size * rng.random(), 2 * math.pi * rng.random()
        length, bend = 22 + 34 * rng.random(), 0.8 * (rng.random() - 0.5)
        patch = 0.10 * math.sin(2 * math.pi * x / size * 2 + 1) * math.sin(2 * math.pi * y / size * 3)
        tone = 0.14 + 0.42 * i / count + 0.25 * rng.random() + patch
        start, n = (straw, 8) if rng.random() < 0.10 else (green, levels)
        mid = (x + length / 2 * math.cos(angle), y + length / 2 * math.sin(angle))
        end = (mid[0] + length / 2 * math.cos(angle + bend), mid[1] + length / 2 * math.sin(angle + bend))
        brush.stroke([(x, y), mid, end], [4.6, 4.0, 1.4], [_pick(start, n, tone), _pick(start, n, tone + 0.1)])
    for _ in range(220):
        x, y, tone = size * rng.random(), size * rng.random(), 0.3 + 0.4 * rng.random()
        for k in range(3):
            a = 2 * math.pi * (k / 3 + rng.random() * 0.08)
            brush.blob(x + 9 * math.cos(a), y + 9 * math.sin(a), 9, 7, _pick(green, levels, tone + 0.06 * k), a, 8)
    # The deeper, the more transparent: where turf thins out, single blades remain.
    solid = lambda start, count, index: 142 + 113 * (index - start) // (count - 1)
    colors = (colors[0],) + tuple((*c[:3], solid(green, levels, i) if i < straw else solid(straw, 8, i))
                                  for i, c in enumerate(colors) if i)
    return brush.texture("turf", colors)


def earth():
    """Trodden earth with gravel and a few dead leaves, tiled."""
    size, levels = 1024, 32
    colors, (soil, stone, litter) = palette(
        "#75624a", (["#4a3c2c", "#69563f", "#857052", "#a08b6c"], levels),
        (["#4a4238", "#6f6557", "#938a7b", "#b9b2a4"], 14), (["#4c3018", "#7a4e26", "#a67a42"], 6))
    rng = random.Random(42)
    brush = Brush(size, size, _pick(soil, levels, 0.45), tiled=True)
    for i in range(7000):
        radius = 1.6 + 30 * (1 - i / 7000) ** 3 * (0.4 + rng.random())
        brush.blob(size * rng.random(), size * rng.random(), radius * (1 + 0.6 * rng.random()), radius,
                   _pick(soil, levels, 0.48 + (0.16 + 0.9 / radius) * (rng.random() - 0.5)), 3 * rng.random(), 7)
    for i in range(1100):
        x, y, turn = size * rng.random(), size * rng.random(), 3 * rng.random()
        radius = 1.8 + 11 * rng.random() ** 8
        tone = 0.10 + 0.45 * rng.random()
        brush.blob(x + 0.3 * radius, y + 0.35 * radius, 1.3 * radius, 1.05 * radius, _pick(soil, levels, 0.12), turn, 9)
        brush.blob(x, y, 1.25 * radius, radius, _pick(stone, 14, tone), turn, 9)
        brush.blob(x - 0.25 * radius, y - 0.28 * radius, 0.8 * radius, 0.6 * radius,
                   _pick(stone, 14, tone + 0.22), turn, 8)
    for _ in range(70):
        start = 6 * rng.random()
        brush.leaf(size * rng.random(), size * rng.random(), 2 * math.pi * rng.random(), 24 + 14 * rng.random(), 13,
                   OVAL, (litter + int(start), litter + int(start * 0.7)), litter)
    for _ in range(260):
        x, y, a = size * rng.random(), size * rng.random(), 2 * math.pi * rng.random()
        length = 14 + 40 * rng.random()
        brush.stroke([(x, y), (x + length * math.cos(a), y + length * math.sin(a))], [2.6, 1.4],
                     [litter + 1 + int(4 * rng.random())])
    return brush.texture("earth", colors)


def _field(name, width, height, parts, seed, colors, contrast, levels=48, middle=0.5):
    rows = layers(width, height, parts, random.Random(seed))
    table = ramp(colors, levels)
    pixels = bytes(max(0, min(levels - 1, int((middle + contrast * v) * levels))) for row in rows for v in row)
    return Texture(name, width, height, pixels, table)


def bark():
    """Furrows along v."""
    return _field("bark", 256, 512, [(14, 5, 1.0), (28, 9, 0.8), (64, 40, 0.35), (3, 3, 0.3)], 51,
                  ["#1f1812", "#43372b", "#6f604d", "#97876f", "#a9a08a"], 0.72)


def spruce_bark():
    return _field("spruce bark", 256, 256, [(12, 9, 0.9), (30, 22, 0.9), (64, 64, 0.3)], 52,
                  ["#231811", "#4c382a", "#7a6150", "#9c8573"], 0.7)


def birch_bark():
    """White, with dark lines around the trunk and black scars."""
    size = 512
    colors = ramp(["#16130f", "#4a443b", "#a79f90", "#d9d4c8", "#f1eee6"], 24) + ((60, 45, 35),)
    rows = layers(size // 2, size, [(6, 9, 0.5), (40, 120, 0.3), (3, 30, 0.3)], random.Random(53))
    brush = Brush(size // 2, size, tiled=True)
    for y, row in enumerate(rows):
        brush.rows[y][:] = bytes(max(8, min(23, int((0.82 + 0.3 * v) * 24))) for v in row)
    rng = random.Random(54)
    for _ in range(150):
        x, y, half = size / 2 * rng.random(), size * rng.random(), 4 + 26 * rng.random() ** 2
        brush.blob(x, y, half, 1.2 + 1.6 * rng.random(), int(3 + 8 * rng.random()), 0, 10)
    for _ in range(16):
        x, y = size / 2 * rng.random(), size * rng.random()
        for k in range(6):
            brush.blob(x + 16 * (rng.random() - 0.5), y + 14 * (rng.random() - 0.5), 12 * rng.random() + 4,
                       7 * rng.random() + 3, int(4 * rng.random()), rng.random(), 8)
    return Texture("birch bark", size // 2, size, b"".join(brush.rows), colors)


def stone():
    """Grey, speckled, with lichen."""
    size = 512
    parts = [(5, 5, 0.7), (13, 13, 0.5), (40, 40, 0.4), (128, 128, 0.45)]
    rows = layers(size, size, parts, random.Random(55))
    levels = 24
    colors = ramp(["#3b3833", "#6d6a63", "#98948b", "#bab6ad"], levels) + ramp(["#6f7440", "#a8a863", "#c9c49a"], 6)
    brush = Brush(size, size, tiled=True)
    for y, row in enumerate(rows):
        brush.rows[y][:] = bytes(max(0, min(levels - 1, int((0.52 + 0.62 * v) * levels))) for v in row)
    rng = random.Random(56)
    for _ in range(26):
        x, y, spread = size * rng.random(), size * rng.random(), 10 + 26 * rng.random()
        for _ in range(45):
            a, r = 2 * math.pi * rng.random(), spread * math.sqrt(rng.random())
            brush.blob(x + r * math.cos(a), y + r * math.sin(a), 2 + 3 * rng.random(), 1.5 + 3 * rng.random(),
                       levels + int(6 * rng.random()), rng.random(), 7)
    return Texture("stone", size, size, b"".join(brush.rows), colors)


def forest():
    """The edge of a wood, seen from afar; it goes on at its sides."""
    width, height, levels = 2048, 512, 30
    colors, (leafy, dark) = palette("#3c4d2b", (["#1a2414", "#33451f", "#52682f", "#778b48", "#9aa765"], levels),
                                    (["#101a14", "#1f3022", "#35492f", "#4f6340"], levels))
    rng = random.Random(61)
    brush = Brush(width, height, tiled=True, rows_repeat=False)
    for y in range(height * 66 // 100, height):
        brush.span(y, 0, width, leafy + 1)
    for layer in range(2):
        for k in range(26):
            x = width * (k + rng.random()) / 26
            if rng.random() < 0.34:
                _far_spruce(brush, rng, x, height, height * (0.72 + 0.26 * rng.random()), dark, levels, layer)
            else:
                tall = height * (0.5 + 0.32 * rng.random()) - 40 * layer
                _far_tree(brush, rng, x, height, tall, leafy, levels, layer)
    return brush.texture("forest", colors)


def _far_tree(brush, rng, x, foot, tall, start, levels, layer):
    radius = tall * (0.30 + 0.12 * rng.random())
    own = 0.10 * (rng.random() - 0.5)
    count = int(230 * radius * tall / 20000)
    for i in range(count):
        a, r = 2 * math.pi * rng.random(), math.sqrt(rng.random())
        u, v = r * math.cos(a), r * math.sin(a)
        px, py = x + radius * u * (1 - 0.2 * v), foot - tall * 0.56 + v * tall * 0.43
        if py < 6:
            continue
        tone = 0.40 + own + 0.06 * layer - 0.26 * v - 0.16 * u + 0.20 * (rng.random() - 0.5) + 0.1 * (i / count - 0.5)
        brush.blob(px, py, 6 + 10 * rng.random(), 4 + 6 * rng.random(), _pick(start, levels, tone), rng.random(), 7)
    brush.span(foot - 1, int(x) - 3, int(x) + 3, start)


def _far_spruce(brush, rng, x, foot, tall, start, levels, layer):
    own = 0.12 * (rng.random() - 0.5)
    brush.convex([(x - 2, foot), (x, foot - tall), (x + 2, foot)], start + 2)
    rows = int(tall / 9)
    for i in range(rows):
        t = i / rows
        half = tall * 0.17 * (1 - t) ** 0.85 + 3
        y = foot - tall * (0.06 + 0.93 * t)
        for side in (-1, 1):
            for _ in range(3):
                reach = half * (0.55 + 0.5 * rng.random())
                tone = 0.45 + own + 0.08 * layer - 0.16 * side + 0.3 * (rng.random() - 0.5)
                brush.stroke([(x, y), (x + side * reach, y + 0.34 * reach + 5 * rng.random())], [11, 3],
                             [_pick(start, levels, tone)])


def veil():
    """Black, softly thicker towards the middle, nowhere half solid."""
    size, levels = 64, 32
    colors = tuple((6, 5, 3, 122 * i // (levels - 1)) for i in range(levels))
    rim = lambda i: min(1.0, 3.2 * min(i + 0.5, size - i - 0.5) / size)
    pixels = bytes(int((levels - 1) * rim(x) * rim(y)) for y in range(size) for x in range(size))
    return Texture("veil", size, size, pixels, colors, clamp=True)


def cloud():
    """A heap of vapour. Two of them one before the other look solid; alone none is half solid, and so has no depth."""
    width, height, levels = 512, 256, 64
    rows = layers(width, height, [(6, 4, 0.9), (13, 8, 0.55), (31, 17, 0.3), (70, 40, 0.15)], random.Random(71))
    colors = tuple((255, 255, 255, min(124, 3 * i)) for i in range(levels))
    pixels = bytearray()
    for y, row in enumerate(rows):
        v = 1 - y / height
        body = 1.15 - abs(v - 0.4) / (0.4 if v < 0.4 else 0.55)
        for x, value in enumerate(row):
            u = abs(2 * x / width - 1)
            rim = min(1.0, 8 * (1 - u), 10 * v, 7 * (1 - v))
            pixels.append(max(0, min(levels - 1, int(levels * rim * (0.75 * (body - u * u) + 0.85 * value)))))
    return Texture("cloud", width, height, bytes(pixels), colors, clamp=True)
