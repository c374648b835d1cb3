#!/usr/bin/env python3
"""What bench/effects prints, as plots and a table: the price of each effect, and its error against that price.

`effects.py FILE.csv FOLDER` writes FOLDER/effects.{svg,png} and FOLDER/effects.md."""
import sys
from pathlib import Path

from matplotlib.pyplot import subplots
from matplotlib.ticker import FuncFormatter, LogLocator

import effects_table
import figure

COLORS = {"camera": "#0072b2", "laser_scanner": "#d55e00"}
ERRORS = {"camera": "RMS error of linear radiance", "laser_scanner": "RMS error of ranges in m"}


def as_ratios(axis):
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(LogLocator(subs=()))


def draw_prices(axes, sensor, groups):
    """A bar from 1, which is without the effect, to the price of the example's or the most exact value."""
    names = [effect for _, effect in groups]
    prices = [float(rows[-1]["ratio"]) for rows in groups.values()]
    places = range(len(names), 0, -1)
    axes.barh(places, [price - 1 for price in prices], left=1, color=COLORS[sensor], height=0.6)
    for place, price in zip(places, prices):
        axes.annotate(f"{price:.2f}", (price, place), xytext=(3, 0), textcoords="offset points", va="center",
                      fontsize=7)
    axes.set_yticks(places, ["all together" if name == "all" else name for name in names])
    axes.axvline(1, color="#888888", linewidth=0.8)
    axes.set_xscale("log")
    axes.margins(x=0.15)
    as_ratios(axes.xaxis)
    axes.set_title(f"{effects_table.SENSORS[sensor][0]}: price", loc="left")
    axes.set_xlabel("frame time as a ratio to the scene without the effect")


def draw_knobs(axes, sensor, groups):
    for marker, ((_, effect), rows) in zip("osv^D<>P*X", ((k, r) for k, r in groups.items() if r[0]["knob"])):
        points = [(float(row["ratio"]), float(row["error"])) for row in rows if float(row["error"]) > 0]
        if points:
            axes.plot(*zip(*points), marker=marker, markersize=5, label=f"{effect}, {rows[0]['knob']}")
    axes.set_xscale("log")
    axes.set_yscale("log")
    as_ratios(axes.xaxis)
    axes.set_title(f"{effects_table.SENSORS[sensor][0]}: what knobs buy", loc="left")
    axes.set_xlabel("frame time as a ratio to the scene without the effect")
    axes.set_ylabel(ERRORS[sensor])
    if axes.lines:
        axes.legend(fontsize=6.5)


def draw(rows):
    groups = effects_table.by_effect(rows)
    sensors = list(dict.fromkeys(sensor for sensor, _ in groups))
    drawing, panels = subplots(len(sensors), 2, figsize=(9, 3.6 * len(sensors)), squeeze=False, layout="constrained")
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
