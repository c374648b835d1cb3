"""SimVis: a headless simulator of a robot's sensors.

    import simvis
    sim = simvis.Simulation.load(simvis.scene("marvin"))
    sim["R_POSE"].yaw = 90
    sim.step()
    ranges = sim["FRONT_SCANNER"].range_m      # (rings, beams), metres
    picture = sim["ROBOT_CAM"].rgb             # (h, w, 3) uint8

Arrays are read-only views that keep their frame: they neither move nor change when the simulation goes on.
"""

from __future__ import annotations

from . import _core, _ending, _plots, _usd  # noqa: F401
from ._core import Context, Image, Measurement, Scan, Transform, list_devices, load_plugin
from ._errors import Error, InputError, MachineError, UnknownName
from ._map import map
from ._price import PriceList
from ._proxies import Element, Parameters, Sensor
from ._scenes import scene
from ._simulation import Simulation
from ._trajectory import Trajectory
from ._vector import VectorSimulation
from ._viewer import Viewer, viewer
from ._written import Attribute, CustomElement, CustomSensor

__version__ = _core.version()
__all__ = [
    "Attribute", "Context", "CustomElement", "CustomSensor", "Element", "Error", "Image", "InputError", "MachineError",
    "Measurement", "Parameters", "PriceList", "Scan", "Sensor", "Simulation", "Trajectory", "Transform", "UnknownName",
    "VectorSimulation", "Viewer", "list_devices", "load_plugin", "map", "scene", "viewer",
]

_usd.read_by_this_python()
Scan._repr_png_ = _plots.scan_png  # type: ignore[attr-defined]
Scan.__repr__ = _plots.scan_text  # type: ignore[method-assign, assignment]
Image._repr_png_ = _plots.image_png  # type: ignore[attr-defined]
Image.__repr__ = _plots.image_text  # type: ignore[method-assign, assignment]

