#!/usr/bin/env python3
"""What bench/camera_quality prints, as a plot of error against time.

`camera_quality.py FILE.csv FOLDER` writes FOLDER/camera_quality.{svg,png}."""
import sys
from pathlib import Path

from matplotlib.lines import Line2D
from matplotlib.pyplot import subplots
from matplotlib.ticker import FuncFormatter, LogLocator

import figure

# samples per pixel of MSAA: colour, marker.
MSAA = {1: ("#999999", "s"), 2: ("#56b4e9", "^"), 4: ("#0072b2", "o"), 8: ("#009e73", "v"), 16: ("#d55e00", "D")}
FRONT = "#f5ea7a"


def draw_panel(axes, rows):
    axes.set_xscale("log")
    axes.set_yscale("log")
    points = [(float(row["median_ms"]), float(row["rms_grey_levels"])) for row in rows]
    axes.plot(*zip(*figure.pareto_front(points)), color=FRONT, linewidth=6, marker="o", markersize=13, zorder=1)
    for msaa, (color, marker) in MSAA.items():
        series = sorted((int(row["supersampling"]), point) for row, point in zip(rows, points)
                        if int(row["msaa"]) == msaa)
        if not series:
            continue
        axes.plot(*zip(*(point for _, point in series)), color=color, marker=marker, markersize=5, zorder=2)
        for supersampling, point in series:
            axes.annotate(f"{supersampling}x{msaa}", point, xytext=(5, 4), textcoords="offset points", fontsize=6.5,
                          color=color)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.margins(0.12)
    axes.minorticks_off()


def draw(rows):
    cameras = list(dict.fromkeys((row["scene"], row["camera"]) for row in rows))
    columns = min(2, len(cameras))
    lines = -(-len(cameras) // columns)
    height = 0.5 + 3 * lines
    drawing, panels = subplots(lines, columns, figsize=(4.5 * columns, height), squeeze=False)
    drawing.set_layout_engine("constrained", rect=(0, 0, 1, 1 - 0.5 / height))
    for axes, key in zip(panels.flat, cameras):
        draw_panel(axes, [row for row in rows if (row["scene"], row["camera"]) == key])
        axes.set_title(": ".join(key), loc="left")
        axes.set_xlabel("time per picture in ms (median)")
        axes.set_ylabel("RMS error in grey levels of 255")
    for axes in panels.flat[len(cameras):]:
        axes.remove()
    used = {int(row["msaa"]) for row in rows}
    handles = [Line2D([], [], color=color, marker=marker, markersize=5, label=f"MSAA {msaa}" if msaa > 1 else "no MSAA")
               for msaa, (color, marker) in MSAA.items() if msaa in used]
    handles.append(Line2D([], [], color=FRONT, linewidth=6, label="Pareto front"))
    drawing.legend(handles=handles, loc="upper center", ncols=len(handles))
    return drawing


def main():
    figure.save(draw(figure.rows(sys.argv[1])), Path(sys.argv[2]) / "camera_quality")


if __name__ == "__main__":
    main()
