#!/usr/bin/env python3
"""One sheet of what `bench/effects --pictures FOLDER` has written: `effects_strips.py FOLDER SHEET.jpg`."""
import sys
from pathlib import Path

from matplotlib.pyplot import imread, subplots

import figure

COLUMNS = 2


def main():
    strips = sorted(Path(sys.argv[1]).glob("*.png"))
    lines = -(-len(strips) // COLUMNS)
    drawing, panels = subplots(lines, COLUMNS, figsize=(13, 2.08 * lines), squeeze=False, layout="constrained")
    for axes in panels.flat:
        axes.axis("off")
    for axes, strip in zip(panels.flat, strips):
        axes.imshow(imread(strip), interpolation="antialiased")
        name = strip.stem
        axes.set_title(f"{name[:-5]}, scan from above" if name.endswith("_scan") else name, loc="left")
    drawing.savefig(sys.argv[2], dpi=figure.DOTS_PER_INCH, pil_kwargs={"quality": 82})


if __name__ == "__main__":
    main()
