"""The ground: a height function made of waves, a worn path with two ruts, hills far away, and the mesh of it.

z is a sum of sines, so that its curvature has a bound, from which the error of a flat facet follows. ground.csv lists the
waves, so that other programs can compute heights as well; tests/scenes/ravon_scene_test.cpp does.
"""
import math
import random

from gltf_writer import Surface

import materials
from shapes import unit

# (wavelength in m, amplitude in m); each comes twice, along directions of its own. The last three are fine relief,
# which the path wears down.
RELIEF = [(52, 0.50), (31, 0.30), (19, 0.17), (11, 0.085), (6.3, 0.045), (3.7, 0.022), (2.3, 0.011)]
FINE_WAVES = 6
RUT_OFFSET_M, RUT_WIDTH_M, RUT_DEPTH_M = 0.62, 0.22, 0.06
HOLLOW_WIDTH_M, HOLLOW_DEPTH_M = 1.7, 0.13
FRINGE_LIFT_M = 0.012  # how far the last blades of turf lie above the earth
HILLS_BEGIN_M = 70.0  # no hills nearer to the origin than this


def _waves():
    rng = random.Random(7)
    waves = []
    for wavelength, amplitude in RELIEF:
        for _ in range(2):
            direction, k = 2 * math.pi * rng.random(), 2 * math.pi / (wavelength * (0.85 + 0.3 * rng.random()))
            waves.append((amplitude, round(k * math.cos(direction), 6), round(k * math.sin(direction), 6),
                          round(2 * math.pi * rng.random(), 6)))
    return waves


WAVES = _waves()
COARSE, FINE = WAVES[:-FINE_WAVES], WAVES[-FINE_WAVES:]


def _sum_of(waves, x, y):
    total = 0.0
    for amplitude, kx, ky, phase in waves:
        total += amplitude * math.sin(kx * x + ky * y + phase)
    return total


def csv():
    lines = ["amplitude_m,kx_rad_per_m,ky_rad_per_m,phase_rad"]
    return "\n".join(lines + [",".join(f"{v:.6f}" for v in wave) for wave in WAVES]) + "\n"


def path_y(x):
    """The middle of the path."""
    return 2.6 * math.sin(0.1366 * x + 0.4) + 0.9 * math.sin(0.2732 * x + 1.2)


def path_slope(x):
    return 2.6 * 0.1366 * math.cos(0.1366 * x + 0.4) + 0.9 * 0.2732 * math.cos(0.2732 * x + 1.2)


def from_path(x, y):
    """Signed distance to the middle of the path, to first order; left is positive."""
    slope = path_slope(x)
    return (y - path_y(x)) / math.sqrt(1 + slope * slope)


def _hills(x, y):
    t = (math.hypot(x, y) - HILLS_BEGIN_M) / 330
    if t <= 0:
        return 0.0
    t = min(t, 1.0)
    a = math.atan2(y, x)
    ridge = 26 + 13 * math.sin(2 * a + 0.6) + 9 * math.sin(5 * a + 2.1) + 4 * math.sin(11 * a + 0.3)
    return t * t * (3 - 2 * t) * (ridge + 4 * math.sin(0.021 * x + 1) * math.sin(0.027 * y))


def height(x, y):
    d = from_path(x, y)
    worn = math.exp(-(d / HOLLOW_WIDTH_M) ** 2)
    coarse, fine = _sum_of(COARSE, x, y), _sum_of(FINE, x, y)
    ruts = math.exp(-((d - RUT_OFFSET_M) / RUT_WIDTH_M) ** 2) + math.exp(-((d + RUT_OFFSET_M) / RUT_WIDTH_M) ** 2)
    bank = 1.3 * (1 - math.exp(-(y / 14) ** 2)) + 0.9 * math.tanh(y / 25)
    return coarse + fine * (1 - 0.6 * worn) + bank - HOLLOW_DEPTH_M * worn - RUT_DEPTH_M * ruts + _hills(x, y)


def normal(x, y, step=0.15):
    return unit((height(x - step, y) - height(x + step, y), height(x, y - step) - height(x, y + step), 2 * step))


def _cuts(step, half, reach, growth):
    """Evenly spaced within `half` of 0, ever wider beyond, up to `reach`."""
    count = round(half / step)
    cuts, at, width = [i * step for i in range(count + 1)], half, step
    while at < reach:
        width *= growth
        at += width
        cuts.append(at)
    return [-c for c in cuts[:0:-1]] + cuts


TILE_M = 2.6  # the width of the textures on the ground
XS, YS = _cuts(0.4, 28, 560, 1.1), _cuts(0.2, 7, 560, 1.1)


def patchiness(x, y):
    """Smooth and irregular, -1 to 1: where grass is poorer."""
    return (math.sin(0.83 * x + 1.7 * math.sin(0.37 * y)) * math.sin(0.71 * y + 1.3 * math.sin(0.53 * x + 1)) +
            0.5 * math.sin(2.3 * x + 1.1 * y + 0.7) * math.sin(1.9 * y - 0.8 * x)) / 1.5


def greenness(x, y):
    """1 on the meadow, 0 on bare earth."""
    d, rough = abs(from_path(x, y)), patchiness(x, y)
    if abs(x) > 90:
        return 1.0
    edge = (d - 0.95 - 0.22 * rough) / 0.55
    middle = 0.66 - d / 0.42 + 0.6 * rough
    bare = (0.72 - rough) * 3.0
    return max(0.0, min(1.0, max(min(edge, bare), middle)))


def _haze(tint, x, y, shade):
    far = min(1.0, max(0.0, (math.hypot(x, y) - 60) / 420))
    return tuple((t + (h - t) * 0.75 * far) * (shade + (1 - shade) * far) for t, h in zip(tint, (0.55, 0.68, 0.88)))


def _turf_color(x, y, green, shade):
    dry = min(1.0, max(0.0, 0.35 + 0.5 * patchiness(0.31 * x + 5, 0.29 * y) + 0.5 * (1 - green)))
    shade *= 0.92 + 0.14 * patchiness(0.07 * x, 0.09 * y + 4)
    return _haze((0.62 + 0.30 * dry, 0.72 + 0.06 * dry, 0.55 + 0.12 * dry), x, y, shade)


def _earth_color(x, y, green, shade):
    """Damp and dark in the ruts, and under the turf's edge."""
    d = abs(from_path(x, y))
    rut = math.exp(-((d - RUT_OFFSET_M) / (1.15 * RUT_WIDTH_M)) ** 2)
    light = (1 - 0.30 * rut) * (1 - 0.35 * green) * (0.92 + 0.12 * patchiness(1.7 * x, 1.3 * y + 2))
    return _haze((0.98 * light, 0.95 * light, 0.92 * light), x, y, shade)


def surfaces(shade_at):
    """The mesh: earth, turf, and between them a fringe of turf over earth that thins out towards bare ground."""
    z = [[height(x, y) for y in YS] for x in XS]
    base, greens, lights = [], [], []
    for i, x in enumerate(XS):
        before, after = max(i - 1, 0), min(i + 1, len(XS) - 1)
        for j, y in enumerate(YS):
            below, above = max(j - 1, 0), min(j + 1, len(YS) - 1)
            slope_x = (z[after][j] - z[before][j]) / (XS[after] - XS[before])
            slope_y = (z[i][above] - z[i][below]) / (YS[above] - YS[below])
            greens.append(greenness(x, y))
            lights.append(shade_at(x, y))
            base.append(((x, y, z[i][j]), unit((-slope_x, -slope_y, 1)), (x / TILE_M, -y / TILE_M)))
    turf, earth, fringe = [], [], []
    n = len(YS)
    for i in range(len(XS) - 1):
        for j in range(n - 1):
            a, b, c, d = i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1
            for triangle in ((a, b, c), (a, c, d)):
                green = [greens[v] for v in triangle]
                (turf if min(green) >= 0.999 else earth).append(triangle)
                if min(green) < 0.999 and max(green) > 0:
                    fringe.append(triangle)

    def vertex(color, v, lift=0.0, alpha=None):
        (x, y, height_m), normal_, uv = base[v]
        tint = color(x, y, greens[v], lights[v])
        return (x, y, height_m + lift), normal_, uv, tint if alpha is None else (*tint, alpha)
    return [_surface(materials.TURF, turf, lambda v: vertex(_turf_color, v)),
            _surface(materials.EARTH, earth, lambda v: vertex(_earth_color, v)),
            _surface(materials.FRINGE, fringe, lambda v: vertex(_turf_color, v, FRINGE_LIFT_M, greens[v]))]


def _surface(material, triangles, vertex):
    known, used, indices = {}, [], []
    for triangle in triangles:
        for v in triangle:
            if v not in known:
                known[v] = len(used)
                used.append(vertex(v))
            indices.append(known[v])
    return Surface(material, *(list(column) for column in zip(*used)), indices)
