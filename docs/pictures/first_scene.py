#!/usr/bin/env python3
"""The README's first scene: `first_scene.py FOLDER` writes there what its camera sees, and its scan from above."""
import sys
import tempfile
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "bench/plots"))

import figure
from matplotlib.image import imsave
from matplotlib.pyplot import subplots

import panels
from runs import ROOT, run_scene

SCENE = ROOT / "scenes/first/first.xml"
VIEW = (-0.4, 6.2, -4.0, 4.6)  # metres: least x, greatest x, least y, greatest y
NAMES = ((1.25, 0.45, "chair"), (3.5, 0.95, "table"), (2.6, -1.85, "plant"))


def draw_scan(path, scan):
    drawing, axes = subplots(figsize=(4.0, 4.8), layout="constrained")
    panels.show_scan(axes, scan, VIEW, names=NAMES)
    axes.set_xlabel("x in m, forward")
    axes.set_ylabel("y in m, to the left")
    drawing.savefig(path, dpi=figure.DOTS_PER_INCH, metadata={"Software": None})


def main():
    folder = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as out:
        run = run_scene(SCENE, out)
        image, scan = run.image("CAMERA"), run.scan("SCANNER")
    imsave(folder / "first_camera.jpg", image[..., :3], pil_kwargs={"quality": 88})
    draw_scan(folder / "first_scan.png", scan)


if __name__ == "__main__":
    main()
