"""What notebooks show of a scan."""

from __future__ import annotations

from importlib import import_module
from io import BytesIO

from ._core import Scan


def scan_png(scan: Scan) -> bytes | None:
    """A scan from above, x upwards and y to the left, as a PNG file; None without matplotlib."""
    try:
        figure = import_module("matplotlib.figure").Figure(figsize=(5, 5))
    except ImportError:
        return None
    axes = figure.subplots()
    points = scan.points()
    axes.plot(-points[:, 1], points[:, 0], ".", markersize=2)
    axes.plot(0, 0, "k^")
    axes.set_aspect("equal")
    axes.set_xlabel("-y, m")
    axes.set_ylabel("x, m")
    axes.set_title(f"{scan.sensor} at {scan.time_s:g} s")
    file = BytesIO()
    figure.savefig(file, format="png", dpi=80)
    return file.getvalue()


def scan_text(scan: Scan) -> str:
    import numpy as np

    ranges = scan.range_m
    hits = ranges[np.isfinite(ranges) & (ranges > 0)]
    seen = f"{hits.min():.3g} to {hits.max():.3g} m" if hits.size else "nothing"
    return f'scan of "{scan.sensor}": {scan.rings} x {scan.beams} beams at {scan.time_s:g} s, {hits.size} hits, {seen}'
