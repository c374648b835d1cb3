"""Parameters over time."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from numbers import Real
from typing import TYPE_CHECKING, Any, Protocol, Union

from ._errors import InputError

if TYPE_CHECKING:
    import numpy.typing as npt

Values = Union[Callable[[float], float], "npt.ArrayLike"]


class HasParameters(Protocol):
    """What a trajectory moves, such as a Simulation."""

    def set(self, element: str, parameter: str, value: float) -> None: ...


class Trajectory:
    """Parameters over time: arrays over `times_s`, between whose rows values change linearly, or functions of seconds.

        Trajectory({"R_POSE.x": [0, 2, 2], "R_POSE.yaw": [0, 0, 90]}, times_s=[0, 4, 5])
        Trajectory({"R_POSE.x": lambda t: 0.5 * t})

    Before the first row a value is that of the first row, after the last row that of the last. An angle does not take
    the short way: 350 to 10 passes through 180.
    """

    def __init__(self, parameters: Mapping[str, Values], times_s: npt.ArrayLike | None = None) -> None:
        import numpy as np

        self._times: Any = None
        if times_s is not None:
            self._times = np.asarray(times_s, np.float64)
            if self._times.ndim != 1 or len(self._times) == 0:
                raise InputError(f"times_s has shape {self._times.shape}, expected one row of times")
            if not np.all(np.isfinite(self._times)) or np.any(np.diff(self._times) <= 0):
                raise InputError("times_s are not finite and increasing")
        self._values: dict[str, Any] = {}  # arrays and functions
        for name, values in parameters.items():
            if "." not in name:
                raise InputError(f'"{name}" names no parameter, expected ELEMENT.PARAMETER')
            self._values[name] = values if callable(values) else self._row(name, np.asarray(values, np.float64))

    def _row(self, name: str, row: Any) -> Any:
        if self._times is None:
            raise InputError(f"{name} has an array, expected times_s with it")
        if row.shape != self._times.shape:
            raise InputError(f"{name} has shape {row.shape}, expected {self._times.shape} as times_s has")
        return row

    def apply(self, simulation: HasParameters, time_s: float) -> None:
        """Sets the parameters to their values at that time."""
        for name, values in self._values.items():
            value = self._at(values, time_s)
            if not isinstance(value, Real) or not math.isfinite(value):
                raise InputError(f"{name} is {value} at {time_s} s, expected a finite number")
            element, parameter = name.rsplit(".", 1)
            simulation.set(element, parameter, float(value))

    def _at(self, values: Any, time_s: float) -> Any:
        import numpy as np

        return values(time_s) if callable(values) else np.interp(time_s, self._times, values)
