#!/usr/bin/env python3
"""How the results of programs of others change with settings of the data: bench/results/program_curves.csv as one picture.

`program_curves.py FILE.csv FILE.svg`"""
import csv
import sys

from matplotlib.pyplot import subplots

PANELS = [  # script, setting, quantity, label of the setting
    ("kiss_icp", "range_noise_m", "place, RMS", "noise of ranges, m"),
    ("kiss_icp", "firing", "place, RMS", "beams leave together, or in a turn"),
    ("opencv_stereo", "full_well_e", "beyond 3 px", "electrons of a full pixel; 0: no noise"),
    ("opencv_stereo", "msaa", "beyond 3 px", "samples of coverage"),
    ("opencv_calibration", "full_well_e", "focal length", "electrons of a full pixel; 0: no noise"),
    ("opencv_calibration", "supersampling", "focal length", "samples of a pixel"),
    ("colmap_sfm", "supersampling", "place, RMS", "samples of a pixel"),
]
COLUMNS = 4


def main(file, picture):
    with open(file, newline="") as text:
        rows = list(csv.DictReader(text))
    panels = [panel for panel in PANELS if any((row["script"], row["setting"]) == panel[:2] for row in rows)]
    figure, axes = subplots(-(-len(panels) // COLUMNS), COLUMNS, figsize=(12, 2.8 * -(-len(panels) // COLUMNS)), squeeze=False)
    for axis in axes.flat[len(panels):]:
        axis.set_axis_off()
    for axis, (script, setting, quantity, label) in zip(axes.flat, panels):
        own = [row for row in rows if (row["script"], row["setting"], row["quantity"]) == (script, setting, quantity)]
        axis.plot([row["at"] for row in own], [float(row["value"]) for row in own], "o-", color="#1060c0")
        axis.set(title=script, xlabel=label, ylabel=f"{quantity}, {own[0]['unit']}")
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(picture, metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:])
