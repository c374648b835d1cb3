#!/usr/bin/env python3
"""What bench/effects prints, as plots and a table: the cost of each effect, and its error against that cost.

`effects.py FILE.csv FOLDER` writes FOLDER/effects.{svg,png} and FOLDER/effects.md."""
import sys
from pathlib import Path

from matplotlib.pyplot import subplots
from matplotlib.ticker import FuncFormatter, LogLocator

import effects_table
import figure
from defaults import at_default, default_of

COLORS = {"camera": "#0072b2", "laser_scanner": "#d55e00"}
ERRORS = {"camera": "RMS error of linear radiance", "laser_scanner": "RMS error of ranges in m"}


def as_ratios(axis):
    axis.set_major_locator(LogLocator(subs=(1, 3)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(LogLocator(subs=()))


def default_row(rows):
    """That of the default, or of the next finer value that was measured; without a setting the only one."""
    return at_default(rows, default_of(rows[0]["knob"])) if rows[0]["knob"] else rows[-1]


def draw_prices(axes, sensor, groups):
    """A dark bar from 1, which is without the effect, to the cost of the default, and a pale one on to that of the finest
    value."""
    names = [effect for _, effect in groups]
    places = range(len(names), 0, -1)
    for place, rows in zip(places, groups.values()):
        usual, finest = default_row(rows), rows[-1]
        cost, most = float(usual["ratio"]), float(finest["ratio"])
        text = f"{cost:.2f}" + (f" at {usual['value']}" if usual["value"] else "")
        if usual is not finest:
            axes.barh(place, most - 1, left=1, color=COLORS[sensor], alpha=0.25, height=0.6)
            text += f", {most:.3g} at {finest['value']}"
        axes.barh(place, cost - 1, left=1, color=COLORS[sensor], height=0.6)
        axes.annotate(text, (max(most, cost), place), xytext=(3, 0), textcoords="offset points", va="center", fontsize=7)
    axes.set_yticks(places, ["all together" if name == "all" else name for name in names])
    axes.axvline(1, color="#888888", linewidth=0.8)
    axes.set_xscale("log")
    axes.set_xlim(1, 7 * axes.get_xlim()[1])  # room for the texts
    as_ratios(axes.xaxis)
    axes.set_title(f"{effects_table.SENSORS[sensor][0]}: cost; dark: default, pale: finest", loc="left")
    axes.set_xlabel("frame time as a ratio to the scene without the effect")


def draw_knobs(axes, sensor, groups):
    for marker, ((_, effect), rows) in zip("osv^D<>P*X", ((k, r) for k, r in groups.items() if r[0]["knob"])):
        points = [(float(row["ratio"]), float(row["error"])) for row in rows if float(row["error"]) > 0]
        if points:
            (line,) = axes.plot(*zip(*points), marker=marker, markersize=5, label=f"{effect}, {rows[0]['knob']}")
            usual = default_row(rows)
            if float(usual["error"]) > 0:
                axes.plot(float(usual["ratio"]), float(usual["error"]), marker="o", markersize=12, fillstyle="none",
                          color=line.get_color(), linestyle="none")
    axes.set_xscale("log")
    axes.set_yscale("log")
    as_ratios(axes.xaxis)
    axes.set_title(f"{effects_table.SENSORS[sensor][0]}: what settings buy; ring: default", loc="left")
    axes.set_xlabel("frame time as a ratio to the scene without the effect")
    axes.set_ylabel(ERRORS[sensor])
    axes.set_ylim(top=12 * axes.get_ylim()[1])  # room for the legend
    if axes.lines:
        axes.legend(fontsize=6.5, loc="upper right", ncols=2)


def draw(rows):
    groups = effects_table.by_effect(rows)
    sensors = list(dict.fromkeys(sensor for sensor, _ in groups))
    drawing, panels = subplots(len(sensors), 2, figsize=(11, 3.9 * len(sensors)), squeeze=False, layout="constrained")
    for line, sensor in zip(panels, sensors):
        of_sensor = {key: group for key, group in groups.items() if key[0] == sensor}
        draw_prices(line[0], sensor, of_sensor)
        draw_knobs(line[1], sensor, of_sensor)
    return drawing


def main():
    rows, folder = figure.rows(sys.argv[1]), sys.argv[2]
    figure.save(draw(rows), Path(folder) / "effects")
    effects_table.TABLE.write(rows, folder)


if __name__ == "__main__":
    main()
