"""Loading of a simulation. tools/python_settings makes this file from the table of settings (program/options/settings.cpp)."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from ._core import Core, Settings, VectorCore
from ._mistakes import checked_keywords
from ._scenes import scene_file, scene_text

if TYPE_CHECKING:
    from typing_extensions import Self  # typing has it since Python 3.11; type checkers know both


class Loading(Core):
    """The constructors of Simulation."""

    @classmethod
    @checked_keywords
    def load(cls, scene: str | os.PathLike[str], *, rate_hz: float | None = 15.0, seed: int = 0, threads: int = 0,
             device: str = "", strict: bool = False, sensors: Sequence[str] | None = None,
             overrides: Mapping[str, str | None] | None = None,
             packages: Mapping[str, str | os.PathLike[str]] | None = None, instrumented: bool = False,
             cache_dir: str = "", progress: Callable[[str, int, int], None] | None = None) -> Self:
        """Loads a scene file.

        rate_hz       frames per simulated second; None: a frame exactly when a sensor is due
        seed          seed of all random numbers
        threads       number of threads on which SimVis casts rays, culls views and prepares meshes, up to 1024; 0: one
                      for each core. Results do not depend on the number. The Vulkan driver has threads of its own
        device        the Vulkan device: part of its name, its index, or bundled for that of the driver that SimVis was
                      built with; without it the best device
        strict        warnings are errors
        sensors       names of the sensors that are on at first; what only others need is not loaded; without it all are
                      on
        overrides     attributes of all sensors of a type, such as {"laser_scanner.method": "planar"}; None removes one
        packages      folders of ROS packages or Gazebo models that parts name, searched first
        instrumented  measure times on the device; no result depends on it
        cache_dir     folder of caches; without it $XDG_CACHE_HOME/simvis or ~/.cache/simvis
        progress      called with the work, what is done and all that there is, while parts are read
        """
        settings = Settings(rate_hz=rate_hz, seed=seed, threads=threads, device=device, strict=strict, sensors=sensors,
                            overrides=overrides, packages=packages, instrumented=instrumented, cache_dir=cache_dir,
                            progress=progress)
        return cls(settings, scene=scene_file(scene))

    @classmethod
    @checked_keywords
    def from_string(cls, xml: str, *, folder: str | os.PathLike[str] = ".", name: str = "<string>",
                    rate_hz: float | None = 15.0, seed: int = 0, threads: int = 0, device: str = "",
                    strict: bool = False, sensors: Sequence[str] | None = None,
                    overrides: Mapping[str, str | None] | None = None,
                    packages: Mapping[str, str | os.PathLike[str]] | None = None, instrumented: bool = False,
                    cache_dir: str = "", progress: Callable[[str, int, int], None] | None = None) -> Self:
        """Loads a scene from text, as load() does. File names in it start at `folder`; `name` stands in messages."""
        settings = Settings(rate_hz=rate_hz, seed=seed, threads=threads, device=device, strict=strict, sensors=sensors,
                            overrides=overrides, packages=packages, instrumented=instrumented, cache_dir=cache_dir,
                            progress=progress)
        return cls(settings, xml=scene_text(xml), folder=folder, name=name)


class VectorLoading(VectorCore):
    """The constructors of VectorSimulation."""

    @classmethod
    @checked_keywords
    def load(cls, scene: str | os.PathLike[str], environments: int, *, rate_hz: float | None = 15.0, seed: int = 0,
             threads: int = 0, device: str = "", strict: bool = False, sensors: Sequence[str] | None = None,
             overrides: Mapping[str, str | None] | None = None,
             packages: Mapping[str, str | os.PathLike[str]] | None = None, instrumented: bool = False,
             cache_dir: str = "", progress: Callable[[str, int, int], None] | None = None) -> Self:
        """Loads a scene file so many times. Settings are those of Simulation.load(); environment i has the seed `seed` + i."""
        settings = Settings(rate_hz=rate_hz, seed=seed, threads=threads, device=device, strict=strict, sensors=sensors,
                            overrides=overrides, packages=packages, instrumented=instrumented, cache_dir=cache_dir,
                            progress=progress)
        return cls(environments, settings, scene=scene_file(scene))

    @classmethod
    @checked_keywords
    def from_string(cls, xml: str, environments: int, *, folder: str | os.PathLike[str] = ".", name: str = "<string>",
                    rate_hz: float | None = 15.0, seed: int = 0, threads: int = 0, device: str = "",
                    strict: bool = False, sensors: Sequence[str] | None = None,
                    overrides: Mapping[str, str | None] | None = None,
                    packages: Mapping[str, str | os.PathLike[str]] | None = None, instrumented: bool = False,
                    cache_dir: str = "", progress: Callable[[str, int, int], None] | None = None) -> Self:
        """Loads a scene from text, as load() does. File names in it start at `folder`; `name` stands in messages."""
        settings = Settings(rate_hz=rate_hz, seed=seed, threads=threads, device=device, strict=strict, sensors=sensors,
                            overrides=overrides, packages=packages, instrumented=instrumented, cache_dir=cache_dir,
                            progress=progress)
        return cls(environments, settings, xml=scene_text(xml), folder=folder, name=name)
