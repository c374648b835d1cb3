"""A running simulation."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from html import escape
from importlib import import_module
from numbers import Real
from types import TracebackType
from typing import TYPE_CHECKING, Any

from ._core import Core
from ._errors import InputError, UnknownName
from ._loading import Loading
from ._price import PriceList
from ._proxies import ByName, Element, Parameters, Sensor, set_value, suggestion
from ._trajectory import Trajectory

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

class Simulation(Loading):
    """A running simulation: `Simulation.load(file)` or `Simulation.from_string(xml)` makes one.

    Frames: world and sensors x forward, y left, z up; metres, angles of parameters in degrees. The interpreter's lock is
    free while the simulation works. One thread at a time may use it; several simulations may run at once. Wrong input
    raises InputError with `file`, `line` and `column`.
    """

    def __init__(self, core: Core) -> None:
        if not isinstance(core, Core):
            raise InputError("expected Simulation.load(FILE) or Simulation.from_string(XML)")
        super().__init__(core)

    def close(self) -> None:
        """Ends the simulation. Arrays, scans and images that were taken of it stay. Every other call then raises."""
        self._core.close()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def step(self, dt_s: float | None = None) -> None:
        """Makes one frame. With `dt_s` it is taken so many seconds after the one before."""
        if dt_s is not None and not isinstance(dt_s, Real):
            raise InputError(f"dt_s is {dt_s!r}, expected seconds")
        self._core.step(dt_s)

    def step_async(self) -> None:
        """Begins a frame and returns while the device works on it; results are those of the frame before."""
        self._core.step_async()

    def finish(self) -> None:
        """Waits for the frame that step_async() began."""
        self._core.finish()

    def skip_frame(self) -> None:
        """Skips a frame: nothing is rendered or measured."""
        self._core.skip_frame()

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
            index, time_ns = self._core.next_frame()
            if trajectory is not None:
                trajectory.apply(self, time_ns / 1e9)
            self._core.step()
            yield index

    def set(self, element: str, parameter: str, value: float) -> None:
        """Sets a parameter, in the unit of its element's table. It takes effect at the next step."""
        set_value(self._core, element, parameter, value)

    def get(self, element: str, parameter: str) -> float:
        """The value of a parameter, in the unit of its element's table."""
        return self._core.get(element, parameter)

    def execute(self, xml: str, folder: str | os.PathLike[str] = ".", name: str = "<string>") -> None:
        """Executes more commands in the running scene: all of them or, if it raises, none."""
        self._core.execute(xml, os.fspath(folder), name)

    @property
    def time_s(self) -> float:
        """Simulated time of the last frame, seconds; NaN before the first."""
        return self._core.time_s

    @property
    def sensors(self) -> dict[str, Sensor]:
        """All sensors, in the order of the scene."""
        return ByName("sensor", {name: Sensor(self._core, name) for name in self._core.sensor_names()})

    def only(self, *sensors: str) -> None:
        """Turns these sensors on and all others off. What is off is not rendered."""
        known = self._core.sensor_names()
        for name in sensors:
            if not isinstance(name, str):
                raise InputError(f"{name!r} is no name, expected names such as only(\"FRONT\", \"REAR\")")
            if name not in known:
                raise UnknownName(f'there is no sensor "{name}"' + suggestion(name, known))
        for name in known:
            self._core.enable(name, name in sensors)

    @property
    def elements(self) -> dict[str, Element]:
        """All elements, in the order of the scene."""
        return ByName("element", {row["name"]: Element(self._core, row) for row in self._core.elements()})

    @property
    def parameters(self) -> Parameters:
        """All parameters, by "ELEMENT.PARAMETER"."""
        return Parameters(self._core)

    @property
    def items(self) -> list[dict[str, Any]]:
        """What beams can meet, by the numbers of `labels`: part, mesh, triangles, and the ids of ground truth."""
        return list(self._core.items())

    @property
    def objects(self) -> list[dict[str, Any]]:
        """Parts, models, links, and the shapes that labels make objects: instance, parent, name, path, kind, class, items."""
        return list(self._core.objects())

    @property
    def measured(self) -> list[str]:
        """Names of the sensors that measured in the last step."""
        return list(self._core.measured())

    @property
    def warnings(self) -> list[str]:
        """What loading and the steps so far warn of."""
        return list(self._core.warnings())

    @property
    def changes(self) -> list[str]:
        """The commands that were executed, in order; together they make the same scene."""
        return list(self._core.changes())

    @property
    def device(self) -> dict[str, str]:
        """The device that renders: name, type, driver, api_version."""
        return dict(self._core.device())

    def part_pose(self, part: str) -> npt.NDArray[np.float64] | None:
        """(4, 4) float64 world_from_part as of the last step; call track_part() before. None: it is switched off."""
        return self._core.part_pose(part)

    def track_part(self, part: str) -> None:
        """Makes part_pose() known for a part from the next step on."""
        self._core.track_part(part)

    def record(self, file: str | os.PathLike[str], topics: Sequence[str] = (), drop: bool = False) -> None:
        """Records the next steps as ROS 2 messages in an MCAP file, until finish_recording()."""
        self._core.record(os.fspath(file), list(topics), drop)

    def finish_recording(self) -> dict[str, int]:
        """Ends the recording: numbers of messages, of dropped measurements, and of bytes."""
        messages, dropped, size = self._core.finish_recording()
        return {"messages": messages, "dropped": dropped, "bytes": size}

    def record_page(self, file: str | os.PathLike[str]) -> None:
        """The frames of the next steps become one HTML file, which a browser opens without a server; see finish_page()."""
        self._core.record_page(os.fspath(file))

    def finish_page(self) -> None:
        """Writes the page that record_page() began."""
        self._core.finish_page()

    def warn(self, text: str) -> None:
        """Adds a warning of the program's own, which recordings and pages show. Raises if the simulation is strict."""
        self._core.warn(text)

    def serve(self, name: str, folders: Sequence[str | os.PathLike[str]] = ()) -> None:
        """Serves the simulation to other processes of this machine, which find it by its name."""
        self._core.serve(name, [os.fspath(folder) for folder in folders])

    def explain(self) -> str:
        """What the last frame rendered and cast, why, and at what cost."""
        return self._core.explain()

    def price(self, *sensors: str, frames: int = 15) -> PriceList:
        """What each measuring method costs on this machine, and how exact it is, for these scanners (default: all)."""
        names = list(sensors) or [row["name"] for row in self._core.sensors() if row["type"] == "laser_scanner"]
        return PriceList(self._core.price(names, frames))

    def __getitem__(self, name: str) -> Any:
        """The element or sensor of this name. Its type depends on the scene; `sim.elements` and `sim.sensors` have types."""
        for row in self._core.elements():
            if row["name"] == name:
                if name in self._core.sensor_names():
                    raise InputError(f'"{name}" is an element and a sensor, expected sim.elements[...] or sim.sensors[...]')
                return Element(self._core, row)
        known = self._core.sensor_names()
        if name in known:
            return Sensor(self._core, name)
        known += self._core.element_names()
        raise UnknownName(f'there is no element or sensor "{name}"' + suggestion(str(name), known))

    def __iter__(self) -> Iterator[str]:
        """The names of all elements and sensors."""
        return iter(self._ipython_key_completions_())

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._core.element_names()) + list(self._core.sensor_names())

    def __repr__(self) -> str:
        if self._core.closed:
            return "a closed simulation"
        return str(self._core.tree())

    def _repr_html_(self) -> str:
        return f"<pre>{escape(repr(self))}</pre>"
