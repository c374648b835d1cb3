#!/usr/bin/env python3
"""What bench/knobs prints, as curves of error against processor time with the defaults marked, and a table.

`knobs.py FILE.csv FOLDER` writes FOLDER/knobs.{svg,png} and FOLDER/knobs.md."""
import sys
from pathlib import Path

from matplotlib.pyplot import subplots
from matplotlib.ticker import FuncFormatter, LogLocator

import figure
import knobs_table
from defaults import at_default, default_of

PANELS = (("lens and shutter", ("lens_samples", "motion_samples", "rows_per_pose", "lens_oversampling")),
          ("lamps and skies", ("lamp_points", "sky_points", "sky_points of a picture")),
          ("event camera", ("event step", "event time_error")))


# Where the values of a curve stand beside its points, in points, so that curves that are near do not share a place.
PLACES = ((5, 3), (-5, -9), (5, -9), (-5, 4), (5, 3))


def default_row(knob, rows):
    attribute, of = (knob.removeprefix("event "), "event_camera") if knob.startswith("event ") else (knob.split(" ")[0], "")
    return at_default([row for row in rows if row["value"] != "off"], default_of(attribute, of))


def draw_panel(axes, title, knobs, groups):
    for marker, place, knob in zip("osv^D", PLACES, knobs):
        points = [(float(row["processor_ms"]), float(row["error"]), row["value"]) for row in groups[knob]
                  if row["error"] and float(row["error"]) > 0]
        (line,) = axes.plot([ms for ms, _, _ in points], [error for _, error, _ in points], marker=marker, markersize=5,
                            label=knob)
        for ms, error, value in points:
            axes.annotate(value, (ms, error), xytext=place, textcoords="offset points", fontsize=6.5,
                          color=line.get_color(), ha="left" if place[0] > 0 else "right")
        usual = default_row(knob, groups[knob])
        if usual["error"]:
            axes.plot(float(usual["processor_ms"]), float(usual["error"]), marker="o", markersize=11, fillstyle="none",
                      color=line.get_color(), linestyle="none")
    axes.set_xscale("log")
    errors = [value for line in axes.lines for value in line.get_ydata()]
    is_wide = max(errors) > 10 * min(errors)
    axes.set_yscale("log" if is_wide else "linear")
    for axis in (axes.xaxis, axes.yaxis) if is_wide else (axes.xaxis,):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.minorticks_off()
    axes.margins(0.15)
    low, high = axes.get_ylim()
    axes.set_ylim(top=high * (high / low) ** 0.25 if is_wide else high + 0.25 * (high - low))  # room for the legend
    axes.set_title(f"{title}; ring: default", loc="left")
    axes.set_xlabel("processor time of a frame in ms")
    axes.legend(fontsize=6.5, loc="upper right", ncols=2)


def draw(rows):
    groups = knobs_table.by_knob(rows)
    drawing, panels = subplots(1, len(PANELS), figsize=(11.5, 3.9), layout="constrained")
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
