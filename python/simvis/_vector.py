"""Many simulations of one scene that are stepped together."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping, Sequence
from operator import index
from types import TracebackType
from typing import TYPE_CHECKING, Any

from ._errors import InputError, UnknownName
from ._loading import VectorLoading
from ._mistakes import suggestion
from ._simulation import Simulation

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


class VectorSimulation(VectorLoading):
    """Copies of a scene, called environments, which are stepped together: `VectorSimulation.load(file, 100)` makes them.

        sims.parameters["P.yaw"] = yaws            # (100,), or one number for all
        sims.step()
        ranges = sims.outputs["SCAN.range_m"]      # (100, rings, beams)

    Environment i, `sims[i]`, is a Simulation whose seed is `seed` + i. It measures the same bytes as one that was loaded
    alone with that seed, whatever the numbers of environments and of threads are. Meshes, textures and trees for rays are
    there once. `environments` of functions are numbers from 0, or an array of bool with a value for each.

    An error of an environment says which one it was; all others have made their frame then, and `failed` lists those that
    have not. Otherwise as Simulation.
    """

    def __enter__(self) -> VectorSimulation:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def __getitem__(self, number: int) -> Simulation:
        """One environment. After reload() of it, this one is no longer stepped with the others."""
        i = index(number)
        if not -len(self) <= i < len(self):
            raise IndexError(f"there is no environment {i} among {len(self)}")
        return Simulation(self, i % len(self))

    def __iter__(self) -> Iterator[Simulation]:
        return (self[i] for i in range(len(self)))

    @property
    def parameters(self) -> VectorParameters:
        """The parameters, by "ELEMENT.PARAMETER": (environments,) float64."""
        return VectorParameters(self)

    @property
    def outputs(self) -> VectorOutputs:
        """The outputs of sensors, by "SENSOR.OUTPUT": (environments, ...)."""
        return VectorOutputs(self)

    def only(self, *sensors: str) -> None:
        """Turns these sensors on and all others off, in all environments."""
        for sim in self:
            sim.only(*sensors)

    def step_some(self, environments: npt.ArrayLike) -> None:
        """Makes one frame of these environments alone."""
        self._step_some(self._numbers(environments))

    def restore_states(self, environments: npt.ArrayLike | None = None) -> None:
        """Takes environments, by default all, back to the states of save_states(); outputs change at the next step."""
        self._restore_states(self._numbers(environments))

    def reload(self, seeds: Sequence[int], environments: npt.ArrayLike | None = None) -> None:
        """Loads environments, by default all, again, each with its own seed. The same sensors are on as before."""
        numbers = [index(seed) for seed in seeds]
        for seed in numbers:
            if not 0 <= seed < 1 << 64:
                raise InputError(f"a seed is {seed}, expected a whole number from 0 to {(1 << 64) - 1}")
        self._reload(self._numbers(environments), numbers)

    def _numbers(self, environments: npt.ArrayLike | None) -> list[int]:
        import numpy as np

        if environments is None:
            return list(range(len(self)))
        array = np.asarray(environments)
        if array.dtype == bool and array.shape == (len(self),):
            return [int(i) for i in np.flatnonzero(array)]
        if array.size == 0:
            return []
        if array.ndim != 1 or not np.issubdtype(array.dtype, np.integer) or array.min() < 0:
            raise InputError(f"environments is {environments!r}, expected numbers from 0, or {len(self)} values of bool")
        return [int(i) for i in array]

    def __repr__(self) -> str:
        return "closed environments" if self._closed else f"{len(self)} environments of\n{self[0]!r}"


class VectorParameters(MutableMapping[str, "npt.NDArray[np.float64]"]):
    """The parameters of all environments. One number sets the parameter in all of them."""

    def __init__(self, vector: VectorSimulation) -> None:
        self._vector = vector

    def _first(self) -> MutableMapping[str, float]:
        return self._vector[0].parameters

    def __getitem__(self, name: str) -> npt.NDArray[np.float64]:
        import numpy as np

        self._first()[name]  # raises for an unknown one
        return np.array(self._vector._get(*_split(name, self)))

    def __setitem__(self, name: str, value: npt.ArrayLike) -> None:
        import numpy as np

        try:
            values = np.ascontiguousarray(np.atleast_1d(value), np.float64)
        except (TypeError, ValueError):
            raise InputError(f"{name} is {value!r}, expected a number or {len(self._vector)} of them") from None
        if values.ndim != 1:
            raise InputError(f"{name} has the shape {values.shape}, expected ({len(self._vector)},)")
        try:
            self._vector._set(*_split(name, self), values)
        except InputError:
            self._first()[name]  # raises UnknownName for an unknown one
            raise

    def __delitem__(self, name: str) -> None:
        raise InputError("a parameter cannot be removed")

    def __iter__(self) -> Iterator[str]:
        return iter(self._first())

    def __len__(self) -> int:
        return len(self._first())


class VectorOutputs:
    """The outputs of sensors in all environments, as read-only arrays that keep their numbers.

    Any output of docs/reference.md whose shape never varies, and "SENSOR.rgb", the sRGB codes of a sensor's colour image. NaN,
    or 0 of whole numbers, of a sensor that has not measured yet, and of an environment whose changed scene does not give the
    output in this shape. Each step collects the outputs that have been read once.
    """

    def __init__(self, vector: VectorSimulation) -> None:
        self._vector = vector

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        sensor, dot, output = name.rpartition(".")
        known = self._vector[0]._sensor_names()
        if not dot:
            raise UnknownName(f'"{name}" names no output, expected SENSOR.OUTPUT such as "FRONT.range_m"')
        if sensor not in known:
            raise UnknownName(f'there is no sensor "{sensor}"' + suggestion(sensor, known))
        return self._vector._output(sensor, output)


def _split(name: str, known: VectorParameters) -> tuple[str, str]:
    element, dot, parameter = name.rpartition(".")
    if not dot:
        raise UnknownName(f'"{name}" names no parameter, expected ELEMENT.PARAMETER' + suggestion(name, known))
    return element, parameter
