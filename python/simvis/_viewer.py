"""The live page of a simulation."""

from __future__ import annotations

from html import escape

from ._core import Core
from ._errors import InputError
from ._simulation import Simulation


class Viewer:
    """The live page of a simulation: each frame that is made appears there. A notebook shows a link to it.

    What the page sets and executes takes effect before the next frame. It ends with close() or with the simulation.
    """

    def __init__(self, simulation: Simulation, port: int) -> None:
        self._core: Core = simulation
        #: The link to the page. It has a token. Anyone who has it may look at and change the simulation.
        self.url: str = self._core._open_window(port)

    def update(self, seconds: float = 0.0) -> None:
        """Shows the last frame and carries out what the page asks for, for so long. For times without steps."""
        self._core._update_window(seconds)

    def close(self) -> None:
        """Ends the page."""
        self._core._close_window()

    def __repr__(self) -> str:
        return f"live page: {self.url}"

    def _repr_html_(self) -> str:
        return f'<a href="{escape(self.url)}" target="_blank" rel="noopener noreferrer">live page</a>'


def viewer(simulation: Simulation, port: int = 0) -> Viewer:
    """Opens the live page of a simulation on this machine; port 0: any that is free. `url` of the result is its address."""
    if not isinstance(simulation, Simulation):
        raise InputError(f"simulation is {simulation!r}, expected a Simulation")
    if not 0 <= port < 65536:
        raise InputError(f"port is {port}, expected 0 to 65535")
    return Viewer(simulation, port)
