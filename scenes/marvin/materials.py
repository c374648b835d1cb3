"""Every surface of the laboratory and the robot, by name."""
import painting
import pictures
from gltf_writer import Material, linear


def _plain(name, color, **more):
    return Material(name, linear(color), **more)


def _picture(name, texture, **more):
    return Material(name, texture=texture, **more)


def _glowing(name, color, strength):
    return Material(name, linear(color), emissive=tuple(round(strength * c, 4) for c in linear(color)[:3]))


PLASTER = painting.grey("plaster", 256, 256, [(5, 5, 0.02), (48, 48, 0.025), (128, 128, 0.03)], 1, 0.965)
FABRIC = painting.grey("fabric", 128, 128, [(64, 128, 0.25), (128, 64, 0.25), (8, 8, 0.06)], 2, 0.82)

# Rooms.
FLOOR = _picture("floor planks", painting.wood("planks", 512, ["#7d5a38", "#b08a5c", "#cfae80"], 31, boards=12),
                 tile_m=(3.0, 1.92))
WALL = _plain("wall", "#f1ede2", texture=PLASTER, tile_m=(1.5, 1.5))
WALL_ACCENT = _plain("accent wall", "#8fb0b5", texture=PLASTER, tile_m=(1.5, 1.5))
# The lamps shine downwards only; the glow stands for the light that the room throws back at its ceiling.
CEILING = Material("ceiling", linear("#f4f4f0"), pictures.ceiling_tiles(), (1.2, 1.2), (0.3, 0.3, 0.29))
SKIRTING = _plain("skirting", "#e9e6de")
FRAME_WHITE = _plain("white frame", "#f0f0ec")
DOOR_FRAME = _plain("door frame", "#6e7b83")
DOOR_WOOD = _picture("door wood", painting.wood("door wood", 256, ["#8a5a34", "#b37f4e", "#c99a68"], 32),
                     tile_m=(1.6, 0.9))
GLASS = Material("glass", linear("#d5e6e4", 0.1), blend=True, roughness=0.1)
OUTSIDE = _picture("outside", pictures.outside(), unlit=True)
OUTSIDE_SKY = _plain("sky", "#7db4e6", unlit=True)
OUTSIDE_GROUND = _plain("meadow", "#7d9f5b", unlit=True)
CORRIDOR_FLOOR = _plain("corridor floor", "#8b9096", texture=PLASTER, tile_m=(1.5, 1.5))
CARPET = _plain("carpet", "#5d6f8c", texture=FABRIC, tile_m=(0.5, 0.5))
CARPET_RIM = _plain("carpet rim", "#3f4c63", texture=FABRIC, tile_m=(0.5, 0.5))

# Furniture.
TABLE_WOOD = _picture("table wood", painting.wood("table wood", 256, ["#a9793f", "#d3a768", "#e7c78f"], 33),
                      tile_m=(1.2, 0.8))
STEEL = _plain("steel", "#9aa1a7")
CHROME = _plain("chrome", "#c4c9cd", roughness=0.3)
DARK_STEEL = _plain("dark steel", "#3d4349")
BLACK = _plain("black plastic", "#25282c")
GREY = _plain("grey plastic", "#b9bcbd")
LIGHT_GREY = _plain("light plastic", "#dedfdc")
RUBBER = _plain("rubber", "#1c1d1f")
SEAT_BLUE = _plain("blue fabric", "#3f6ea3", texture=FABRIC, tile_m=(0.16, 0.16))
SEAT_RED = _plain("red fabric", "#b4553f", texture=FABRIC, tile_m=(0.16, 0.16))
LACQUER = _plain("white lacquer", "#ece9e1")
LACQUER_TEAL = _plain("teal lacquer", "#5f9a98")
HOLE = _plain("shadow gap", "#16181a")
CARDBOARD = _plain("cardboard", "#b98d5e", texture=PLASTER, tile_m=(0.4, 0.4))
TAPE = _plain("tape", "#d8bf95")
PAPER = _plain("paper", "#f3f0e6")
BOOK = _picture("book spines", pictures.book_spines())
BOX_BLUE = _plain("blue box", "#38618c")
BOX_GREEN = _plain("green box", "#5c8f5a")
BOX_GREY = _plain("grey box", "#9a9c98")

# Things on tables and walls.
CODE_SCREEN = _picture("code", pictures.code_screen(), unlit=True)
SCAN_SCREEN = _picture("scan", pictures.scan_screen(), unlit=True)
KEYS = _picture("keys", pictures.keyboard())
MUG = _plain("mug", "#c8503c")
COFFEE = _plain("coffee", "#2e1a10")
WHITEBOARD = _picture("whiteboard", pictures.whiteboard())
POSTER = _picture("poster", pictures.poster())
CLOCK = _picture("clock", pictures.clock())
MARKER = _plain("marker", "#2456a8")
FIRE_RED = _plain("signal red", "#c2211c")
RADIATOR = _plain("radiator", "#eeede8")
LAMP = _glowing("lamp", "#fff6e3", 1.0)
POT = _plain("pot", "#c7794f")
SOIL = _plain("soil", "#3c2a1e")
LEAF = _plain("leaf", "#4f8f3d", double_sided=True)
LEAF_DARK = _plain("dark leaf", "#37732f", double_sided=True)
STALK = _plain("stalk", "#6d7d3b")

# The robot.
SHELL = _plain("shell", "#e9ecee")
ORANGE = _plain("orange", "#ee7f1a")
CHASSIS = _plain("chassis", "#3a4048")
ALUMINIUM = _plain("aluminium", "#b7bdc2")
SCANNER_YELLOW = _plain("scanner yellow", "#f2c218")
SCANNER_WINDOW = _plain("scanner window", "#3a0f14")
LENS = _plain("lens", "#101a2c")
LENS_SHINE = _glowing("lens shine", "#3b5fa0", 0.4)
STATUS = _glowing("status light", "#38e07a", 0.9)
