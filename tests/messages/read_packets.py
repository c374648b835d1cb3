"""Compares a capture file, as the decoder of a vendor reads it, with the CSV files of the same run.

read_packets.py velodyne|dual|ouster CAPTURE.pcap UNIT_M SCAN.csv

Prints the number of points and the largest errors; fails where one is beyond the resolution of the device.
"""

import csv
import math
import sys

import numpy as np

CLOCK_S = 3600  # what devices show at time 0


def scan(file):
    """The rows with a range: ring, beam, time, range, x, y, z, reflectivity."""
    rows = []
    with open(file, newline="") as stream:
        for row in csv.DictReader(stream):
            distance = float(row["range_m"])
            if 0 < distance < math.inf:
                reflectivity = min(255, round(100 * float(row["intensity"]) * distance**2))
                rows.append([int(row["ring"]), int(row["beam"]), float(row["time_s"]) + CLOCK_S, distance,
                             float(row["x_m"]), float(row["y_m"]), float(row["z_m"]), reflectivity])
    return np.array(rows)


def velodyne_points(capture):
    """The points of the decoder, with the times of the device, and the numbers of their columns."""
    import velodyne_decoder as vd

    points = []
    for stamp, cloud in vd.read_pcap(capture, vd.Config(min_range=0, max_range=1000)):
        cloud = np.asarray(cloud, dtype=float)
        cloud[:, vd.PointField.time] += stamp.device
        points.append(cloud)
    return np.concatenate(points), vd.PointField


def velodyne(capture, unit_m, expected):
    points, field = velodyne_points(capture)
    assert len(points) == len(expected), (len(points), len(expected))
    # Ring by ring, each in the order of time.
    points = points[np.lexsort((points[:, field.time], points[:, field.ring]))]
    expected = expected[np.lexsort((expected[:, 2], expected[:, 0]))]
    assert (points[:, field.ring] == expected[:, 0]).all(), "rings differ"
    # In the first packets the decoder knows neither the rate of rotation nor the firing time of a VLS-128.
    known = points[:, field.time] > points[:, field.time].min() + 0.5e-3
    late = np.abs(points[:, field.time] - expected[:, 2])[known].max()
    # A stamp has microseconds. For a VLS-128 the decoder waits for two groups of lasers after the eighth, where the
    # manual has one (2.67 us), and takes 6.46 us for the first three groups, where the manual has 7.995 us.
    grouped = points[:, field.ring].max() == 127
    assert late < (5e-6 if grouped else 1e-6), late
    assert (points[:, field.intensity] == expected[:, 7]).all(), "reflectivities differ"
    away = np.linalg.norm(points[:, :3] - expected[:, 4:7], axis=1)
    # Half a unit along the beam; across it two roundings of the azimuth to 0.01 degrees, and what the head turns in 2.8 us.
    across_deg = 0.021 if grouped else 0.011
    allowed = unit_m / 2 + expected[:, 3] * math.radians(across_deg) + 1e-4
    worst = (away / allowed)[known].max()
    assert worst <= 1, worst
    print(len(points), "points")


def two_returns(file):
    """The returns of each beam: ring, time, range, x, y, z, the decoder's kind."""
    rows = []
    with open(file, newline="") as stream:
        for row in csv.DictReader(stream):
            distance = float(row["range_m"])
            if not 0 < distance < math.inf:
                continue
            azimuth, elevation = (math.radians(float(row[name])) for name in ("azimuth_deg", "elevation_deg"))
            along = np.array([math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth),
                              math.sin(elevation)])
            place = np.array([float(row[name]) for name in ("x_m", "y_m", "z_m")])
            second = float(row["second_range_m"] or "nan")
            for away in [distance] if math.isnan(second) else [distance, second]:
                # 3: the only return; 2: the last of two; 1: the other, whether it is the strongest or the second.
                kind = 3 if math.isnan(second) else 2 if away == max(distance, second) else 1
                rows.append([int(row["ring"]), float(row["time_s"]) + CLOCK_S, away,
                             *(place + (away - distance) * along), kind])
    return np.array(rows, dtype=float)


def dual(capture, unit_m, expected):
    points, field = velodyne_points(capture)
    assert len(points) == len(expected), (len(points), len(expected))
    away = np.linalg.norm(points[:, :3], axis=1)
    # Ring by ring, each in the order of time, which has microseconds, and the nearer return first.
    points = points[np.lexsort((away, np.round(points[:, field.time], 6), points[:, field.ring]))]
    expected = expected[np.lexsort((expected[:, 2], np.round(expected[:, 1], 6), expected[:, 0]))]
    assert (points[:, field.ring] == expected[:, 0]).all(), "rings differ"
    known = points[:, field.time] > points[:, field.time].min() + 0.5e-3
    apart = np.linalg.norm(points[:, :3] - expected[:, 3:6], axis=1)
    worst = (apart / (unit_m / 2 + expected[:, 2] * math.radians(0.011) + 1e-4))[known].max()
    assert worst <= 1, worst
    assert (points[:, field.return_type] == expected[:, 6])[known].all(), "kinds of returns differ"
    assert (expected[:, 6] == 2).sum() > 50, "no beam has two returns"
    print(len(points), "points")


def ouster(capture, unit_m, expected):
    from ouster.sdk import core, open_source

    source = open_source(capture, meta=[capture + ".json"])
    count = 0
    for frame in source:
        scan = list(frame)[0]
        info = scan.sensor_info
        xyz = core.XYZLut(info)(scan)
        ranges = scan.field(core.ChanField.RANGE)
        reflectivities = scan.field(core.ChanField.REFLECTIVITY)
        stamps = np.asarray(scan.timestamp, dtype=float) / 1e9
        first = stamps[0]
        mine = expected[(expected[:, 2] > first - 1e-6) & (expected[:, 2] < stamps[-1] + 1e-6)]
        rings, beams = mine[:, 0].astype(int), mine[:, 1].astype(int)
        assert (ranges > 0).sum() == len(mine), ((ranges > 0).sum(), len(mine))
        assert (np.abs(stamps[beams] - mine[:, 2]) < 1e-8).all(), "times differ"
        assert (reflectivities[rings, beams] == mine[:, 7]).all(), "reflectivities differ"
        away = np.linalg.norm(xyz[rings, beams] - mine[:, 4:7], axis=1)
        assert away.max() <= unit_m / 2 + 1e-6, away.max()
        count += len(mine)
    assert count == len(expected), (count, len(expected))
    print(count, "points")


if __name__ == "__main__":
    kind, capture, unit, rows = sys.argv[1:]
    read = {"velodyne": velodyne, "dual": dual, "ouster": ouster}[kind]
    read(capture, float(unit), (two_returns if kind == "dual" else scan)(rows))
