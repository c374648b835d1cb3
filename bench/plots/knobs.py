#!/usr/bin/env python3
"""What bench/knobs prints, as curves of error against processor time, and a table.

`knobs.py FILE.csv FOLDER` writes FOLDER/knobs.{svg,png} and FOLDER/knobs.md."""
import sys
from pathlib import Path

from matplotlib.pyplot import subplots
from matplotlib.ticker import FuncFormatter, LogLocator

import figure
import knobs_table

PANELS = (("lens and shutter", ("lens_samples", "motion_samples", "rows_per_pose", "lens_oversampling")),
          ("lamps and skies", ("lamp_points", "sky_points", "sky_points of a picture")),
          ("event camera", ("event step", "event time_error")))


def draw_panel(axes, title, knobs, groups):
    for marker, knob in zip("osv^D", knobs):
        points = [(float(row["processor_ms"]), float(row["error"]), row["value"]) for row in groups[knob]
                  if row["error"] and float(row["error"]) > 0]
        axes.plot([ms for ms, _, _ in points], [error for _, error, _ in points], marker=marker, markersize=5, label=knob)
        for ms, error, value in points:
            axes.annotate(value, (ms, error), xytext=(4, 3), textcoords="offset points", fontsize=6.5)
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.minorticks_off()
    axes.margins(0.15)
    axes.set_title(title, loc="left")
    axes.set_xlabel("processor time of a frame in ms")
    axes.legend(fontsize=6.5)


def draw(rows):
    groups = knobs_table.by_knob(rows)
    drawing, panels = subplots(1, len(PANELS), figsize=(10.5, 3.4), layout="constrained")
    for axes, (title, knobs) in zip(panels, PANELS):
        draw_panel(axes, title, knobs, groups)
    panels[0].set_ylabel("RMS error of linear radiance")
    panels[2].set_ylabel("error of times in us, 99th percentile")
    return drawing


def main():
    rows, folder = figure.rows(sys.argv[1]), sys.argv[2]
    figure.save(draw(rows), Path(folder) / "knobs")
    knobs_table.TABLE.write(rows, folder)


if __name__ == "__main__":
    main()
