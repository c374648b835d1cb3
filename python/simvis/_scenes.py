"""The scenes that the package has, and the files of others."""

from __future__ import annotations

import os
import reprlib
from pathlib import Path

from ._errors import InputError

_FOLDER = Path(__file__).parent / "scenes"


def _known() -> list[str]:
    return sorted(entry.stem for entry in _FOLDER.glob("*/*.xml") if entry.stem == entry.parent.name)


def scene(name: str) -> str:
    """The file of a scene that the package has: "marvin" or "arm"."""
    if name not in _known():
        raise InputError(f'there is no scene "{name}" in the package, expected one of {", ".join(_known()) or "none"}')
    return os.fspath(_FOLDER / name / f"{name}.xml")


def scene_file(scene: str | os.PathLike[str]) -> str:
    """The name of a scene file; refuses that of a scene of the package where there is no such file."""
    path = os.fsdecode(scene)
    if path in _known() and not os.path.exists(path):
        raise InputError(f'there is no file "{path}", did you mean simvis.scene("{path}")?')
    return path


def scene_text(xml: str) -> str:
    """The text of a scene; refuses the name of a file."""
    if isinstance(xml, (str, os.PathLike)) and "<" not in (text := os.fspath(xml)) and text.strip():
        raise InputError(f"{reprlib.repr(text)} has no commands of a scene, did you mean Simulation.load({reprlib.repr(text)})?")
    return xml
