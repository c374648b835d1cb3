#!/usr/bin/env python3
"""The table of bench/accuracy: what meets which error at which price.

`accuracy_table.py FILE.csv FOLDER` writes FOLDER/accuracy.md; with `--check` before, it only says whether that is what
stands there."""
import math
from committed_table import CommittedTable

TOLERANCES = ("1e-2", "1e-4", "1e-6")

TEXT = """# What accuracy costs

Made from `accuracy.csv` by `bench/run accuracy`; `accuracy.txt` says on what machine and of which commit.

A cell reads: method, with its `max_error_rel` and its resolution in pixels across 90 degrees, where it has them; then
its time per scan as a ratio to the cheapest method of the same scene and scanner in the same run. A method *meets* an
error if at most one beam in a thousand is off by more (p99.9, relative to the range; a wrong hit or miss counts as
infinitely far off). `nearest` stands there as the way of other simulators: at its coarsest and at its finest, with its
own p99.9. Bare Embree (single precision, without bounds, without its tree's building) is what a ray cast costs at the
least.
`hybrid` with a tolerance that no rendered range can promise renders nothing: it then is `raycast`, and measured as that.

{table}

The columns of `accuracy.csv`:

| column | |
|---|---|
| `scene` `scanner` | `planar`: 361 beams over a half circle; `lidar`: 64 rings of 1024 beams, all around, 30 degrees high |
| `method` `max_error_rel` `resolution_px` | as in a scene file; no resolution: nothing is rendered. `embree_1`, `embree_16`: bare Embree by single rays and in packets |
| `scans` `beams` | how many were measured |
| `median_ms` `p10_ms` `p90_ms` | time per scan: planning, rendering, casting, collecting, results in memory; of bare Embree its casts alone |
| `ratio_to_cheapest` | median to the least median of SimVis' methods for this scene and scanner |
| `error_rel_median` `_p99` `_p999` `_max` | errors relative to the true range, of beams that meet something, truly or as read; `inf`: a hit for a miss, or the reverse |
| `share_wrong_hit` | of all beams: hit for miss, or miss for hit |
| `share_above_1e-3` | of all beams: off by more than 1e-3; that is no rounding any more, in most cases another surface |
| `share_cast` | of all beams: cast as rays |
| `bound_rel_median` | `error_bound_m` relative to the range read |
| `bound_violations` `_narrow` | beams whose error is above their bound; on surfaces under three pixels wide, of which bounds of rendered ranges do not speak, they are counted apart |
| `masks` | whether the scene has materials with holes in them, `seen` or `ignored` by the method |
"""


def number(value):
    """An error, a ratio or a time, with as many figures as it deserves."""
    if math.isinf(value):
        return "wrong hits"
    if value < 0.1:
        return f"{value:.1e}".replace("e-0", "e-")
    return f"{value:.2f}" if value < 10 else f"{value:.0f}"


def ratio(row):
    return number(float(row["ratio_to_cheapest"]))


def error(row):
    return number(float(row["error_rel_p999"]))


def words(row):
    resolution = f"at {row['resolution_px']}" if row["resolution_px"] else ""
    return " ".join(filter(None, (f"`{row['method']}`", row["max_error_rel"], resolution)))


def is_peer(row):
    return row["method"].startswith("embree")


def cheapest(rows, tolerance):
    """The cheapest method of SimVis that meets an error; None if none does."""
    meets = [row for row in rows if not is_peer(row) and float(row["error_rel_p999"]) <= float(tolerance)]
    return min(meets, key=lambda row: float(row["median_ms"]), default=None)


def cells(rows):
    nearest = [row for row in rows if row["method"] == "nearest"]
    embree = next(row for row in rows if row["method"] == "embree_16")
    base_ms = min(float(row["median_ms"]) for row in rows if not is_peer(row))
    result = [rows[0]["scene"], rows[0]["scanner"], f"{number(base_ms)} ms"]
    result += [f"{row['resolution_px']} px: {ratio(row)}, {error(row)}"
               for row in (nearest[0], nearest[-1])]
    for tolerance in TOLERANCES:
        row = cheapest(rows, tolerance)
        result.append(f"{words(row)}: {ratio(row)}" if row else "none")
    masks = ", masks ignored" if embree["masks"] == "ignored" else ""
    result.append(f"{ratio(embree)}, {error(embree)}{masks}")
    return result


def table(rows):
    header = ["scene", "scanner", "cheapest", "coarsest `nearest`", "finest `nearest`",
              *(f"meets {tolerance}" for tolerance in TOLERANCES), "bare Embree, packets"]
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    for key in dict.fromkeys((row["scene"], row["scanner"]) for row in rows):
        of_key = [row for row in rows if (row["scene"], row["scanner"]) == key]
        lines.append("| " + " | ".join(cells(of_key)) + " |")
    return "\n".join(lines)


def text(rows):
    return TEXT.format(table=table(rows))


TABLE = CommittedTable("accuracy.md", text)

if __name__ == "__main__":
    TABLE.main()
