"""The price list of laser scanners."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

from ._proxies import html_table, text_table


class PriceList(Sequence[dict[str, Any]]):
    """One row for each variant of each scanner, as a dict with units in the names of its columns."""

    def __init__(self, rows: list[dict[str, Any]]) -> None:
        self._rows = rows

    def __getitem__(self, index: Any) -> Any:
        return self._rows[index]

    def __len__(self) -> int:
        return len(self._rows)

    def _cells(self) -> list[tuple[str, ...]]:
        cells: list[tuple[str, ...]] = [("scanner", "attributes", "median ms", "ratio", "largest bound m", "without bound", "")]
        for row in self._rows:
            bound = row["bound_largest_m"]
            cells.append((row["sensor"], row["attributes"], f'{row["median_ms"]:.3g}', f'{row["ratio"]:.2g}',
                          "" if bound is None else f"{bound:.2g}", f'{100 * row["unbounded_share"]:.2g} %',
                          "in the scene" if row["in_scene"] else ""))
        return cells

    def __repr__(self) -> str:
        return text_table("price list", self._cells())

    def _repr_html_(self) -> str:
        return html_table("price list", self._cells())

    def plot(self, axes: Any = None) -> Any:
        """Draws time against the largest bound, with matplotlib. Returns the axes."""
        if axes is None:
            axes = import_module("matplotlib.pyplot").figure().gca()
        for row in self._rows:
            if row["bound_largest_m"]:
                axes.loglog(row["median_ms"], row["bound_largest_m"], "o", label=f'{row["sensor"]}: {row["attributes"]}')
        axes.set_xlabel("median time of a frame, ms")
        axes.set_ylabel("largest error bound, m")
        axes.legend(fontsize="small")
        return axes
