#!/usr/bin/env python3
"""What bench/camera_frames prints of the outputs of a camera, as a plot: what each costs beside colour, and depth alone.

`camera_frames.py FILE.csv FOLDER` writes FOLDER/camera_frames.png."""
import sys
from pathlib import Path

from matplotlib.pyplot import subplots

import figure

COLOR, WITH = "marvin robot", "marvin robot and "


def draw(rows):
    cases = {row["case"]: row for row in rows}
    names = {COLOR: "color", f"{COLOR} depth": "depth alone"}
    names |= {case: "color " + case.removeprefix(WITH) for case in cases if case.startswith(WITH)}
    drawing, axes = subplots(figsize=(9, 0.8 + 0.32 * len(names)), layout="constrained")
    base = float(cases[COLOR]["least_processor_ms"])
    for place, (case, name) in zip(range(len(names), 0, -1), names.items()):
        total = float(cases[case]["least_processor_ms"])
        axes.barh(place, min(total, base) if name != "depth alone" else total, color="#0072b2", height=0.6)
        if total > base:
            axes.barh(place, total - base, left=base, color="#d55e00", height=0.6)
        text = f"{total:.1f}" + (f" = {total / base:.2f} times color" if case != COLOR else "")
        axes.annotate(text, (total, place), xytext=(3, 0), textcoords="offset points", va="center", fontsize=7)
    axes.set_yticks(range(len(names), 0, -1), names.values())
    axes.margins(x=0.2)
    axes.set_xlabel("processor time of a frame of 640 x 480 in ms, least of 60; orange: what the outputs add to colour")
    axes.set_title("marvin, the robot's camera: cost of its outputs", loc="left")
    return drawing


def main():
    figure.save(draw(figure.rows(sys.argv[1])), Path(sys.argv[2]) / "camera_frames")


if __name__ == "__main__":
    main()
