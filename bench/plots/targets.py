#!/usr/bin/env python3
"""Which targets of speed are met, from what scan_curves, camera_peer and scale have printed.

`targets.py FOLDER` reads FOLDER/*.csv, as far as they are there, and writes FOLDER/targets.md; with `--check` before,
it only says whether that is what stands there."""
import csv
import math
import sys
from pathlib import Path

NAME = "targets.md"

TEXT = """# Targets of speed

Made from `scan_curves.csv`, `camera_peer.csv` and `scale.csv` by `bench/run speed`; the `.txt` files beside them say on
what machine and of which commit, `bench/README.md` how to read them.

{targets}

## Where one way overtakes another

{crossings}
"""


def rows_of(folder, name):
    path = Path(folder, name)
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(value, goal=None):
    """With three figures, and with more where these would be the goal's though the value is another."""
    if value >= 100:
        return f"{value:,.0f}"
    figures = 3
    while goal is not None and value != goal and float(f"{value:.{figures}g}") == goal:
        figures += 1
    return f"{value:.{figures}g}"


class Curves:
    """Medians of scan_curves, by point and way."""

    def __init__(self, rows):
        self.points = {}  # (curve, size class): {(way, tolerance, threads): row}
        for row in rows:
            point = (row["curve"], round(math.log10(int(row["triangles"])), 0), int(row["beams"]))
            self.points.setdefault(point, {})[row["way"], row["max_error_rel"], int(row["threads"])] = row

    def find(self, curve, triangles=None):
        for (name, magnitude, _), ways in self.points.items():
            if name == curve and (triangles is None or magnitude == round(math.log10(triangles))):
                return ways
        return None


def ms(ways, way, tolerance="", threads=0, column="median_ms"):
    row = ways.get((way, tolerance, threads)) if ways else None
    return float(row[column]) if row else None


def at_least(what, goal, value, unit=""):
    return what, "at least", goal, value, unit, value is not None and value >= goal


def at_most(what, goal, value, unit=""):
    return what, "at most", goal, value, unit, value is not None and value <= goal


def ratio(above, below):
    return above / below if above is not None and below is not None else None


def per_second(time_ms):
    return 1e3 / time_ms if time_ms is not None else None


def scan_targets(curves):
    marvin, fine = curves.find("marvin"), curves.find("marvin 1M")
    for way in ("planar", "raycast"):
        yield at_least(f"marvin, three scanners of 361, `{way}`", 1000, per_second(ms(marvin, way)), " sets/s")
    yield at_most("the same: processor time of the caller, `planar`", 0.15,
                  ms(marvin, "planar", column="caller_cpu_ms"), " ms")
    for way in ("planar", "raycast"):
        yield at_least(f"marvin of a million triangles, `{way}`", 500, per_second(ms(fine, way)), " sets/s")
    for triangles, goal in ((10_000, 5), (100_000, 20), (1_000_000, 50)):
        lab = curves.find("triangles", triangles)
        yield at_least(f"lab of {triangles:,} triangles, `hybrid`, times as fast as Coin's depth buffer", goal,
                       ratio(ms(lab, "coin depth", threads=2), ms(lab, "hybrid", "1e-6")))
        yield at_least(f"lab of {triangles:,} triangles, `hybrid`, times as fast as Coin's ray pick", 100,
                       ratio(ms(lab, "coin pick", threads=1), ms(lab, "hybrid", "1e-6")))
    yield at_least("marvin, `raycast`", 5000, per_second(ms(marvin, "raycast")), " sets/s")
    for triangles in (100_000, 1_000_000):
        lab = curves.find("lidar", triangles)
        name = f"64 x 2048 beams, lab of {triangles:,} triangles, `raycast`: time to that of Embree"
        yield at_most(f"{name} in packets of 16, 2 threads", 2,
                      ratio(ms(lab, "raycast"), ms(lab, "embree 16", threads=2)))
        yield at_most(f"{name} by single rays, 2 threads", 1, ratio(ms(lab, "raycast"), ms(lab, "embree 1", threads=2)))
    value, point = worst_auto(curves)
    yield at_most(f"`auto`: time to that of the best way that keeps its tolerance, at the worst point{point}", 1.2, value)


def worst_auto(curves):
    ratios = [(ms(ways, "auto", tolerance) / min(ms(ways, "raycast"), ms(ways, "hybrid", tolerance)),
               f" ({curve}: {next(iter(ways.values()))['triangles']} triangles, {beams} beams, {tolerance})")
              for (curve, _, beams), ways in curves.points.items() for tolerance in ("1e-4", "1e-6")]
    return max(ratios, default=(None, ""))


def camera_target(rows):
    value = next((float(row["ratio_to_bare"]) for row in rows if (row["scene"], row["loop"]) == ("marvin", "simvis")),
                 None)
    yield at_most("marvin, camera 640 x 480, colour and depth: time to that of the bare loop", 1.25, value)


def of(rows, curve, method, cache=""):
    return [row for row in rows if (row["curve"], row["method"], row["cache"]) == (curve, method, cache)]


def last_to_first(rows, column):
    return ratio(float(rows[-1][column]), float(rows[0][column])) if rows else None


def scale_targets(rows):
    for row in of(rows, "memory", "") + of(rows, "triangles", "planar", "cold")[-1:]:
        scene = "marvin" if row["curve"] == "memory" else f"lab of {int(row['size']):,} triangles"
        yield at_most(f"{scene}: memory on the device but for targets, to that of meshes and textures", 1.5,
                      (float(row["device_mb"]) - float(row["targets_mb"])) / float(row["data_mb"]))
    for method in ("planar", "raycast"):
        for row in of(rows, "triangles", method, "cold")[-1:]:
            yield at_most(f"lab of {int(row['size']):,} triangles: resident memory of the process by `{method}`, all of "
                          "it, to that of meshes and textures", 1.5, float(row["rss_mb"]) / float(row["data_mb"]))
    for method in ("planar", "raycast"):
        for cache in ("cold", "warm"):
            for row in of(rows, "triangles", method, cache)[-1:]:
                yield at_most(f"lab of {int(row['size']):,} triangles: open, first scans by `{method}`, {cache} cache",
                              10, float(row["open_s"]), " s")
    for method in ("raycast", "planar"):
        tenths = of(rows, "frames", method)
        if len(tenths) > 1:
            yield at_most(f"`{method}`: resident memory after {int(tenths[-1]['size']):,} frames to that after "
                          f"{int(tenths[0]['size']):,}", 1.01, last_to_first(tenths, "rss_mb"))
    for method in ("planar", "raycast", "camera"):
        grown = last_to_first(of(rows, "instances", method), "median_ms")
        yield at_most(f"100,000 instances of which 100 are in sight, `{method}`: time to that of 100", 2, grown)
    for method in ("planar", "raycast"):
        sensors = of(rows, "sensors", method)
        each = last_to_first(sensors, "median_ms")
        if each is not None:
            each /= float(sensors[-1]["size"]) / float(sensors[0]["size"])
        yield at_most(f"100 scanners, `{method}`: time of each to that of one alone", 1, each)


def target_table(rows):
    lines = ["| target | asked | measured | |", "|---|---|---|---|"]
    for what, side, goal, value, unit, met in rows:
        measured = "not measured" if value is None else number(value, goal) + unit
        lines.append(f"| {what} | {side} {number(goal)}{unit} | {measured} | {'' if value is None else 'met' if met else '**missed**'} |")
    return "\n".join(lines)


def crossings(curves, curve, column):
    """Where `planar` and `raycast` take the same time, between neighbouring points: straight lines in logarithms."""
    points = sorted((float(ways["planar", "", 0][column]), ms(ways, "planar") / ms(ways, "raycast"))
                    for (name, _, _), ways in curves.points.items() if name == curve)
    for (size, slower), (next_size, next_slower) in zip(points, points[1:]):
        if (slower - 1) * (next_slower - 1) < 0:
            share = math.log(slower) / (math.log(slower) - math.log(next_slower))
            yield size * (next_size / size) ** share, "planar" if slower > 1 else "raycast"
    if points:
        yield None, "raycast" if points[-1][1] > 1 else "planar"


def crossing_text(curves):
    lines = []
    for curve, column, where in (("triangles", "triangles", "Three scans of 361 beams"),
                                 ("beams", "beams", "One scan in a lab of 100,000 triangles")):
        found = list(crossings(curves, curve, column))
        if not found:
            continue
        *places, (_, last) = found
        text = "; ".join(f"from about {number(float(f'{place:.1e}'))} {column} on `{way}`" for place, way in places)
        lines.append(f"* {where}, of `planar` and `raycast` the faster: " +
                     (text if text else f"`{last}` at every size") + ".")
    return "\n".join(lines) or "Not measured."


def text(folder):
    curves = Curves(rows_of(folder, "scan_curves.csv"))
    rows = [*scan_targets(curves), *camera_target(rows_of(folder, "camera_peer.csv")),
            *scale_targets(rows_of(folder, "scale.csv"))]
    return TEXT.format(targets=target_table(rows), crossings=crossing_text(curves))


def main():
    *options, folder = sys.argv[1:]
    path = Path(folder, NAME)
    if options != ["--check"]:
        path.write_text(text(folder), encoding="utf-8")
    elif path.read_text(encoding="utf-8") != text(folder):
        sys.exit(f"{NAME} is not what targets.py makes of {folder}")


if __name__ == "__main__":
    main()
