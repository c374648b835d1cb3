#!/usr/bin/env python3
"""How the results of programs of others change with settings of the data: bench/results/program_curves.csv as one picture.

`program_curves.py FILE.csv FILE.svg`"""
import csv
import sys

from matplotlib.pyplot import subplots

PANELS = [  # script, setting, quantity, label of the quantity, label of the setting
    ("kiss_icp", "range_noise_m", "place, RMS", "error of the place, RMS", "range_noise, m"),
    ("kiss_icp", "firing", "place, RMS", "error of the place, RMS", "firing"),
    ("opencv_stereo", "full_well_e", "beyond 3 px", "wrong by more than 3 px", "full_well_e, electrons"),
    ("opencv_stereo", "msaa", "beyond 3 px", "wrong by more than 3 px", "msaa"),
    ("opencv_calibration", "full_well_e", "focal length", "error of the focal length", "full_well_e, electrons"),
    ("opencv_calibration", "supersampling", "focal length", "error of the focal length", "supersampling"),
    ("colmap_sfm", "supersampling", "place, RMS", "error of the place, RMS", "supersampling"),
]
COLUMNS = 4
NO_NOISE = {"range_noise_m": "0", "full_well_e": "0"}  # the value of a setting that switches noise off


def names_of(setting, values):
    """The values with the name of the one without noise."""
    return ["none" if value == NO_NOISE.get(setting) else value for value in values]


def main(file, picture):
    with open(file, newline="") as text:
        rows = list(csv.DictReader(text))
    panels = [panel for panel in PANELS if any((row["script"], row["setting"]) == panel[:2] for row in rows)]
    columns = min(len(panels), COLUMNS)
    figure, axes = subplots(-(-len(panels) // columns), columns, figsize=(3 * columns, 2.8 * -(-len(panels) // columns)),
                            squeeze=False)
    for axis in axes.flat[len(panels):]:
        axis.remove()
    for axis, (script, setting, quantity, label, setting_label) in zip(axes.flat, panels):
        own = [row for row in rows if (row["script"], row["setting"], row["quantity"]) == (script, setting, quantity)]
        values = [float(row["value"]) for row in own]
        axis.plot(names_of(setting, [row["at"] for row in own]), values, "o-", color="#1060c0")
        axis.set(title=script, xlabel=setting_label, ylabel=f"{label}, {own[0]['unit']}")
        axis.set_ylim(-0.08 * max(values), 1.12 * max(values))
        axis.margins(x=0.1)
        axis.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(picture, metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:])
