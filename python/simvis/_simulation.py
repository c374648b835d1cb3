"""A running simulation."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from importlib import import_module
from types import TracebackType
from typing import TYPE_CHECKING, Any

from ._errors import InputError, UnknownName
from ._loading import Loading
from ._mistakes import suggestion
from ._price import PriceList
from ._proxies import ByName, Element, Parameters, Sensor, fitted
from ._trajectory import Trajectory


class Simulation(Loading):
    """A running simulation: `Simulation.load(file)` or `Simulation.from_string(xml)` makes one.

    Frames: world and sensors x forward, y left, z up; metres, angles of parameters in degrees. The interpreter's lock is
    free while the simulation works. One thread at a time may use it; several simulations may run at once. Wrong input
    raises InputError with `file`, `line` and `column`.
    """

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def run(self, frames: int, trajectory: Trajectory | None = None, progress: bool = True) -> Iterator[int]:
        """Makes so many frames, with the values of a trajectory, and yields the number of each.

        With `progress` and tqdm installed, a bar shows how far it is.
        """
        if frames < 0:
            raise InputError(f"frames is {frames}, expected 0 or more")
        if trajectory is not None and not isinstance(trajectory, Trajectory):
            raise InputError(f"trajectory is {trajectory!r}, expected a simvis.Trajectory")
        numbers: Any = range(frames)
        if progress:
            try:
                numbers = import_module("tqdm.auto").tqdm(numbers, unit="frame")
            except ImportError:
                pass
        for _ in numbers:
            index, time_ns = self._next_frame()
            if trajectory is not None:
                trajectory.apply(self, time_ns / 1e9)
            self.step()
            yield index

    @property
    def sensors(self) -> dict[str, Sensor]:
        """All sensors, in the order of the scene."""
        return ByName("sensor", {name: Sensor(self, name) for name in self._sensor_names()})

    def only(self, *sensors: str) -> None:
        """Turns these sensors on and all others off. What is off is not rendered."""
        known = self._sensor_names()
        for name in sensors:
            if not isinstance(name, str):
                raise InputError(f"{name!r} is no name, expected names such as only(\"FRONT\", \"REAR\")")
            if name not in known:
                raise UnknownName(f'there is no sensor "{name}"' + suggestion(name, known))
        for name in known:
            self._enable(name, name in sensors)

    @property
    def elements(self) -> dict[str, Element]:
        """All elements, in the order of the scene."""
        return ByName("element", {row["name"]: Element(self, row) for row in self._elements()})

    @property
    def parameters(self) -> Parameters:
        """All parameters, by "ELEMENT.PARAMETER"."""
        return Parameters(self)

    def price(self, *sensors: str, frames: int = 15) -> PriceList:
        """What each measuring method costs on this machine, and how exact it is, for these scanners (default: all)."""
        names = list(sensors) or [row["name"] for row in self._sensors() if row["type"] == "laser_scanner"]
        return PriceList(self._price(names, frames))

    def __getitem__(self, name: str) -> Any:
        """The element or sensor of this name. Its type depends on the scene; `sim.elements` and `sim.sensors` have types."""
        for row in self._elements():
            if row["name"] == name:
                if name in self._sensor_names():
                    raise InputError(f'"{name}" is an element and a sensor, expected sim.elements[...] or sim.sensors[...]')
                return Element(self, row)
        known = self._sensor_names()
        if name in known:
            return Sensor(self, name)
        for row in self.objects:
            if row["name"] == name:
                raise UnknownName(f'"{name}" is a {row["kind"]}, expected an element or a sensor' + self._moving(name))
        known += self._element_names()
        raise UnknownName(f'there is no element or sensor "{name}"' + suggestion(name, known))

    if not TYPE_CHECKING:  # a type checker must find these, too
        def __getattr__(self, name: str) -> Any:
            known = [] if name.startswith("_") or self._closed else list(self)
            if name in known:
                raise UnknownName(f'"{name}" is in the scene, did you mean sim["{name}"]?')
            raise UnknownName(f'a Simulation has no "{name}"' + suggestion(name, [*dir(type(self)), *known]))

    def _moving(self, part: str) -> str:
        """What a message says about the movement of a part."""
        for row in self._elements():
            if row["insert_at"] == part:
                return f', did you mean "{row["name"]}", which is inserted at it?'
        return f'; <element type="pose" name="{part}_POSE" insert_at="{part}"/> in the scene moves it'

    def __iter__(self) -> Iterator[str]:
        """The names of all elements and sensors."""
        return iter(self._ipython_key_completions_())

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._element_names()) + list(self._sensor_names())

    def __str__(self) -> str:
        """The scene as a tree."""
        return "a closed simulation" if self._closed else self._tree().rstrip("\n")

    def __repr__(self) -> str:
        """The beginning of the tree."""
        return fitted(str(self))

    def _repr_html_(self) -> str:
        return f'<div style="max-height: 30em; overflow: auto"><pre>{escape(str(self))}</pre></div>'
