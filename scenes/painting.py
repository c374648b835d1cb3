"""Makes pictures: tileable noise, a small canvas with a palette, and the everyday textures that scenes share."""
import math
import random

from gltf_writer import Texture


def noise(width, height, cells_x, cells_y, rng):
    """Tileable smooth noise, rows of values in 0..1."""
    lattice = [[rng.random() for _ in range(cells_x)] for _ in range(cells_y)]

    def weights(size, cells):
        result = []
        for i in range(size):
            at = i * cells / size
            cell, f = int(at), at - int(at)
            result.append((cell, (cell + 1) % cells, f * f * (3 - 2 * f)))
        return result
    across = weights(width, cells_x)
    stretched = [[row[a] + (row[b] - row[a]) * f for a, b, f in across] for row in lattice]
    return [[p + (q - p) * f for p, q in zip(stretched[a], stretched[b])] for a, b, f in weights(height, cells_y)]


def layers(width, height, parts, rng):
    """A sum of noises: `parts` holds (cells_x, cells_y, weight)."""
    total = [[0.0] * width for _ in range(height)]
    for cells_x, cells_y, weight in parts:
        for row, added in zip(total, noise(width, height, cells_x, cells_y, rng)):
            for x, value in enumerate(added):
                row[x] += weight * (value - 0.5)
    return total


def rgb(hex_color):
    return tuple(int(hex_color[i:i + 2], 16) for i in (1, 3, 5))


def ramp(stops, count):
    """A palette that runs evenly through the given colours."""
    stops = [rgb(s) for s in stops]
    result = []
    for i in range(count):
        at = i * (len(stops) - 1) / (count - 1)
        k = min(int(at), len(stops) - 2)
        result.append(tuple(round(a + (b - a) * (at - k)) for a, b in zip(stops[k], stops[k + 1])))
    return tuple(result)


def _level(value, count):
    return max(0, min(count - 1, round(value * (count - 1))))


def grey(name, width, height, parts, seed, mean=0.9):
    """A grey texture around `mean`, to be tinted by a material's colour."""
    field = layers(width, height, parts, random.Random(seed))
    return Texture(name, width, height, bytes(_level(mean + v, 256) for row in field for v in row))


def wood(name, size, colors, seed, boards=1):
    """Grain along u; `boards` planks side by side, with staggered joints where there are several."""
    rng = random.Random(seed)
    count = 64
    grain = layers(size, size, [(3, size // 8, 0.35), (6, size // 3, 0.3), (2, 6, 0.3), (size // 4, size // 2, 0.12)],
                   rng)
    height = size // boards
    pixels = bytearray()
    shade = [[rng.uniform(-0.16, 0.16) for _ in range(2)] for _ in range(boards)]
    shift = [rng.randrange(size) for _ in range(boards)]
    for y in range(size):
        board, inside = min(y // height, boards - 1), y % height
        joint = (board * size * 3 // 8) % size
        row = grain[y]
        for x in range(size):
            value = 0.55 + 0.75 * row[(x + shift[board]) % size]
            if boards > 1:
                from_joint = (x - joint) % size
                value += shade[board][2 * from_joint // size]
                if inside == 0 or from_joint % (size // 2) == 0:
                    value -= 0.3
            pixels.append(_level(value, count))
    return Texture(name, size, size, bytes(pixels), ramp(colors, count))


class Canvas:
    """Palette pixels and a few ways to draw on them. Coordinates are pixels, y down."""

    def __init__(self, width, height, colors):
        self.width, self.height = width, height
        self.palette = tuple(rgb(c) for c in colors)
        self.pixels = bytearray(width * height)

    def rectangle(self, x0, y0, x1, y1, color):
        x0, x1 = max(0, int(x0)), min(self.width, int(x1))
        for y in range(max(0, int(y0)), min(self.height, int(y1))):
            self.pixels[y * self.width + x0:y * self.width + x1] = bytes([color]) * max(0, x1 - x0)

    def disc(self, cx, cy, radius, color):
        for y in range(max(0, math.floor(cy - radius)), min(self.height, math.ceil(cy + radius) + 1)):
            inside = radius * radius - (y - cy) ** 2
            if inside >= 0:
                self.rectangle(round(cx - math.sqrt(inside)), y, round(cx + math.sqrt(inside)) + 1, y + 1, color)

    def line(self, points, thickness, color):
        for (x0, y0), (x1, y1) in zip(points, points[1:]):
            steps = max(1, int(max(abs(x1 - x0), abs(y1 - y0)) * 2))
            for i in range(steps + 1):
                f = i / steps
                self.disc(x0 + (x1 - x0) * f, y0 + (y1 - y0) * f, thickness / 2, color)

    def circle(self, cx, cy, radius, thickness, color):
        self.line([(cx + radius * math.cos(a / 24 * math.pi), cy + radius * math.sin(a / 24 * math.pi))
                   for a in range(49)], thickness, color)

    def scribble(self, x, y, width, height, thickness, color, rng):
        """A line of illegible writing."""
        at = x
        while at < x + width:
            word = rng.uniform(1.2, 3.5) * height
            points, p = [], at
            while p < min(at + word, x + width):
                points.append((p, y - rng.random() * height * (1 if rng.random() > 0.2 else 1.5)))
                p += height * 0.28
            if len(points) > 1:
                self.line(points, thickness, color)
            at += word + height * 0.6

    def texture(self, name):
        return Texture(name, self.width, self.height, bytes(self.pixels), self.palette, clamp=True)
