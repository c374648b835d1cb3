#!/usr/bin/env python3
"""Drawn depth against cast depth: how far apart they are, beside the bound that each drawn pixel states. Prints a table as CSV.

  bench/camera_depth.py [--frames N]

Two cameras stand in the same place. One draws depth, with depth_error_bound; the other also measures normals, so that a ray gives
the depth of each of its pixels. A row counts pixels whose bound and whose difference lie in one cell of a grid with steps of
10^(1/4). A pixel beyond its bound is counted under `edge` if its ray and those of its eight neighbours hit different planes. Within 1/256 pixel of its centre, such a pixel may show either surface."""
import argparse
import csv
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
RUN = ROOT / "build/release/bin/simvis-run"
LEAST, STEPS = 1e-9, 4  # smaller differences stand in the first cell; steps of a decade
FLOAT = 2.0 ** -24
HFOV_DEG = 90

ROUND = ('<part name="ROOM" insert_at="ROOT" shape="box" size="12 12 6" pose_offset="0 0 2.5 0 0 0"/>'
         '<repeat count="40" as="i"><part name="BALL_${i}" insert_at="ROOT" shape="sphere" radius="${0.05+i/100}" '
         'pose_offset="${1+i/10} ${sin(37*i)*(1+i/12)} ${cos(71*i)} 0 0 0"/></repeat>')
CAMERAS = ('<sensor type="camera" name="DRAWN" insert_at="{at}" pose_offset="{pose}" width="640" height="480" hfov="90" '
           'outputs="depth depth_error_bound"/>'
           '<sensor type="camera" name="CAST" insert_at="{at}" pose_offset="{pose}" width="640" height="480" hfov="90" '
           'outputs="depth normal"/>')


def scenes():
    marvin = f'<include file="{ROOT / "scenes/marvin/marvin.xml"}"/>'
    ravon = f'<include file="{ROOT / "scenes/ravon/ravon.xml"}"/>'
    return {"marvin": marvin + CAMERAS.format(at="ROBOT", pose="0.062 0.09 1.41 0 12 0"),
            "ravon": ravon + CAMERAS.format(at="ROBOT", pose="0.5 0 1.5 0 5 0"),
            "forty spheres": ROUND + CAMERAS.format(at="ROOT", pose="-2 0 0.5 0 5 0")}


def measure(name, xml, frames, folder):
    """Arrays of pixels: drawn, bound, cast; those through which an edge passes."""
    scene, out = folder / "scene.xml", folder / "out"
    scene.write_text(f"<simvis>{xml}</simvis>")
    subprocess.run([RUN, "--quiet", "--frames", str(frames), "--rate", "1", "--sensor", "DRAWN", "--sensor", "CAST", "--format", "npy",
                    "--out", out, scene], check=True)
    drawn, bound, cast, edge = [], [], [], []
    for frame in range(frames):
        read = lambda sensor, output: np.load(out / f"{sensor}_{output}/{frame:06d}.npy").astype(float)
        drawn.append(read("DRAWN", "depth").ravel())
        bound.append(read("DRAWN", "depth_error_bound").ravel())
        cast.append(read("CAST", "depth").ravel())
        edge.append(edges(read("CAST", "depth"), read("CAST", "normal")).ravel())
    return (np.concatenate(each) for each in (drawn, bound, cast, edge))


def edges(depth, normal):
    """Returns an array that is true at each pixel of which a neighbour sees another plane: its normal differs, or it is more than
    0.1 mm away."""
    height, width = depth.shape
    focal_px = width / 2 / np.tan(np.radians(HFOV_DEG) / 2)
    y, x = np.mgrid[0:height, 0:width] + 0.5
    ray = np.dstack([(x - width / 2) / focal_px, (y - height / 2) / focal_px, np.ones_like(x)])
    with np.errstate(invalid="ignore"):
        offset = depth * (normal * ray).sum(axis=2)  # of the plane from the camera
    surface = np.dstack([normal, np.round(np.nan_to_num(offset) / 1e-4)])
    around = np.pad(surface, ((1, 1), (1, 1), (0, 0)), mode="edge")
    changes = np.zeros((height, width), bool)
    for dy in range(3):
        for dx in range(3):
            apart = np.abs(around[dy:dy + height, dx:dx + width] - surface)
            changes |= (apart[..., :3] != 0).any(axis=2) | (apart[..., 3] > 1)
    return changes


def cell(values):
    return np.floor(STEPS * np.log10(np.maximum(values, LEAST)) + 1e-9) / STEPS


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--frames", type=int, default=4)
    options = parser.parse_args()
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(["scene", "bound_log10_m", "difference_log10_m", "pixels", "beyond_bound", "edge"])
    for name, xml in scenes().items():
        with tempfile.TemporaryDirectory() as folder:
            drawn, bound, cast, edge = measure(name, xml, options.frames, Path(folder))
        seen = np.isfinite(drawn) & np.isfinite(cast) & np.isfinite(bound)
        difference = np.abs(drawn - cast)
        beyond = difference > bound + FLOAT * cast  # the cast depth is a float, too
        cells = Counter(zip(cell(bound[seen]), cell(difference[seen])))
        over = Counter(zip(cell(bound[seen & beyond & ~edge]), cell(difference[seen & beyond & ~edge])))
        at_edge = Counter(zip(cell(bound[seen & beyond & edge]), cell(difference[seen & beyond & edge])))
        for place in sorted(cells):
            writer.writerow([name, f"{place[0]:g}", f"{place[1]:g}", cells[place], over[place], at_edge[place]])


if __name__ == "__main__":
    main()
