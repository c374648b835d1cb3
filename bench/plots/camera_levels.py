#!/usr/bin/env python3
"""What bench/camera_levels prints: time and triangles, and what changes in the picture, over max_error_px.

`camera_levels.py FILE.csv FOLDER` writes FOLDER/camera_levels.{svg,png}."""
import sys
from pathlib import Path

from matplotlib.pyplot import subplots

import figure

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9")

# What each panel shows: title, label, the value of a row beside the row of the exact picture.
PANELS = (
    ("cost", "time, share of the exact picture's", lambda row, exact: row["median_ms"] / exact["median_ms"]),
    ("work", "triangles drawn, share of the exact picture's", lambda row, exact: row["triangles"] / exact["triangles"]),
    ("silhouettes", "displacement in px: 99th percentile", lambda row, exact: row["silhouette_p99_px"]),
    ("colour", "RMS difference of linear colour", lambda row, exact: row["rms_color"]),
)


def numbers(row):
    return {name: float(text) for name, text in row.items() if name not in ("scene", "camera", "cheapest_for")}


def draw(rows):
    drawing, panels = subplots(2, 2, figsize=(9, 6.2), layout="constrained")
    scenes = list(dict.fromkeys((row["scene"], row["camera"]) for row in rows))
    for axes, (title, label, value) in zip(panels.flat, PANELS):
        for (scene, camera), color in zip(scenes, COLORS):
            series = [numbers(row) for row in rows if (row["scene"], row["camera"]) == (scene, camera)]
            points = [(row["max_error_px"], value(row, series[0])) for row in series]
            axes.plot(*zip(*points), color=color, marker="o", markersize=4, label=f"{scene}: {camera}")
        axes.set_title(title, loc="left")
        axes.set_xscale("symlog", linthresh=0.25)
        ticks = sorted({float(row["max_error_px"]) for row in rows})
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.minorticks_off()
        axes.set_xlabel("max_error_px (0: exact)")
        axes.set_ylabel(label)
        axes.set_ylim(bottom=0)
    panels[0][0].legend(loc="lower left")
    return drawing


def main():
    figure.save(draw(figure.rows(sys.argv[1])), Path(sys.argv[2]) / "camera_levels")


if __name__ == "__main__":
    main()
