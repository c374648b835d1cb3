#!/usr/bin/env python3
"""What bench/light_costs.py prints: the error of drawn light and of paths of light over their time.

`light_costs.py FILE.csv FOLDER` writes FOLDER/light_costs.png."""
import sys
from pathlib import Path

from matplotlib.pyplot import subplots

import figure

DRAWN, PATHS = "#0072b2", "#d55e00"


def series(axes, rows, color, label, below):
    times = [float(row["processor_ms"]) for row in rows]
    errors = [float(row["rms_error"]) for row in rows]
    spread = [float(row["rms_uncertainty"]) for row in rows]
    axes.errorbar(times, errors, yerr=spread, color=color, marker="o", markersize=4, capsize=2, label=label)
    for number, (row, time, error) in enumerate(zip(rows, times, errors)):
        text = row["light"].removeprefix("paths ").removeprefix("with ")
        axes.annotate(text, (time, error), xytext=(4, -11 - 9 * (number % 2) if below else 5),
                      textcoords="offset points", color=color, fontsize=7)


def draw(rows):
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    drawing, panels = subplots(1, len(scenes), figsize=(1 + 4.5 * len(scenes), 4.2), layout="constrained", squeeze=False)
    for axes, scene in zip(panels[0], scenes):
        of_scene = [row for row in rows if row["scene"] == scene]
        is_path = lambda row: row["light"].startswith("paths")
        series(axes, [row for row in of_scene if not is_path(row)], DRAWN, "drawn", True)
        series(axes, [row for row in of_scene if is_path(row)], PATHS, "paths of light", False)
        camera, mean = of_scene[0]["camera"], float(of_scene[0]["mean_radiance"])
        axes.axhline(mean, color="#888888", linewidth=0.8, linestyle=":", label="mean radiance")
        axes.set_title(f"{scene}: {camera}", loc="left")
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.margins(x=0.15)
        axes.set_xlabel("processor time of a frame, ms")
        axes.set_ylabel("RMS error of linear radiance")
    panels[0][0].legend(loc="lower left")
    return drawing


def main():
    figure.save(draw(figure.rows(sys.argv[1])), Path(sys.argv[2]) / "light_costs")


if __name__ == "__main__":
    main()
