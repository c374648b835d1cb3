"""The corner of a workshop where the arm stands, and what lies on its table."""
import painting
from gltf_writer import Light, Material, linear
from shapes import Model, box, filleted, grid, lathe, rounded_box, rounded_rectangle, slab, sphere, tube

TABLE_Z = 0.74
BLOCK = 0.05

WOOD = Material("table wood", texture=painting.wood("table wood", 256, ["#a9793f", "#d3a768", "#e7c78f"], 33),
                tile_m=(1.4, 0.9))
FLOOR = Material("floor", linear("#8f979c"), painting.grey("concrete", 128, 128,
                 [(5, 5, 0.06), (40, 40, 0.05), (64, 64, 0.06)], 7, 0.9), (1.6, 1.6))
WALL = Material("wall", linear("#d9dcd6"))
WALL_DARK = Material("accent wall", linear("#4d6f7c"))
SKIRTING = Material("skirting", linear("#f0efe9"))
STEEL = Material("steel", linear("#6f777e"))
MAT = Material("cutting mat", linear("#2f6b57"))
MAT_LINE = Material("mat lines", linear("#8fc2ae"))


def _paint(name, color):
    return Material(name, linear(color))


def corner():
    """A floor and two walls; the origin is on the floor below the table's middle."""
    model = Model("corner")
    cuts = [-2.5 + 0.5 * i for i in range(11)]
    model.add(FLOOR, grid(cuts, cuts, lambda u, v: (u, v, 0), (0, 0, 1)))
    heights = [0.08, 0.6, 1.2, 1.8, 2.4, 3.0]
    model.add(WALL, grid(cuts, heights, lambda u, v: (u, 1.6, v), (0, -1, 0)))
    model.add(WALL_DARK, grid(cuts, heights, lambda u, v: (1.9, u, v), (-1, 0, 0)))
    model.add(SKIRTING, box(5, 0.02, 0.08), (0, 1.6, 0.04))
    model.add(SKIRTING, box(0.02, 5, 0.08), (1.9, 0, 0.04))
    # A shelf with boxes on the wall behind.
    shelf = _paint("shelf", "#c9a36b")
    model.add(shelf, rounded_box(1.5, 0.26, 0.03, 0.004, 2), (0.1, 1.47, 1.62))
    for x, width, height, color in ((-0.45, 0.24, 0.2, "#b5533c"), (-0.16, 0.2, 0.26, "#e0b04c"),
                                    (0.1, 0.22, 0.18, "#54789a"), (0.5, 0.3, 0.22, "#86955a")):
        model.add(_paint("box " + color, color), rounded_box(width, 0.2, height, 0.008, 2),
                  (x, 1.47, 1.635 + height / 2))
    model.lights += [Light("WINDOW", "directional", 1.5, (1.0, 0.96, 0.88), (0, 0, 3), (0.35, 0.62, -0.7)),
                     Light("FILL", "directional", 0.5, (0.8, 0.9, 1.0), (0, 0, 3), (-0.7, 0.2, -0.35)),
                     Light("LAMP", "point", 1.6, (1.0, 0.9, 0.75), (0.3, -0.2, 2.3))]
    return model


def table():
    model = Model("table")
    top = slab(rounded_rectangle(1.4, 0.9, 0.05, 6), 0.03, 0.006, 3)
    model.add(WOOD, top, (0, 0, TABLE_Z - 0.03))
    for x in (-0.62, 0.62):
        for y in (-0.38, 0.38):
            model.add(STEEL, rounded_box(0.05, 0.05, TABLE_Z - 0.03, 0.008, 2), (x, y, (TABLE_Z - 0.03) / 2))
        model.add(STEEL, box(0.03, 0.72, 0.06), (x, 0, TABLE_Z - 0.07))
    model.add(STEEL, box(1.2, 0.03, 0.06), (0, 0.38, TABLE_Z - 0.07))
    return model


def mat():
    """A cutting mat with a grid of 5 cm; its origin is under its middle."""
    model = Model("mat")
    model.add(MAT, slab(rounded_rectangle(0.45, 0.6, 0.015, 4), 0.003, 0.001, 1))
    for i in range(-4, 5):
        model.add(MAT_LINE, box(0.001, 0.56, 0.0006), (0.05 * i, 0, 0.003))
    for i in range(-5, 6):
        model.add(MAT_LINE, box(0.42, 0.001, 0.0006), (0, 0.05 * i, 0.003))
    return model


def block(name, color):
    """A cube; its origin is its middle."""
    model = Model(name)
    model.add(_paint(name, color), rounded_box(BLOCK, BLOCK, BLOCK, 0.004, 3))
    return model


def ball():
    model = Model("ball")
    model.add(_paint("ball", "#d8c23a"), sphere(0.032, 32, 20), (0, 0, 0.032))
    return model


def mug():
    model = Model("mug")
    clay, coffee = _paint("mug", "#f2efe6"), _paint("coffee", "#2e1a10")
    model.add(clay, lathe([(0, 0), (0.034, 0), (0.038, 0.004), (0.038, 0.09), (0.0365, 0.092), (0.035, 0.09),
                           (0.035, 0.07)], 32))
    model.add(coffee, lathe([(0.035, 0.07), (0, 0.0701)], 32))
    handle = filleted([(0.036, 0, 0.075), (0.066, 0, 0.075), (0.066, 0, 0.022), (0.036, 0, 0.022)], 0.018, 5)
    model.add(clay, tube(handle, 0.005, 10))
    return model


def tray():
    """An open box to put things into; its origin is under its middle."""
    model = Model("tray")
    paint, sx, sy, height, wall = _paint("tray", "#3d5f8f"), 0.22, 0.16, 0.045, 0.006
    model.add(paint, box(sx, sy, wall), (0, 0, wall / 2))
    for x in (-1, 1):
        model.add(paint, rounded_box(wall, sy, height, 0.002, 1), (x * (sx - wall) / 2, 0, height / 2))
    for y in (-1, 1):
        model.add(paint, rounded_box(sx, wall, height, 0.002, 1), (0, y * (sy - wall) / 2, height / 2))
    return model


def models():
    made = [corner(), table(), mat(), block("block_red", "#c8412f"), block("block_green", "#4f9a4a"),
            block("block_blue", "#2f62ad"), ball(), mug(), tray()]
    for model in made:
        model.check()
    return made
