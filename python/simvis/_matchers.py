"""Matchers for tests: they use the error bounds that measurements have, so that a test needs no tolerance of its own."""

from __future__ import annotations

import os
from math import degrees, hypot, inf, isinf
from typing import TYPE_CHECKING, Any

from ._core import Scan, write_whole
from ._errors import InputError
from ._proxies import Sensor
from ._verdict import Verdict

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


def _scan_of(of: Sensor | Scan) -> tuple[Scan, str]:
    return (of.scan, of.name) if isinstance(of, Sensor) else (of, "the scan")


def _beam(scan: Scan, name: str, ring: int, beam: int) -> str:
    if not (0 <= ring < scan.rings and 0 <= beam < scan.beams):
        raise InputError(f"{name} has {scan.rings} rings of {scan.beams} beams, expected a beam of it, not {beam} of ring {ring}")
    return f"{name}: beam {beam}" + (f" of ring {ring}" if scan.rings > 1 else "")


def _selected(of: Sensor | Scan, scan: Scan, ring: int, beam: int) -> str:
    return f"beam:{of.name}:{ring * scan.beams + beam}" if isinstance(of, Sensor) else ""


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
    where, selected = _beam(scan, name, ring, beam), _selected(of, scan, ring, beam)
    measured, bound = float(scan.range_m[ring, beam]), float(scan.error_bound_m[ring, beam])
    if isinf(measured) or isinf(expected_m):
        ok = measured == expected_m
        return Verdict(ok, f"{where} measures {measured:.9g} m, expected {expected_m:.9g} m", selected)
    off = abs(measured - expected_m)
    text = f"{where} measures {measured:.9g} m, expected {expected_m:.9g} m: {off:.3g} m apart, allowed {bound:.3g} m"
    return Verdict(off <= bound + slack_m, text + (f" and {slack_m:g} m" if slack_m else ""), selected)


def scans_near(one: Sensor | Scan, other: Sensor | Scan, *, slack_m: float = 0.0) -> Verdict:
    """Whether all beams of two scans agree within the sum of their error bounds and `slack_m`.

    A beam whose bound is infinite in one of them decides nothing; a range that is not a number is near nothing.
    """
    import numpy as np

    _not_negative(slack_m=slack_m)
    (a, name), (b, other_name) = _scan_of(one), _scan_of(other)
    if a.range_m.shape != b.range_m.shape:
        return Verdict(False, f"{name} has {a.range_m.shape} beams, {other_name} {b.range_m.shape}")
    x, y = a.range_m.astype(np.float64), b.range_m.astype(np.float64)
    allowed = a.error_bound_m.astype(np.float64) + b.error_bound_m + slack_m
    with np.errstate(invalid="ignore"):
        apart = np.where(x == y, 0.0, np.abs(x - y))  # inf - inf: both meet nothing
        excess = np.where(np.isinf(allowed), 0.0, apart - allowed)
    excess = np.where(np.isnan(excess), inf, excess)
    wrong = int((excess > 0).sum())
    if wrong == 0:
        return Verdict(True, f"all {x.size} beams of {name} and {other_name} agree within their bounds")
    ring, beam = (int(i) for i in np.unravel_index(np.argmax(excess), excess.shape))
    return Verdict(False, f"{wrong} of {x.size} beams of {name} and {other_name} differ by more than their bounds; worst: "
                          f"beam {beam} of ring {ring}, {x[ring, beam]:.9g} and {y[ring, beam]:.9g} m, allowed "
                          f"{allowed[ring, beam]:.3g} m", _selected(one, a, ring, beam) or _selected(other, b, ring, beam))


def clear_of(of: Sensor | Scan, distance_m: float) -> Verdict:
    """Whether nothing can be nearer to the scanner than `distance_m`: each range less its error bound is at least that.

    A beam whose bound is infinite may have met a surface at any range.
    """
    import numpy as np

    scan, name = _scan_of(of)
    bound = scan.error_bound_m.astype(np.float64)
    with np.errstate(invalid="ignore"):
        least = np.where(np.isinf(bound), -inf, scan.range_m.astype(np.float64) - bound)
    ring, beam = (int(i) for i in np.unravel_index(np.argmin(least), least.shape))
    where = _beam(scan, name, ring, beam)
    measured = float(scan.range_m[ring, beam])
    text = f"{where} measures {measured:.6g} m +- {float(scan.error_bound_m[ring, beam]):.3g} m, the nearest of all; expected at least {distance_m:g} m"
    return Verdict(bool(least[ring, beam] >= distance_m), text, _selected(of, scan, ring, beam))


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
    apart = float(np.linalg.norm(a[:3, 3] - b[:3, 3]))
    turn = a[:3, :3].T @ b[:3, :3]
    # The sine is exact for small turns, the cosine for large ones.
    sine = hypot(turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]) / 2
    cosine = (float(np.trace(turn)) - 1) / 2
    angle = degrees(float(np.arctan2(sine, cosine)))
    text = f"the poses are {apart:.6g} m and {angle:.6g} deg apart, allowed {position_m:g} m and {angle_deg:g} deg"
    return Verdict(apart <= position_m and angle <= angle_deg, text)


def near_path(position_m: npt.ArrayLike, path_m: npt.ArrayLike, distance_m: float) -> Verdict:
    """Whether a point lies within `distance_m` of a path of straight pieces between points (n, 2) or (n, 3).

    As many coordinates are compared as the path's points have.
    """
    import numpy as np

    path = np.asarray(path_m, np.float64)
    if path.ndim != 2 or len(path) < 1 or path.shape[1] not in (2, 3):
        raise InputError(f"the path has shape {path.shape}, expected (n, 2) or (n, 3)")
    point = np.asarray(position_m, np.float64)[: path.shape[1]]
    start, way = path[:-1], np.diff(path, axis=0)
    length = (way * way).sum(axis=1)
    along = np.clip(((point - start) * way).sum(axis=1) / np.where(length > 0, length, 1), 0, 1)
    nearest = np.vstack([start + along[:, None] * way, path[-1:]])
    apart = float(np.linalg.norm(nearest - point, axis=1).min())
    return Verdict(apart <= distance_m, f"the position is {apart:.6g} m beside the path, allowed {distance_m:g} m")


def depths_near(one: Sensor, other: npt.ArrayLike, *, slack_m: float = 0.0) -> Verdict:
    """Whether a camera's depth image (m along the optical axis) is the expected one, within its error bound and `slack_m`."""
    import numpy as np

    _not_negative(slack_m=slack_m)
    measured, expected = one.depth.astype(np.float64), np.asarray(other, np.float64)
    if measured.shape != expected.shape:
        return Verdict(False, f"{one.name} has {measured.shape} pixels, expected {expected.shape}")
    allowed = one.value("depth_error_bound_m") + slack_m
    with np.errstate(invalid="ignore"):
        apart = np.where(measured == expected, 0.0, np.abs(measured - expected))
    wrong = int((~(apart <= allowed)).sum())  # NaN is wrong
    y, x = (int(i) for i in np.unravel_index(np.argmax(apart), apart.shape))
    return Verdict(wrong == 0, f"{wrong} of {apart.size} pixels of {one.name} differ by more than {allowed:.3g} m; farthest: "
                               f"pixel ({x}, {y}), {measured[y, x]:.6g} and {expected[y, x]:.6g} m")


def pictures_near(one: npt.NDArray[np.uint8], other: npt.NDArray[np.uint8], *, codes: int = 1, share: float = 0.0,
                  difference: str | os.PathLike[str] | None = None) -> Verdict:
    """Whether two (h, w, 3) pictures of sRGB codes agree: at most a share of the pixels differs by more than `codes`.

    `difference`: where they differ, a PNG of this name shows by how much, white for 16 codes and more.
    """
    import numpy as np

    if one.shape != other.shape or one.ndim != 3:
        return Verdict(False, f"the pictures have shapes {one.shape} and {other.shape}, expected (h, w, 3) of both")
    apart = np.abs(one.astype(np.int16) - other).max(axis=2)
    wrong = int((apart > codes).sum())
    ok = wrong <= share * apart.size
    if not ok and difference is not None:
        from ._png import grey_png

        write_whole(difference, grey_png(np.minimum(apart * 16, 255).astype(np.uint8)))
    y, x = (int(i) for i in np.unravel_index(np.argmax(apart), apart.shape))
    text = (f"{wrong} of {apart.size} pixels differ by more than {codes} codes, allowed {int(share * apart.size)}; most: "
            f"pixel ({x}, {y}), {one[y, x].tolist()} and {other[y, x].tolist()}")
    if not ok and difference is not None:
        text += f"; see {os.fspath(difference)}"
    return Verdict(ok, text)
