#!/usr/bin/env python3
"""What bench/scale prints, as curves: cost against size.

`scale.py FILE.csv FOLDER` writes FOLDER/scale.{svg,png}."""
import sys
from pathlib import Path

from matplotlib.pyplot import subplots

import figure

COLORS = {"planar": "#0072b2", "raycast": "#d55e00", "camera": "#009e73"}


def of(rows, curve, method, cache=""):
    return [row for row in rows if (row["curve"], row["method"], row["cache"]) == (curve, method, cache)]


def plot(axes, rows, column, label, **style):
    points = [(float(row["size"]), float(row[column])) for row in rows if row[column]]
    if points:
        axes.plot(*zip(*points), label=label, marker="o", markersize=3.5, **style)


def draw_times(axes, rows, curve, title, label):
    for method, color in COLORS.items():
        plot(axes, of(rows, curve, method), "median_ms", f"{method}, a frame", color=color)
        plot(axes, of(rows, curve, method), "caller_cpu_ms", f"{method}, processor time of the caller", color=color,
             linestyle=":")
    axes.set(xscale="log", yscale="log", xlabel=label, ylabel="ms")
    if axes.lines:
        axes.set_ylim(axes.dataLim.y0 / 2, 50 * axes.dataLim.y1)  # room for the legend
    axes.set_title(title, loc="left")


def draw_opening(axes, rows):
    for method, color in COLORS.items():
        for cache, line in (("cold", "-"), ("warm", "--")):
            plot(axes, of(rows, "triangles", method, cache), "open_s", f"{method}, {cache} cache", color=color,
                 linestyle=line)
    axes.set(xscale="log", yscale="log", xlabel="triangles", ylabel="s")
    axes.set_title("from the file to the first scans", loc="left")


def draw_memory(axes, rows):
    for method, color in COLORS.items():
        plot(axes, of(rows, "triangles", method, "cold"), "rss_mb", f"{method}, resident", color=color)
    plot(axes, of(rows, "triangles", "planar", "cold"), "device_mb", "planar, on the device", color="#0072b2",
         linestyle=":")
    plot(axes, of(rows, "triangles", "planar", "cold"), "data_mb", "meshes and textures", color="#000000")
    axes.set(xscale="log", yscale="log", xlabel="triangles", ylabel="MB")
    axes.set_title("memory", loc="left")


def draw_frames(axes, rows, column, title, label):
    for method, color in COLORS.items():
        plot(axes, of(rows, "frames", method), column, method, color=color)
    axes.set(xscale="log", xlabel="frames", ylabel=label)
    if axes.lines:
        axes.set_ylim(0, 1.25 * axes.dataLim.y1)  # room for the legend
    axes.set_title(title, loc="left")


def draw(rows):
    drawing, panels = subplots(3, 2, figsize=(9, 9), layout="constrained")
    draw_times(panels[0][0], rows, "sensors", "scanners, 100,000 triangles", "scanners")
    draw_times(panels[0][1], rows, "instances", "instances, of which 100 are in sight", "instances")
    draw_opening(panels[1][0], rows)
    draw_memory(panels[1][1], rows)
    draw_frames(panels[2][0], rows, "median_ms", "time per frame as they add up", "ms")
    draw_frames(panels[2][1], rows, "rss_mb", "memory as frames add up", "resident MB")
    for axes in panels.flat:
        axes.minorticks_off()
        if axes.lines:
            axes.legend(fontsize=6.5)
    return drawing


def main():
    figure.save(draw(figure.rows(sys.argv[1])), Path(sys.argv[2]) / "scale")


if __name__ == "__main__":
    main()
