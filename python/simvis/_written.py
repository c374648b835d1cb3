"""Elements and sensors that are written in Python."""

from __future__ import annotations

import math
import numbers
import reprlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from . import _core
from ._errors import InputError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from ._core import Context


@dataclass(frozen=True)
class Attribute:
    """A row of a type's table, as <simvis/attributes.h> has it.

    kind is number, integer, choice, vector, text, file, part, object, objects, element or sensor. A live row is a parameter: a
    number with a default that can change while the scene runs.
    """

    name: str
    default: float | int | str | None = None
    unit: str = ""
    text: str = ""
    kind: str = "number"
    min: float = -math.inf
    max: float = math.inf
    choices: str = ""
    live: bool = False

    @property
    def default_text(self) -> str:
        return "" if self.default is None else f"{self.default:.17g}" if isinstance(self.default, float) else str(self.default)


def _checked(attributes: list[Attribute]) -> list[Attribute]:
    for attribute in attributes:
        if not isinstance(attribute, Attribute):
            raise InputError(f"attributes has {attribute!r}, expected rows such as simvis.Attribute(\"width\", 1.0, \"m\")")
    return attributes


def _described(value: Any) -> str:
    """An array by its type and shape, anything else by its type and text."""
    if hasattr(value, "dtype") and hasattr(value, "shape"):
        return f"an array of {value.dtype} of shape {value.shape}"
    return f"{reprlib.repr(value)}, a {type(value).__name__}"


def _named(cls: type[Any], base: str, type_name: str) -> str:
    """The name of a new type, which the line of its class gives."""
    if not isinstance(type_name, str) or not type_name:
        raise InputError(f'class {cls.__name__} has no name for scenes, expected one as in: '
                         f'class {cls.__name__}(simvis.{base}, type="{cls.__name__.lower()}")')
    return type_name


class CustomElement:
    """Base of elements that are written in Python. A scene names them by `type`:

        class Door(simvis.CustomElement, type="door", summary="A door on its hinge."):
            attributes = [simvis.Attribute("open", 0, "%", min=0, max=100, live=True)]

            def __init__(self, context):
                self.hinge = context.insert_transform()   # it moves what follows

            def update(self, values):                    # called when a live value has changed
                self.hinge.set_pose(yaw=0.9 * values["open"])

    update() is called by the step, in the thread that steps; what it raises, the step raises.
    """

    attributes: ClassVar[list[Attribute]] = []

    def __init_subclass__(cls, type: str = "", summary: str = "", **rest: Any) -> None:
        super().__init_subclass__(**rest)
        _core.register_element(cls, _named(cls, "CustomElement", type), summary or f"An element of the Python class {cls.__name__}.",
                               _checked(cls.attributes))

    def __init__(self, context: Context) -> None:
        pass

    def update(self, values: Mapping[str, float]) -> None:
        """Applies the live values to the scene."""
        raise NotImplementedError(f"the class {type(self).__name__} has no update()")


class CustomSensor:
    """Base of sensors that are written in Python: they cast rays, and measure() turns the ranges into numbers.

        class Bumper(simvis.CustomSensor, type="bumper"):
            values = ["nearest_m"]
            directions = [[1, 0, 0], [0, 1, 0], [0, -1, 0]]   # unit vectors: x forward, y left, z up

            def measure(self, ranges_m, time_s):              # (n,) float64, inf where nothing was hit
                return {"nearest_m": ranges_m.min()}
    """

    attributes: ClassVar[list[Attribute]] = []
    values: ClassVar[list[str]] = []
    directions: npt.ArrayLike

    def __init_subclass__(cls, type: str = "", summary: str = "", **rest: Any) -> None:
        super().__init_subclass__(**rest)
        _named(cls, "CustomSensor", type)
        if not isinstance(cls.values, (list, tuple)):
            raise InputError(f'type "{type}": values is no list of names')
        _core.register_sensor(cls, type, summary or f"A sensor of the Python class {cls.__name__}.",
                              _checked(cls.attributes), list(cls.values))

    def __init__(self, context: Context) -> None:
        pass

    def measure(self, ranges_m: npt.NDArray[np.float64], time_s: float) -> Mapping[str, float]:
        """The value of each name in `values`."""
        raise NotImplementedError(f"the class {type(self).__name__} has no measure()")

    def _measured(self, sensor: str, names: list[str], ranges_m: npt.NDArray[np.float64], time_s: float) -> list[float]:
        measured = self.measure(ranges_m, time_s)
        if not isinstance(measured, Mapping) or not measured.keys() >= set(names):
            raise InputError(f'sensor "{sensor}": {type(self).__name__}.measure() returned {reprlib.repr(measured)}, '
                             "expected a number for each of " + ", ".join(names))
        for name in names:
            if not isinstance(measured[name], numbers.Real):
                raise InputError(f'sensor "{sensor}": output "{name}": {type(self).__name__}.measure() gave '
                                 f"{_described(measured[name])}, expected one number, f64")
        return [float(measured[name]) for name in names]
