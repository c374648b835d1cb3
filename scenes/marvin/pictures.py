"""The drawn textures of the laboratory: whiteboard, screens, poster, book spines, the view outside, keyboard, clock."""
import math
import random

from gltf_writer import Texture
from painting import Canvas, layers, noise, ramp, rgb


def whiteboard():
    c = Canvas(768, 384, ["#f4f5f3", "#26324a", "#b3282d", "#1f6b3a", "#2456a8", "#e8ebea", "#f3dc6b", "#f2a9b8"])
    rng = random.Random(11)
    for _ in range(9):  # wiped-off traces
        x, y = rng.randrange(768), rng.randrange(384)
        c.line([(x, y), (x + rng.randrange(40, 160), y + rng.randrange(-20, 20))], 14, 5)
    # The scan of a room, seen from above.
    c.line([(40, 60), (250, 60), (250, 150), (300, 150), (300, 250), (40, 250), (40, 60)], 4, 1)
    for degree in range(-90, 91, 10):
        a = math.radians(degree)
        c.line([(120, 170), (120 + 95 * math.cos(a), 170 + 95 * math.sin(a) * 0.8)], 1.5, 2)
    c.circle(112, 170, 14, 4, 4)
    c.scribble(60, 300, 200, 14, 2.5, 1, rng)
    c.scribble(60, 335, 150, 14, 2.5, 2, rng)
    # A plot: error against time.
    c.line([(360, 50), (360, 220), (560, 220)], 3.5, 1)
    c.line([(368 + 2 * i, 60 + 148 * (1 - math.exp(-i / 22))) for i in range(92)], 4, 2)
    c.line([(368 + 2 * i, 105 + 100 * (1 - math.exp(-i / 40))) for i in range(92)], 4, 4)
    c.scribble(395, 250, 120, 12, 2.5, 1, rng)
    # A robot.
    c.line([(610, 230), (720, 230), (720, 180), (610, 180), (610, 230)], 4, 4)
    c.line([(665, 180), (665, 100)], 4, 4)
    c.line([(635, 100), (695, 100), (695, 65), (635, 65), (635, 100)], 4, 4)
    for x in (650, 680):
        c.circle(x, 82, 7, 3, 1)
    for x in (632, 698):
        c.circle(x, 240, 14, 4, 1)
    for row in range(3):
        c.scribble(360, 290 + 32 * row, rng.randrange(180, 250), 14, 2.5, (3, 1, 1)[row], rng)
    for x, color in ((640, 6), (692, 7)):  # sticky notes
        c.rectangle(x, 285, x + 42, 327, color)
        c.scribble(x + 6, 304, 28, 6, 1.2, 1, rng)
        c.scribble(x + 6, 318, 24, 6, 1.2, 1, rng)
    return c.texture("whiteboard")


def code_screen():
    c = Canvas(256, 160, ["#1b2230", "#2a3446", "#7fb3e8", "#d8dee9", "#9bcf8e", "#e0a86a", "#c58fd6", "#3c4a63"])
    rng = random.Random(5)
    c.rectangle(0, 0, 256, 9, 1)
    c.rectangle(0, 9, 44, 160, 1)
    for i in range(16):
        c.rectangle(6, 15 + 8 * i, 6 + rng.randrange(14, 34), 18 + 8 * i, 7)
    indent = 0
    for i in range(18):
        x = 52 + 8 * indent
        for _ in range(rng.randrange(1, 5)):
            width = rng.randrange(8, 34)
            c.rectangle(x, 15 + 8 * i, x + width, 18 + 8 * i, rng.choice((2, 3, 3, 4, 5, 6)))
            x += width + 4
        indent = max(0, min(4, indent + rng.choice((-1, 0, 0, 1))))
    return c.texture("screen with code")


def scan_screen():
    c = Canvas(256, 160, ["#0d1a16", "#17362b", "#37d67a", "#f2c14e", "#e8f4ee", "#214d3d"])
    for radius in (24, 48, 72, 96):
        c.circle(128, 130, radius, 1, 5)
    for degree in range(0, 181, 30):
        a = math.radians(degree)
        c.line([(128, 130), (128 + 110 * math.cos(a), 130 - 110 * math.sin(a))], 1, 1)
    for i in range(181):
        a = math.radians(i)
        reach = min(100 / max(abs(math.cos(a)), 0.01), 84 / max(abs(math.sin(a)), 0.01))
        if 50 < i < 66 or 110 < i < 130:
            reach *= 0.55
        c.disc(128 + reach * math.cos(a), 130 - reach * math.sin(a), 1.1, 2)
    c.rectangle(122, 124, 134, 136, 3)
    c.rectangle(0, 146, 256, 160, 1)
    c.rectangle(6, 151, 70, 154, 4)
    c.rectangle(200, 151, 248, 154, 3)
    return c.texture("screen with a scan")


def keyboard():
    c = Canvas(192, 64, ["#23262b", "#3a3f47", "#4d5560"])
    for row in range(5):
        x, y = 4, 4 + 12 * row
        widths = [11] * 14 + [22] if row < 4 else [15, 15, 15, 70, 15, 15, 15]
        for width in widths:
            if x + width > 188:
                width = 188 - x
            if width > 3:
                c.rectangle(x, y, x + width - 2, y + 9, 1)
                c.rectangle(x + 1, y + 1, x + width - 3, y + 7, 2)
            x += width + 1
    return c.texture("keyboard")


def poster():
    c = Canvas(192, 272, ["#f2ead8", "#1f3a4d", "#d9653b", "#e9b44c", "#3f8f8a", "#7a8b92"])
    c.rectangle(0, 0, 192, 54, 1)
    c.rectangle(16, 16, 150, 24, 0)
    c.rectangle(16, 32, 100, 38, 3)
    c.disc(96, 130, 52, 3)
    c.rectangle(62, 128, 130, 178, 1)
    c.rectangle(84, 92, 108, 128, 1)
    c.rectangle(70, 74, 122, 98, 4)
    c.disc(84, 86, 7, 0)
    c.disc(108, 86, 7, 0)
    c.disc(74, 182, 13, 5)
    c.disc(118, 182, 13, 5)
    c.rectangle(52, 158, 62, 172, 2)
    c.rectangle(130, 158, 140, 172, 2)
    for row in range(5):
        c.rectangle(16, 212 + 10 * row, 176 - 14 * (row % 3), 216 + 10 * row, 5)
    return c.texture("poster")


def clock():
    c = Canvas(128, 128, ["#2b2f35", "#f7f5ef", "#c0392b"])
    c.disc(64, 64, 63, 1)
    for hour in range(12):
        a = hour * math.pi / 6
        c.line([(64 + r * math.sin(a), 64 - r * math.cos(a)) for r in (48, 57)], 4 if hour % 3 == 0 else 2, 0)
    c.line([(64, 64), (64 - 30 * math.sin(0.95), 64 - 30 * math.cos(0.95))], 5, 0)
    c.line([(64, 64), (64 + 44 * math.sin(0.9), 64 - 44 * math.cos(0.9))], 3.5, 0)
    c.line([(64, 74), (64, 20)], 1, 2)
    return c.texture("clock")


BOOK_COLUMNS = 16


def book_spines():
    """Sixteen spines side by side, each 32 pixels wide; a book shows one of them."""
    colors = ["#7a2e2e", "#24476b", "#2f5d46", "#c9b48a", "#3b3b44", "#8c5a2b", "#d8d2c2", "#5b3f6e",
              "#a63d2f", "#3f7f93", "#b98a2f", "#1f2f3f", "#6d7f5a", "#c46f4a", "#425b8f", "#8f8f88"]
    c = Canvas(512, 192, colors + ["#efe8d6", "#d4af5a", "#18181c"])
    rng = random.Random(21)
    for i in range(BOOK_COLUMNS):
        x = 32 * i
        light = i in (3, 6, 10)
        ink = 18 if light else rng.choice((16, 17))
        c.rectangle(x, 0, x + 32, 192, i)
        for y in (rng.randrange(8, 20), rng.randrange(165, 182)):
            c.rectangle(x, y, x + 32, y + 3, ink)
        top = rng.randrange(30, 60)
        c.rectangle(x + 12, top, x + 19, top + rng.randrange(50, 90), ink)
        if rng.random() < 0.5:
            c.rectangle(x + 7, 145, x + 25, 156, ink)
    return c.texture("book spines")


def outside():
    """Sky, clouds, wooded hills and a meadow: half a turn of the horizon."""
    width, height, count = 896, 256, 48
    rng = random.Random(3)
    sky = ramp(["#7db4e6", "#a9cff0", "#dbeaf5"], count)
    clouds = layers(width, height, [(4, 5, 0.9), (9, 12, 0.5), (24, 30, 0.25)], rng)
    trees = layers(width, height, [(56, 24, 0.5), (150, 70, 0.5), (448, 128, 0.35)], rng)
    far, near = ([0.5 * a + 0.3 * b for a, b in zip(noise(width, 1, 5, 1, rng)[0], noise(width, 1, k, 1, rng)[0])]
                 for k in (14, 40))
    pixels = bytearray()
    for y in range(height):
        for x in range(width):
            if y > 220 - 8 * near[x]:
                shade = 0.85 + 0.25 * trees[y][x]
                color = rgb("#a9c47c")
            elif y > 189 - 53 * near[x]:
                shade = 0.95 + 0.7 * trees[y][x]
                color = rgb("#6b9459")
            elif y > 171 - 61 * far[x]:
                shade = 0.95 + 0.25 * trees[y][x]
                color = rgb("#9dbab4")
            else:
                shade = 1.0
                white = max(0.0, min(1.0, clouds[y][x] * 2.2))
                base = sky[min(count - 1, y * count // 187)]
                color = tuple(b + (250 - b) * white for b in base)
            pixels += bytes(max(0, min(255, round(v * shade / 4) * 4)) for v in color)
    return Texture("outside", width, height, bytes(pixels), clamp=True)


def ceiling_tiles():
    """Four tiles with fine holes, their seams a little darker."""
    size = 256
    rng = random.Random(8)
    field = layers(size, size, [(64, 64, 0.05), (128, 128, 0.05)], rng)
    pixels = bytearray()
    for y in range(size):
        for x in range(size):
            seam = min(x % 128, 127 - x % 128, y % 128, 127 - y % 128)
            value = 240 + 255 * field[y][x] - (46 if seam == 0 else 12 if seam == 1 else 0)
            pixels.append(max(0, min(255, round(value))))
    for _ in range(1500):
        x, y = rng.randrange(size), rng.randrange(size)
        pixels[y * size + x] = max(0, pixels[y * size + x] - 40)
    return Texture("ceiling tiles", size, size, bytes(pixels))
