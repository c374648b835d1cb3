#!/usr/bin/env python3
"""What bench/accuracy prints, as plots of error against time and of bounds against errors, and as a table.

`accuracy.py FILE.csv FOLDER` writes FOLDER/accuracy_SCANNER.png, FOLDER/accuracy_bounds.png and FOLDER/accuracy.md."""
import math
import sys
from pathlib import Path

from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.pyplot import subplots
from matplotlib.ticker import FuncFormatter, LogLocator

import accuracy_bounds
import accuracy_table
import figure
from accuracy_table import is_peer

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
FRONT, EXACT_BAND, WRONG_BAND = "#f5ea7a", "#dcefdc", "#f6dddd"
STATISTICS = {"error_rel_median": "median error", "error_rel_p999": "p99.9 error"}

EXACT = 2.0**-24  # half an ulp of float32, relative: no range that is stored as a float can be promised better
LEGEND_INCHES = 0.75
LOW, HIGH, WRONG = 1e-8, 1e1, 1e2  # the axis, and where errors are drawn that are no number


def drawn(error):
    """Where an error stands on the axis: none at its foot, a wrong hit or miss above its head."""
    if math.isinf(error):
        return WRONG
    return min(max(error, LOW), HIGH)


def draw_front(axes, rows, statistic):
    """The methods of SimVis that no other one beats in both time and error: a band along them, a ring around each."""
    front = figure.pareto_front((float(row["median_ms"]), drawn(float(row[statistic]))) for row in rows
                                if not is_peer(row))
    times, errors = zip(*front)
    axes.step(times, errors, where="post", color=FRONT, linewidth=5, zorder=1, solid_capstyle="round")
    axes.scatter(times, errors, s=160, color=FRONT, linewidths=0, zorder=1)


def draw_series(axes, rows, statistic, key):
    _, color, marker = SERIES[key]
    times = [float(row["median_ms"]) for row in rows]
    errors = [drawn(float(row[statistic])) for row in rows]
    sizes = [10 + 6 * i for i in range(len(rows))] if len(rows) > 1 else [70 if marker == "*" else 30]
    axes.plot(times, errors, color=color, linewidth=1, zorder=2)
    axes.scatter(times, errors, s=sizes, color=color, marker=marker, linewidths=1, zorder=3)
    if key == ("planar", ""):  # the size of the markers distinguishes the others
        ends = sorted(((times[i], errors[i], rows[i]["resolution_px"]) for i in (0, -1)))
        for (time, error, width_px), side, offset in zip(ends, ("right", "left"), (-6, 6)):
            axes.annotate(f"{width_px} px", (time, error), xytext=(offset, 2), textcoords="offset points", fontsize=6.5,
                          color=color, horizontalalignment=side)


def note_masks(axes, rows, statistic):
    """Where bare Embree meets leaves as whole squares, its errors are no fault of its arithmetic."""
    peer = next(row for row in rows if is_peer(row))
    if peer["masks"] == "ignored":
        axes.annotate("masks ignored", (float(peer["median_ms"]), drawn(float(peer[statistic]))), xytext=(0, -12),
                      textcoords="offset points", fontsize=6.5)


def draw_panel(axes, rows, statistic):
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(LOW / 2, WRONG * 4)
    axes.axhspan(LOW / 2, EXACT, color=EXACT_BAND, linewidth=0, zorder=0)
    axes.axhspan(HIGH * 3, WRONG * 4, color=WRONG_BAND, linewidth=0, zorder=0)
    draw_front(axes, rows, statistic)
    for key in SERIES:
        series = [row for row in rows if (row["method"], row["max_error_rel"]) == key]
        if series:
            draw_series(axes, series, statistic, key)
    note_masks(axes, rows, statistic)
    axes.set_yticks([1e-8, 1e-6, 1e-4, 1e-2, 1, WRONG], ["1e-8", "1e-6", "1e-4", "1e-2", "1", "wrong\nhit"])
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda time_ms, _: f"{time_ms:g}"))
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
        axes.set_xlabel("time per scan in ms (median); markers grow with resolution")
    handles = [Line2D([], [], color=color, marker=marker, markersize=5, label=label, linewidth=1)
               for key, (label, color, marker) in SERIES.items()
               if any((row["method"], row["max_error_rel"]) == key for row in rows)]
    handles += [Line2D([], [], color=FRONT, linewidth=5, label="Pareto front of SimVis"),
                Patch(color=EXACT_BAND, label="exact to float32"),
                Patch(color=WRONG_BAND, label="hit for miss, or miss for hit")]
    drawing.legend(handles=handles, loc="upper center", ncols=4)
    figure.save(drawing, Path(folder) / f"accuracy_{scanner}")


def main():
    rows = figure.rows(sys.argv[1])
    for scanner in dict.fromkeys(row["scanner"] for row in rows):
        draw(rows, scanner, sys.argv[2])
    figure.save(accuracy_bounds.draw(rows, SERIES), Path(sys.argv[2]) / "accuracy_bounds")
    accuracy_table.TABLE.write(rows, sys.argv[2])


if __name__ == "__main__":
    main()
