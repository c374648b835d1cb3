#!/usr/bin/env python3
"""What bench/scan_curves prints, as curves: time per set over triangles and over beams.

`scan_curves.py FILE.csv FOLDER` writes FOLDER/scan_curves.{svg,png}."""
import sys
from pathlib import Path

from matplotlib.pyplot import subplots
from matplotlib.ticker import FuncFormatter, LogLocator

import figure

# (way, max_error_rel, threads): label, colour, marker, line.
SERIES = {
    ("nearest", "", "0"): ("nearest", "#999999", "s", "-"),
    ("planar", "", "0"): ("planar", "#0072b2", "o", "-"),
    ("hybrid", "1e-4", "0"): ("hybrid 1e-4", "#009e73", "v", "-"),
    ("hybrid", "1e-6", "0"): ("hybrid 1e-6", "#cc79a7", "P", "-"),
    ("raycast", "", "0"): ("raycast", "#d55e00", "*", "-"),
    ("auto", "1e-4", "0"): ("auto 1e-4", "#56b4e9", "^", "--"),
    ("auto", "1e-6", "0"): ("auto 1e-6", "#e69f00", "D", "--"),
    ("embree 1", "", "1"): ("Embree, single rays, 1 thread", "#000000", "x", ":"),
    ("embree 1", "", "2"): ("Embree, single rays, 2 threads", "#000000", "x", "-"),
    ("embree 16", "", "1"): ("Embree, packets, 1 thread", "#000000", "+", ":"),
    ("embree 16", "", "2"): ("Embree, packets, 2 threads", "#000000", "+", "-"),
    ("coin depth", "", "2"): ("Coin, OpenGL's depth", "#8c564b", "<", "-"),
    ("coin pick", "", "1"): ("Coin, ray pick", "#8c564b", ">", "-"),
}
CURVES = {"triangles": ("three scans of 361 beams in labs", "triangles"),
          "beams": ("one scan in a lab of 100,000 triangles", "beams")}
HEIGHT_INCHES, LEGEND_INCHES = 4.8, 0.6


def key(row):
    return row["way"], row["max_error_rel"], row["threads"]


def draw_curve(axes, rows, column):
    for series, (label, color, marker, line) in SERIES.items():
        points = [(float(row[column]), float(row["median_ms"])) for row in rows if key(row) == series]
        if points:
            axes.plot(*zip(*points), color=color, marker=marker, markersize=4, linestyle=line, label=label)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=12))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda time_ms, _: f"{time_ms:g}"))
    axes.minorticks_off()


def draw(rows):
    drawing, panels = subplots(1, 2, figsize=(9, HEIGHT_INCHES))
    drawing.set_layout_engine("constrained", rect=(0, 0, 1, 1 - LEGEND_INCHES / HEIGHT_INCHES))
    for axes, (curve, (title, column)) in zip(panels, CURVES.items()):
        draw_curve(axes, [row for row in rows if row["curve"] == curve], column)
        axes.set_title(title, loc="left")
        axes.set_xlabel(column)
    panels[0].set_ylabel("median time per set in ms")
    drawing.legend(*panels[0].get_legend_handles_labels(), loc="upper center", ncols=5, fontsize=7)
    return drawing


def main():
    figure.save(draw(figure.rows(sys.argv[1])), Path(sys.argv[2]) / "scan_curves")


if __name__ == "__main__":
    main()
