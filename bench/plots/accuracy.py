#!/usr/bin/env python3
"""Plots of bench/accuracy: error against time. `accuracy.py FILE.csv FOLDER` writes FOLDER/accuracy_SCANNER.{svg,png}."""
import math
import sys
from pathlib import Path

from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.pyplot import subplots

import figure

# (method, max_error_rel): label, colour, marker.
SERIES = {
    ("nearest", ""): ("nearest", "#999999", "s"),
    ("planar", ""): ("planar", "#0072b2", "o"),
    ("hybrid", "1e-3"): ("hybrid 1e-3", "#56b4e9", "^"),
    ("hybrid", "1e-4"): ("hybrid 1e-4", "#009e73", "v"),
    ("hybrid", "1e-5"): ("hybrid 1e-5", "#e69f00", "D"),
    ("hybrid", "1e-6"): ("hybrid 1e-6", "#cc79a7", "P"),
    ("raycast", ""): ("raycast", "#d55e00", "*"),
    ("embree_1", ""): ("bare Embree, single rays", "#000000", "x"),
    ("embree_16", ""): ("bare Embree, packets of 16", "#000000", "+"),
}
STATISTICS = {"error_rel_median": "median error", "error_rel_p999": "p99.9 error"}

EXACT = 2.0**-24  # half an ulp of float32, relative: no range that is stored as a float can be promised better
LEGEND_INCHES = 0.75
LOW, HIGH, WRONG = 1e-8, 1e1, 1e2  # the axis, and where errors are drawn that are no number


def drawn(error):
    """Where an error stands on the axis: none at its foot, a wrong hit or miss above its head."""
    if math.isinf(error):
        return WRONG
    return min(max(error, LOW), HIGH)


def is_peer(row):
    return row["method"].startswith("embree")


def draw_panel(axes, rows, statistic):
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(LOW / 2, WRONG * 4)
    axes.axhspan(LOW / 2, EXACT, color="#dcefdc", linewidth=0, zorder=0)
    axes.axhspan(HIGH * 3, WRONG * 4, color="#f6dddd", linewidth=0, zorder=0)
    ours = [(float(row["median_ms"]), drawn(float(row[statistic]))) for row in rows if not is_peer(row)]
    front = figure.pareto_front(ours)
    axes.step(*zip(*front), where="post", color="#f0e442", linewidth=5, zorder=1, solid_capstyle="round")
    for key, (_, color, marker) in SERIES.items():
        series = [row for row in rows if (row["method"], row["max_error_rel"]) == key]
        times = [float(row["median_ms"]) for row in series]
        errors = [drawn(float(row[statistic])) for row in series]
        axes.plot(times, errors, color=color, linewidth=1, zorder=2)
        sizes = [12 + 7 * i for i in range(len(series))]  # the finer, the larger
        if len(series) == 1:
            sizes = [70 if marker == "*" else 30]
        axes.scatter(times, errors, s=sizes, color=color, marker=marker, linewidths=1, zorder=3)
        for row, time, error in zip(series, times, errors):
            if key == ("planar", "") and row["resolution_px"]:
                axes.annotate(row["resolution_px"], (time, error), xytext=(4, 3), textcoords="offset points",
                              fontsize=6, color=color)
    axes.set_yticks([1e-8, 1e-6, 1e-4, 1e-2, 1, WRONG], ["1e-8", "1e-6", "1e-4", "1e-2", "1", "wrong\nhit"])
    axes.minorticks_off()


def draw(rows, scanner, folder):
    rows = [row for row in rows if row["scanner"] == scanner]
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    height = LEGEND_INCHES + 2.3 * len(scenes)
    drawing, panels = subplots(len(scenes), 2, figsize=(9, height), sharex="row", sharey=True, squeeze=False)
    drawing.set_layout_engine("constrained", rect=(0, 0, 1, 1 - LEGEND_INCHES / height))
    for line, scene in zip(panels, scenes):
        of_scene = [row for row in rows if row["scene"] == scene]
        for axes, (statistic, name) in zip(line, STATISTICS.items()):
            draw_panel(axes, of_scene, statistic)
            axes.set_title(f"{scene}: {name}", loc="left")
        line[0].set_ylabel("relative error")
    for axes in panels[-1]:
        axes.set_xlabel("time per scan in ms (median)")
    handles = [Line2D([], [], color=color, marker=marker, markersize=5, label=label, linewidth=1)
               for label, color, marker in SERIES.values()]
    handles += [Line2D([], [], color="#f0e442", linewidth=5, label="Pareto front of SimVis"),
                Patch(color="#dcefdc", label="exact to float32"),
                Patch(color="#f6dddd", label="hit for miss, or miss for hit")]
    drawing.legend(handles=handles, loc="upper center", ncols=4)
    figure.save(drawing, Path(folder) / f"accuracy_{scanner}")


def main():
    rows = figure.rows(sys.argv[1])
    for scanner in dict.fromkeys(row["scanner"] for row in rows):
        draw(rows, scanner, sys.argv[2])


if __name__ == "__main__":
    main()
