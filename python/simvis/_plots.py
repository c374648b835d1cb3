"""What notebooks show of scans and images."""

from __future__ import annotations

from importlib import import_module
from io import BytesIO
from typing import Any

from ._core import Image, Scan


def _new_figure(width: float, height: float) -> Any:
    """None without matplotlib."""
    try:
        return import_module("matplotlib.figure").Figure(figsize=(width, height))
    except ImportError:
        return None


def _png_file(figure: Any) -> bytes:
    file = BytesIO()
    figure.savefig(file, format="png", dpi=80)
    return file.getvalue()


def scan_png(scan: Scan) -> bytes | None:
    """A scan from above, x upwards and y to the left, as a PNG file; None without matplotlib."""
    figure = _new_figure(5, 5)
    if figure is None:
        return None
    axes = figure.subplots()
    points = scan.points()
    axes.plot(-points[:, 1], points[:, 0], ".", markersize=2)
    axes.plot(0, 0, "k^")
    axes.set_aspect("equal")
    axes.set_xlabel("-y, m")
    axes.set_ylabel("x, m")
    axes.set_title(f"{scan.sensor} at {scan.time_s:g} s")
    return _png_file(figure)


def scan_text(scan: Scan) -> str:
    import numpy as np

    ranges = scan.range_m
    hits = ranges[np.isfinite(ranges) & (ranges > 0)]
    seen = f"{hits.min():.3g} to {hits.max():.3g} m" if hits.size else "nothing"
    return f'scan of "{scan.sensor}": {scan.rings} x {scan.beams} beams at {scan.time_s:g} s, {hits.size} hits, {seen}'


def image_png(image: Image) -> bytes | None:
    """A picture as it is, other numbers by colours with a scale, as a PNG file; None for those without matplotlib."""
    if image.array.ndim == 3:
        return image.png()
    figure = _new_figure(6, 4)
    if figure is None:
        return None
    axes = figure.subplots()
    drawn = axes.imshow(image.array)
    axes.set_title(f"{image.name} of {image.sensor}")
    figure.colorbar(drawn, label="px" if image.name == "disparity" else "m")
    return _png_file(figure)


def image_text(image: Image) -> str:
    return f'image "{image.name}" of "{image.sensor}": {image.width} x {image.height} pixels'
