"""Elements and sensors of a running simulation."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from html import escape
from typing import TYPE_CHECKING, Any

from ._core import Image, Measurement, Scan
from ._errors import InputError, UnknownName
from ._mistakes import suggestion
from ._outputs import Outputs

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from ._core import Core

Array = Any
_LINES, _COLUMNS = 30, 100  # of a screen


class ByName(dict[str, Any]):
    """Elements or sensors by name. A name that is not there raises UnknownName."""

    def __init__(self, kind: str, named: dict[str, Any]) -> None:
        super().__init__(named)
        self._kind = kind

    def __missing__(self, name: str) -> Any:
        raise UnknownName(f'there is no {self._kind} "{name}"' + suggestion(name, self))

    def __str__(self) -> str:
        return text_table(f"{len(self)} {self._kind}s", [(name, each.type) for name, each in self.items()])

    def __repr__(self) -> str:
        return fitted(str(self))


class Element:
    """An element of a scene: its parameters are attributes, in the units of its table.

    A new value takes effect at the next step.
    """

    __slots__ = ("_core", "_name", "_parameters", "_type")
    _core: Core
    _name: str
    _type: str
    _parameters: dict[str, dict[str, Any]]

    def __init__(self, core: Core, described: dict[str, Any]) -> None:
        object.__setattr__(self, "_core", core)
        object.__setattr__(self, "_name", described["name"])
        object.__setattr__(self, "_type", described["type"])
        object.__setattr__(self, "_parameters", {row["name"]: row for row in described["parameters"]})

    @property
    def name(self) -> str:
        return self._name

    @property
    def type(self) -> str:
        return self._type

    def _check(self, parameter: str) -> None:
        if parameter not in self._parameters:
            raise UnknownName(f'element "{self._name}" has no parameter "{parameter}"'
                              + suggestion(parameter, self._parameters))

    def __getattr__(self, parameter: str) -> float:
        if parameter.startswith("__"):
            raise AttributeError(parameter)
        self._check(parameter)
        return self._core.get(self._name, parameter)

    def __setattr__(self, parameter: str, value: float) -> None:
        self._check(parameter)
        self._core.set(self._name, parameter, value)

    def set(self, **values: float) -> None:
        """Sets several parameters. An unknown name or a value that is refused leaves those before it set."""
        for parameter, value in values.items():
            setattr(self, parameter, value)

    def set_pose(self, matrix: npt.ArrayLike) -> None:
        """Sets all parameters of an element of type pose from a rigid (4, 4) matrix parent_from_child."""
        import numpy as np

        rows = np.ascontiguousarray(matrix, np.float64)
        if rows.shape != (4, 4):
            raise InputError(f"the matrix has shape {rows.shape}, expected (4, 4)")
        self._core._set_pose(self._name, rows)

    def __iter__(self) -> Iterator[str]:
        return iter(self._parameters)

    def __len__(self) -> int:
        return len(self._parameters)

    def __getitem__(self, parameter: str) -> float:
        return self.__getattr__(parameter)

    def __setitem__(self, parameter: str, value: float) -> None:
        setattr(self, parameter, value)

    def __dir__(self) -> list[str]:
        return [*self._parameters, "name", "type", "set", "set_pose"]

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._parameters)

    def _rows(self) -> list[tuple[str, str, str, str]]:
        rows = []
        for name, row in self._parameters.items():
            limits = "" if row["min"] <= -1e15 and row["max"] >= 1e15 else f'{row["min"]:g} .. {row["max"]:g}'
            rows.append((name, f"{self._core.get(self._name, name):g} {row['unit']}".rstrip(), limits, row["text"]))
        return rows

    def __str__(self) -> str:
        return text_table(f'{self._type} "{self._name}"', self._rows())

    def __repr__(self) -> str:
        return fitted(str(self))

    def _repr_html_(self) -> str:
        return html_table(f'{self._type} "{self._name}"', self._rows())


class Sensor(Outputs):
    """A sensor of a scene, and what it measured last."""

    __slots__ = ("_core", "_name")

    def __init__(self, core: Core, name: str) -> None:
        self._core = core
        self._name = name

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in ("_core", "_name", "enabled"):
            raise UnknownName(f'"{name}" of sensor "{self._name}" cannot be set; expected it in the scene, or '
                              f'overrides={{"{self.type}.{name}": "{value}"}} of Simulation.load()')
        object.__setattr__(self, name, value)

    @property
    def name(self) -> str:
        return self._name

    def _info(self) -> dict[str, Any]:
        for row in self._core._sensors():
            if row["name"] == self._name:
                return dict(row)
        raise UnknownName(f'there is no sensor "{self._name}" any more')

    @property
    def type(self) -> str:
        return str(self._info()["type"])

    @property
    def frames(self) -> int:
        """Number of measurements so far."""
        return int(self._info()["frames"])

    @property
    def enabled(self) -> bool:
        """Whether it measures. A sensor that is off is not rendered."""
        return bool(self._info()["enabled"])

    @enabled.setter
    def enabled(self, on: bool) -> None:
        self._core._enable(self._name, on)

    @property
    def attributes(self) -> dict[str, str]:
        """The attributes of its command, as executed."""
        return dict(self._core._attributes(self._name))

    @property
    def scan(self) -> Scan:
        """The last scan, which keeps its frame."""
        return self._core._scan(self._name)

    @property
    def measurement(self) -> Measurement:
        """All outputs of the last measurement, by name; it keeps its frame."""
        return self._core._measurement(self._name)

    def __getitem__(self, output: str) -> Any:
        """An output of the last measurement: a number, or a read-only view. docs/reference.md lists those of each type."""
        measured = self._core._measurement(self._name)
        try:
            return measured[output]
        except KeyError:
            known = measured.keys()
        raise UnknownName(f'sensor "{self._name}", a {self.type}, has no output "{output}"'
                          + (suggestion(output, known) or ", expected one of " + ", ".join(known)))

    if not TYPE_CHECKING:  # a type checker knows the outputs of Outputs
        def __getattr__(self, output: str) -> Any:
            """Outputs are attributes too, if their names can be."""
            if output.startswith("_"):
                raise AttributeError(output)
            return self[output]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._output_names()]

    def _output_names(self) -> list[str]:
        try:
            return list(self._core._measurement(self._name).keys())
        except InputError:
            return []

    def _ipython_key_completions_(self) -> list[str]:
        return self._output_names()

    @property
    def labels(self) -> npt.NDArray[np.int32]:
        """(rings, beams) int32 of a scanner with truth="hit": places in sim.items, -1: nothing. Computed with each call."""
        return self._core._scan(self._name).labels

    def points(self, frame: str = "sensor", out: Array = None) -> npt.NDArray[np.float64]:
        """(rings * beams, 3) float64, metres: what the beams hit, NaN where nothing was hit, in "sensor" or "world".

        Of a camera with depth (h * w, 3): what its pixels see, of a stereo camera those of its left one.
        """
        return self._core._points(self._name, frame, out)

    @property
    def images(self) -> list[str]:
        """Names of the images that it takes."""
        return list(self._core._images(self._name))

    def image(self, name: str = "color") -> Image:
        """One of `images`, which keeps its frame."""
        return self._core._image(self._name, name)

    @property
    def color(self) -> npt.NDArray[np.float32]:
        """(h, w, 3) float32, linear radiance, rows from the top; of a stereo camera that of its left camera.

        Contiguous and read-only. Computed with each call.
        """
        return self._core._image(self._name, "color").array

    @property
    def rgb(self) -> npt.NDArray[np.uint8]:
        """(h, w, 3) uint8, sRGB, rows from the top. Computed with each call."""
        return self._core._image(self._name, "color").rgb()

    @property
    def depth(self) -> npt.NDArray[np.float32]:
        """(h, w) float32, metres along the optical axis, inf where nothing is hit; of a stereo camera that of its left one. A read-only view."""
        return self._core._image(self._name, "depth").array

    @property
    def pose(self) -> npt.NDArray[np.float64] | None:
        """(4, 4) float64 world_from_sensor as of the last step. None: it stands in a part that is switched off."""
        return self._core._sensor_pose(self._name)

    def value(self, name: str) -> float:
        """One of its single numbers, by the name in its table: "voltage_v"."""
        return self._core._value(self._name, name)

    @property
    def reading(self) -> npt.NDArray[np.void]:
        """(rows,) with a float64 field for each column of its table: sim["IMU"].reading["specific_force_z_m_s2"]. NaN: no value.

        Of sensors that give neither images nor scans. Mostly one row; none before the first measurement. A copy.
        """
        names, rows = self._core._reading(self._name)
        return rows.view([(name, "f8") for name in names]).reshape(len(rows))

    @property
    def units(self) -> dict[str, str]:
        """The unit of each output; "": none."""
        return dict(self._core._measurement(self._name).units)

    def _rows(self) -> list[tuple[str, str]]:
        info = self._info()
        rate = f'{info["rate_hz"]:g} Hz' if info["rate_hz"] else "every frame"
        rows = [("method", info["method"]), ("rate", rate), ("measurements", str(info["frames"]))]
        if not info["enabled"]:
            rows.append(("off", "it does not measure"))
        hidden = {"type", "name"}
        rows += [(name, value) for name, value in self.attributes.items() if name not in hidden]
        return rows

    def __str__(self) -> str:
        return text_table(f'{self.type} "{self._name}"', self._rows())

    def __repr__(self) -> str:
        return fitted(str(self))

    def _repr_html_(self) -> str:
        return html_table(f'{self.type} "{self._name}"', self._rows())


class Parameters(MutableMapping[str, float]):
    """All parameters of a scene, by "ELEMENT.PARAMETER"."""

    def __init__(self, core: Core) -> None:
        self._core = core

    def _names(self) -> list[str]:
        return [f'{element["name"]}.{row["name"]}' for element in self._core._elements() for row in element["parameters"]]

    def _split(self, name: str) -> tuple[str, str]:
        element, dot, parameter = name.rpartition(".")
        if not dot:
            raise UnknownName(f'"{name}" names no parameter, expected ELEMENT.PARAMETER'
                              + suggestion(name, self._names()))
        return element, parameter

    def __getitem__(self, name: str) -> float:
        try:
            return self._core.get(*self._split(name))
        except InputError as error:
            if name in self._names():  # of a closed simulation this raises
                raise
            raise UnknownName(str(error)) from None

    def __setitem__(self, name: str, value: float) -> None:
        self._core.set(*self._split(name), value)

    def __delitem__(self, name: str) -> None:
        raise InputError("a parameter cannot be removed; sim.execute('<remove name=\"ELEMENT\"/>') removes an element")

    def __iter__(self) -> Iterator[str]:
        return iter(self._names())

    def __len__(self) -> int:
        return len(self._names())

    def __contains__(self, name: object) -> bool:
        return name in self._names()

    def _ipython_key_completions_(self) -> list[str]:
        return self._names()

    def __str__(self) -> str:
        return text_table("parameters", [(name, f"{value:g}") for name, value in self.items()])

    def __repr__(self) -> str:
        return fitted(str(self))


def text_table(title: str, rows: list[Any]) -> str:
    columns = range(max((len(row) for row in rows), default=0))
    widths = [max(len(row[i]) for row in rows) for i in columns]
    lines = [title]
    lines += ["  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in rows]
    return "\n".join(lines)


def fitted(text: str) -> str:
    """A text as far as a screen shows it: what repr() gives where print() gives all."""
    lines = [line if len(line) <= _COLUMNS else line[:_COLUMNS - 3] + "..." for line in text.split("\n")]
    if len(lines) > _LINES:
        lines[_LINES - 1:] = [f"... and {len(lines) - _LINES + 1} lines more, which print() shows"]
    return "\n".join(lines)


def html_table(title: str, rows: list[Any]) -> str:
    cells = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><caption>{escape(title)}</caption>{cells}</table>"
