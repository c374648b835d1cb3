#!/usr/bin/env python3
"""The drawing of frames and angles for docs/conventions.md: `frames.py FOLDER` writes frames.svg there."""
import math
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "bench/plots"))

import figure  # first: it chooses how matplotlib draws
from matplotlib.patches import Arc, FancyArrowPatch, Polygon
from matplotlib.pyplot import subplots

X, Y, Z, INK, FAINT, ACCENT = "#c62828", "#2e7d32", "#1565c0", "#333333", "#9aa5ad", "#d55e00"
BODY, PLANE = "#e8edf1", "#fff3d6"

# Where a step of a metre along x, y and z goes on the page, seen from behind, from the right and from above.
ALONG_X, ALONG_Y, ALONG_Z = (0.80, 0.36), (-0.62, 0.26), (0.0, 1.0)


def page(x, y, z):
    return tuple(x * ALONG_X[i] + y * ALONG_Y[i] + z * ALONG_Z[i] for i in (0, 1))


def arrow(axes, start, end, color, width=1.4, head=9, style="-|>", line="solid"):
    axes.add_patch(FancyArrowPatch(start, end, arrowstyle=style, mutation_scale=head, color=color, linewidth=width,
                                   linestyle=line, shrinkA=0, shrinkB=0))


def label(axes, place, text, color=INK, size=8, **options):
    axes.text(*place, text, color=color, fontsize=size, **{"ha": "center", "va": "center", **options})


def path(axes, points, color, width=1.0, line="solid", zorder=2):
    axes.plot(*zip(*points), color=color, linewidth=width, linestyle=line, solid_capstyle="round", zorder=zorder)


def face(axes, corners, color):
    axes.add_patch(Polygon([page(*corner) for corner in corners], facecolor=color, edgecolor=FAINT, linewidth=0.8))


def box(axes, x, y, z):
    """The three faces that are seen of a box; x, y and z: (least, greatest)."""
    (x0, x1), (y0, y1), (z0, z1) = x, y, z
    face(axes, [(x0, y0, z0), (x0, y1, z0), (x0, y1, z1), (x0, y0, z1)], "#dde4ea")
    face(axes, [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)], "#cfd8df")
    face(axes, [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)], BODY)


def turn(axes, center, first, second, radius, color):
    """A curved arrow from direction `first` towards `second`: three quarters of a circle about `center`."""
    points = []
    for step in range(41):
        angle = math.radians(270 * step / 40)
        points.append(page(*(c + radius * (math.cos(angle) * a + math.sin(angle) * b)
                             for c, a, b in zip(center, first, second))))
    path(axes, points[:-2], color)
    arrow(axes, points[-4], points[-1], color, width=1.0, head=7)


def three_axes(axes, origin, lengths):
    ends = [tuple(o + (length if i == k else 0) for i, o in enumerate(origin)) for k, length in enumerate(lengths)]
    for end, color in zip(ends, (X, Y, Z)):
        arrow(axes, page(*origin), page(*end), color, width=1.8)
    return [page(*end) for end in ends]


def draw_body(axes):
    axes.set_title("Body frame, right-handed", loc="left")
    box(axes, (-0.55, 0.55), (-0.38, 0.38), (-0.3, 0))
    x, y, z = three_axes(axes, (0, 0, 0), (1.35, 1.2, 0.95))
    label(axes, x, "x forward", X, ha="left", va="bottom")
    label(axes, y, "y left", Y, ha="right", va="bottom")
    label(axes, z, "z up", Z, va="bottom")
    turn(axes, (1.0, 0, 0), (0, 0, -1), (0, 1, 0), 0.15, X)
    turn(axes, (0, 0.88, 0), (1, 0, 0), (0, 0, -1), 0.15, Y)
    turn(axes, (0, 0, 0.66), (0, -1, 0), (1, 0, 0), 0.17, Z)
    label(axes, (1.04, 0.12), "roll", X)
    label(axes, (-0.78, 0.04), "pitch", Y)
    label(axes, (0.3, 0.72), "yaw", Z)
    label(axes, (0.1, -0.78), "pose: x y z roll pitch yaw;  R = Rz(yaw) Ry(pitch) Rx(roll)", size=7.5)
    axes.set_xlim(-1.25, 1.6)
    axes.set_ylim(-0.9, 1.25)


def draw_camera(axes):
    axes.set_title("Camera: looks along +x of its sensor frame", loc="left")
    near, half_width, half_height = 1.0, 0.62, 0.42
    corners = [(near, half_width, half_height), (near, -half_width, half_height), (near, -half_width, -half_height),
               (near, half_width, -half_height)]
    target = (2.0, -0.5, 0.5)
    pixel = tuple(c * near / target[0] for c in target)
    foot = (target[0], 0, 0)
    for corner in corners:
        path(axes, [page(0, 0, 0), page(*corner)], FAINT, 0.6)
    face(axes, corners, PLANE)
    top_left, top_right, _, bottom_left = corners
    arrow(axes, page(*top_left), page(*top_right), INK)
    arrow(axes, page(*top_left), page(*bottom_left), INK)
    label(axes, page(near, 0, half_height + 0.1), "columns to the right", size=7.5, rotation=-22.7)
    label(axes, page(near, half_width + 0.13, 0.05), "rows down", size=7.5, rotation=90)
    label(axes, page(near, half_width + 0.22, half_height), "pixel (0, 0)", size=7, ha="right")
    arrow(axes, page(0, 0, 0), page(*foot), ACCENT, width=1.8, style="<|-|>", head=8)
    label(axes, page(2.06, -0.0, -0.12), "depth: along the\noptical axis", ACCENT, size=7.5, ha="left", va="top")
    path(axes, [page(*foot), page(*target)], FAINT, 0.8, "dashed")
    path(axes, [page(0, 0, 0), page(*target)], INK, 0.8, "dashed")
    for place in (target, pixel):
        axes.plot(*page(*place), "o", markersize=4, color=INK)
    label(axes, page(target[0], target[1] - 0.06, target[2] + 0.06), "surface point", size=7.5, ha="left")
    x, y, z = three_axes(axes, (0, 0, 0), (0.5, 0.5, 0.5))
    label(axes, (x[0] - 0.04, x[1] - 0.15), "x", X)
    label(axes, (y[0] - 0.06, y[1] + 0.02), "y", Y)
    label(axes, (z[0], z[1] + 0.09), "z", Z)
    label(axes, (-0.7, -0.6), "view (optical) frame: x right, y down, z along the optical axis", size=7.5, ha="left")
    axes.set_xlim(-0.75, 2.6)
    axes.set_ylim(-0.65, 1.55)


def fan(axes, angles_deg, reach, first_color, color):
    for index, angle in enumerate(angles_deg):
        end = reach * math.cos(math.radians(angle)), reach * math.sin(math.radians(angle))
        ends = index in (0, len(angles_deg) - 1)
        path(axes, [(0, 0), end], first_color if ends else color, 1.4 if ends else 0.7, zorder=0.5)


def angle_arrow(axes, radius, angle_deg, color):
    axes.add_patch(Arc((0, 0), 2 * radius, 2 * radius, theta1=0, theta2=angle_deg - 4, color=color, linewidth=1.6))
    points = [(radius * math.cos(math.radians(a)), radius * math.sin(math.radians(a)))
              for a in (angle_deg - 6, angle_deg)]
    arrow(axes, *points, color, width=1.6)


def draw_azimuth(axes):
    axes.set_title("Scan from above: azimuth, counter-clockwise from +x", loc="left")
    fan(axes, [-60 + 12 * i for i in range(11)], 1.5, ACCENT, FAINT)
    arrow(axes, (0, 0), (1.95, 0), X, width=1.8)
    arrow(axes, (0, 0), (0, 1.2), Y, width=1.8)
    label(axes, (2.0, 0), "x", X, ha="left")
    label(axes, (0, 1.3), "y", Y)
    angle_arrow(axes, 0.95, 36, INK)
    label(axes, (1.5, 0.5), "azimuth > 0", ha="left", size=7.5)
    label(axes, (0.82, -1.38), "beam 0 at min_angle", ACCENT, ha="left")
    label(axes, (0.82, 1.38), "beam n − 1 at max_angle", ACCENT, ha="left")
    axes.set_xlim(-0.4, 2.45)
    axes.set_ylim(-1.55, 1.55)


def draw_elevation(axes):
    axes.set_title("Scan from the side: elevation, positive upwards", loc="left")
    fan(axes, [-20 + 10 * i for i in range(5)], 1.7, ACCENT, FAINT)
    arrow(axes, (0, 0), (2.15, 0), X, width=1.8)
    arrow(axes, (0, 0), (0, 1.0), Z, width=1.8)
    label(axes, (2.2, 0), "x", X, ha="left")
    label(axes, (0, 1.1), "z", Z)
    angle_arrow(axes, 1.1, 20, INK)
    label(axes, (1.0, 0.55), "elevation > 0", size=7.5)
    label(axes, (1.66, -0.68), "ring 0 at\nvertical_min_angle", ACCENT, ha="left")
    label(axes, (1.66, 0.72), "last ring at\nvertical_max_angle", ACCENT, ha="left")
    label(axes, (-0.3, -1.15), "arrays: ring by ring, in each ring beam by beam:  range_m[ring * beams + beam]", size=7.5,
          ha="left")
    axes.set_xlim(-0.4, 2.75)
    axes.set_ylim(-1.4, 1.4)


def main():
    drawing, panels = subplots(2, 2, figsize=(9, 6.2), layout="constrained")
    for axes, draw in zip(panels.flat, (draw_body, draw_camera, draw_azimuth, draw_elevation)):
        axes.axis("off")
        axes.set_aspect("equal", anchor="N")
        draw(axes)
    drawing.savefig(Path(sys.argv[1]) / "frames.svg", metadata={"Date": None, "Creator": None}, facecolor="white")


if __name__ == "__main__":
    main()
