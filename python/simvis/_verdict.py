"""What a matcher says of a measurement, in words that a failing test prints."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Verdict:
    """The result of a matcher: true or false, and why. `assert range_near(...)` prints it when it is false."""

    ok: bool
    text: str  #: what was measured, what was expected, and by how much they differ
    select: str = ""  #: what a page of the run selects, as in its link: beam:SENSOR:BEAM; "": nothing

    def __bool__(self) -> bool:
        return self.ok

    def __repr__(self) -> str:
        return self.text
