"""What all plots share: how they look, and files that are the same bytes each time."""
import csv
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({
    "svg.hashsalt": "simvis",  # else element ids are random
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",
    "font.size": 8,
    "axes.titlesize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
})

DOTS_PER_INCH = 100


def rows(path):
    """A CSV file as dictionaries."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def save(figure, stem):
    """Writes STEM.png, with no version in it."""
    figure.savefig(Path(stem).with_suffix(".png"), dpi=DOTS_PER_INCH, metadata={"Software": None})


def pareto_front(points):
    """Of (cost, error): those that no other one beats in both, by cost."""
    front = []
    for cost, error in sorted(points):
        if not front or error < front[-1][1]:
            front.append((cost, error))
    return front
