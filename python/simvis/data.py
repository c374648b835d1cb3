"""Frames of a scene as a data set, for training and for statistics.

    from simvis.data import Frames

    def place(random):                                      # parameters of a frame, drawn
        return {"R_POSE.x": random.uniform(-3, 3), "R_POSE.yaw": random.uniform(-180, 180)}

    frames = Frames("scene.xml", 1000, place, ["FRONT.range_m", "CAM.rgb"])
    frames[7]["CAM.rgb"]                                    # (h, w, 3) uint8

PyTorch takes it as it is: torch.utils.data.DataLoader(frames, batch_size=8, num_workers=4, multiprocessing_context="spawn").
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from operator import index
from random import Random
from typing import Any

import numpy as np
import numpy.typing as npt

from ._errors import InputError
from ._simulation import Simulation

__all__ = ["Frames"]


class Frames:
    """Frames of a scene file by their numbers from 0; each is a dict of arrays by "SENSOR.OUTPUT" and "parameters".

    count     number of frames
    draw      function of a random.Random that returns the parameters of a frame, by "ELEMENT.PARAMETER". None: those of the
              scene. It must set the same parameters each time
    outputs   what a frame has, by "SENSOR.OUTPUT": any output of docs/reference.md, "rgb" or "points"
    seed      of what is drawn: frame i has the same parameters whenever and wherever it is made
    settings  as of Simulation.load(). A process uses one thread unless `threads` says otherwise

    Other sensors are off. Each process loads the scene when it makes its first frame; the object pickles without it. Noise of
    sensors is drawn by the simulated time, so it depends on how many frames the process has made before, and all else does
    not.
    """

    def __init__(self, scene: str | os.PathLike[str], count: int, draw: Callable[[Random], Mapping[str, float]] | None,
                 outputs: Iterable[str], *, seed: int = 0, **settings: Any) -> None:
        if count < 0:
            raise InputError(f"count is {count}, expected 0 or more")
        self._scene, self._count, self._draw, self._seed = os.path.abspath(scene), count, draw, seed
        self._settings: dict[str, Any] = {"threads": 1, "seed": seed, **settings}
        self._outputs = [_split(name) for name in outputs]
        if not self._outputs:
            raise InputError('outputs is empty, expected names such as "FRONT.range_m"')
        self._sim: Simulation | None = None

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, number: int) -> dict[str, npt.NDArray[Any]]:
        """A frame, with arrays of its own that can be written to."""
        i = index(number)
        if not -self._count <= i < self._count:
            raise IndexError(f"there is no frame {i} among {self._count}")
        sim = self._simulation()
        drawn = {} if self._draw is None else dict(self._draw(Random(f"{self._seed} {i % self._count}")))
        sim.parameters.update(drawn)
        sim.step()
        frame = {f"{sensor}.{output}": np.array(_read(sim, sensor, output)) for sensor, output in self._outputs}
        return {**frame, "parameters": np.array(list(drawn.values()), np.float64)}

    def __iter__(self) -> Iterator[dict[str, npt.NDArray[Any]]]:
        return (self[i] for i in range(self._count))

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_sim": None}

    def _simulation(self) -> Simulation:
        if self._sim is None:
            self._sim = Simulation.load(self._scene, **self._settings)
            self._sim.only(*(sensor for sensor, _ in self._outputs))
        return self._sim

    def batches(self, size: int) -> Iterator[dict[str, npt.NDArray[Any]]]:
        """So many frames at a time in this process, stacked along a new first axis; the last batch may be smaller."""
        if size < 1:
            raise InputError(f"size is {size}, expected 1 or more")
        for start in range(0, self._count, size):
            frames = [self[i] for i in range(start, min(start + size, self._count))]
            yield {name: np.stack([frame[name] for frame in frames]) for name in frames[0]}

    def close(self) -> None:
        """Ends the simulation of this process. A later frame loads it again."""
        if self._sim is not None:
            self._sim.close()
        self._sim = None


def _split(name: str) -> tuple[str, str]:
    sensor, dot, output = name.rpartition(".")
    if not dot:
        raise InputError(f'"{name}" names no output, expected SENSOR.OUTPUT such as "FRONT.range_m"')
    return sensor, output


def _read(sim: Simulation, name: str, output: str) -> Any:
    sensor = sim.sensors[name]
    if output == "points":
        return sensor.points()
    return sensor.rgb if output == "rgb" else sensor[output]
