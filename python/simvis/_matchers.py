"""Matchers for tests: they use the error bounds that measurements have, so that a test needs no tolerance of its own.

What they compute and say is that of <simvis/testing.h>, which tests in C++ use.
"""

from __future__ import annotations

import os
from math import inf
from typing import TYPE_CHECKING

from . import _core
from ._core import Scan
from ._errors import InputError
from ._proxies import Sensor
from ._verdict import Verdict

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    _Answer = tuple[bool, str, int | None]  # whether it holds, the text, the beam that the text names


def _scan_of(of: Sensor | Scan) -> tuple[Scan, str]:
    return (of.scan, of.name) if isinstance(of, Sensor) else (of, "the scan")


def _verdict(of: Sensor | Scan, name: str, answer: _Answer) -> Verdict:
    """The answer about a scan, with its name and what the page selects."""
    ok, text, beam = answer
    select = f"beam:{of.name}:{beam}" if isinstance(of, Sensor) and beam is not None else ""
    return Verdict(ok, f"{name}: {text}", select)


def _not_negative(**values: float) -> None:
    for name, value in values.items():
        if not 0 <= value < inf:
            raise InputError(f"{name} is {value!r}, expected 0 or more")


def range_near(of: Sensor | Scan, expected_m: float, beam: int, ring: int = 0, *, slack_m: float = 0.0) -> Verdict:
    """Whether a beam's range is the expected one, within the beam's own error bound and `slack_m`.

    `expected_m` is the true range in metres; inf: the beam meets nothing. `slack_m` is for noise, which the bound does
    not include, and for what the test's own expectation is uncertain by.
    """
    _not_negative(slack_m=slack_m)
    scan, name = _scan_of(of)
    if not (0 <= ring < scan.rings and 0 <= beam < scan.beams):
        raise InputError(f"{name} has {scan.rings} rings of {scan.beams} beams, expected a beam of it, not {beam} of ring {ring}")
    return _verdict(of, name, _core.range_near(scan, ring * scan.beams + beam, expected_m, slack_m))


def scans_near(one: Sensor | Scan, other: Sensor | Scan, *, slack_m: float = 0.0) -> Verdict:
    """Whether all beams of two scans agree within the sum of their error bounds and `slack_m`.

    A beam whose bound is infinite in one of them decides nothing; a range that is not a number is near nothing.
    """
    _not_negative(slack_m=slack_m)
    (a, name), (b, other_name) = _scan_of(one), _scan_of(other)
    return _verdict(one if isinstance(one, Sensor) else other, f"{name} and {other_name}", _core.scans_near(a, b, slack_m))


def clear_of(of: Sensor | Scan, distance_m: float) -> Verdict:
    """Whether nothing can be nearer to the scanner than `distance_m`: each range less its error bound is at least that.

    A beam whose bound is infinite may have met a surface at any range.
    """
    scan, name = _scan_of(of)
    return _verdict(of, name, _core.clear_of(scan, distance_m))


def no_contact(sensor: Sensor) -> Verdict:
    """Whether a sensor of type contact, bumper or touch touches nothing."""
    if sensor.type not in ("bumper", "contact", "touch"):
        raise InputError(f'sensor "{sensor.name}" is a {sensor.type}, expected a contact, a bumper or a touch')
    reading = sensor.reading
    touches = len(reading) if sensor.type == "contact" else int((reading["pressed"] != 0).sum())
    return Verdict(touches == 0, f"{sensor.name} has {touches} contacts, expected none")


def pose_near(one: npt.ArrayLike | None, other: npt.ArrayLike, *, position_m: float, angle_deg: float) -> Verdict:
    """Whether two rigid (4, 4) poses are at most so far apart: of their origins, and of the turn between them."""
    import numpy as np

    _not_negative(position_m=position_m, angle_deg=angle_deg)
    if one is None:
        return Verdict(False, "the part is switched off, so it has no pose")
    a, b = np.asarray(one, np.float64), np.asarray(other, np.float64)
    for matrix in (a, b):
        if matrix.shape != (4, 4):
            raise InputError(f"a pose has shape {matrix.shape}, expected (4, 4)")
    ok, text, _ = _core.pose_near(a, b, position_m, angle_deg)
    return Verdict(ok, text)


def near_path(position_m: npt.ArrayLike, path_m: npt.ArrayLike, distance_m: float) -> Verdict:
    """Whether a point lies within `distance_m` of a path of straight pieces between points (n, 2) or (n, 3).

    As many coordinates are compared as the path's points have.
    """
    import numpy as np

    path = np.asarray(path_m, np.float64)
    if path.ndim != 2 or len(path) < 1 or path.shape[1] not in (2, 3):
        raise InputError(f"the path has shape {path.shape}, expected (n, 2) or (n, 3)")
    coordinates = path.shape[1]
    point = np.asarray(position_m, np.float64)
    if point.ndim != 1 or len(point) < coordinates:
        raise InputError(f"the position has shape {point.shape}, expected {coordinates} coordinates or more, as the path has")
    points = np.zeros((1 + len(path), 3))
    points[0, :coordinates], points[1:, :coordinates] = point[:coordinates], path
    ok, text, _ = _core.near_path(points[:1], points[1:], distance_m)
    return Verdict(ok, text)


def depths_near(one: Sensor, other: npt.ArrayLike, *, slack_m: float = 0.0) -> Verdict:
    """Whether a camera's depth image (m along the optical axis) is the expected one, within its error bound and `slack_m`."""
    import numpy as np

    _not_negative(slack_m=slack_m)
    measured, expected = one.depth, np.ascontiguousarray(other, np.float64)
    if measured.shape != expected.shape:
        return Verdict(False, f"{one.name} has {measured.shape} pixels, expected {expected.shape}")
    ok, text, _ = _core.depths_near(measured, expected, one.value("depth_error_bound_m") + slack_m)
    return Verdict(ok, f"{one.name}: {text}")


def pictures_near(one: npt.NDArray[np.uint8], other: npt.NDArray[np.uint8], *, codes: int = 1, share: float = 0.0,
                  difference: str | os.PathLike[str] | None = None) -> Verdict:
    """Whether two (h, w, 3) pictures of sRGB codes agree: at most a share of the pixels differs by more than `codes`.

    `difference`: where they differ, a PNG of this name shows by how much, white for 16 codes and more.
    """
    import numpy as np

    if one.shape != other.shape or one.ndim != 3 or one.shape[2] != 3:
        return Verdict(False, f"the pictures have shapes {one.shape} and {other.shape}, expected (h, w, 3) of both")
    ok, text, _ = _core.pictures_near(np.ascontiguousarray(one, np.uint8), np.ascontiguousarray(other, np.uint8), codes, share,
                                      difference)
    return Verdict(ok, text)
