"""A bush of Gaussian splats, as a file of the program of Kerbl et al. 2023: flat leaves around a middle, on a trunk.

The origin is on the ground below the bush: z up, metres.
"""
import math
import random
import struct

DEGREE_0 = 0.28209479177387814
NAMES = (["x", "y", "z", "nx", "ny", "nz"] + [f"f_dc_{i}" for i in range(3)] + [f"f_rest_{i}" for i in range(9)] +
         ["opacity"] + [f"scale_{i}" for i in range(3)] + [f"rot_{i}" for i in range(4)])


def _splat(place, sigma, turn, opacity, color, brighter_from_above):
    """Colours are sRGB; a harmonic of degree 1 makes them brighter for those who look down on them."""
    rest = [0.0] * 9
    for channel in range(3):
        rest[3 * channel + 1] = -brighter_from_above * color[channel]
    return [*place, 0.0, 0.0, 0.0, *((c - 0.5) / DEGREE_0 for c in color), *rest,
            math.log(opacity / (1 - opacity)), *(math.log(s) for s in sigma), *turn]


def _turn(chance):
    q = [chance.gauss(0, 1) for _ in range(4)]
    length = math.sqrt(sum(c * c for c in q))
    return [c / length for c in q]


def bush():
    chance = random.Random(5)
    splats = []
    for _ in range(400):
        way = [chance.gauss(0, 1) for _ in range(3)]
        length = math.sqrt(sum(c * c for c in way))
        out = 0.28 * (0.55 + 0.45 * chance.random())
        place = [c / length * out for c in way]
        place[2] = 0.5 + 0.9 * place[2]
        light = 0.6 + 0.5 * (place[2] - 0.25)
        green = [0.22 * light + 0.1 * chance.random(), 0.62 * light, 0.18 * light]
        splats.append(_splat(place, (0.035, 0.022, 0.003), _turn(chance), 0.75 + 0.2 * chance.random(), green, 0.3))
    for step in range(14):
        place = [0.01 * math.sin(step), 0.01 * math.cos(2 * step), 0.03 * step]
        splats.append(_splat(place, (0.025, 0.025, 0.025), [1, 0, 0, 0], 0.95, [0.36, 0.25, 0.16], 0.0))
    return splats


def ply(splats):
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(splats)}",
             *(f"property float {name}" for name in NAMES), "end_header", ""]
    return "\n".join(lines).encode() + b"".join(struct.pack(f"<{len(NAMES)}f", *splat) for splat in splats)
