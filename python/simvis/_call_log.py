"""The calls that decide about a run, so that another simulation can repeat it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ._simulation import Simulation

_DECIDING = (
    "_enable",
    "_set_pose",
    "execute",
    "finish",
    "restore_state",
    "set",
    "skip_frame",
    "step",
    "step_async",
    "track_part",
)


class CallLog:
    """Keeps the calls to a simulation that succeeded, in place of whose methods it stands."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self.calls: list[tuple[str, tuple[Any, ...], dict[str, Any]]] = []
        self.frames: list[tuple[int, float]] = []  #: the call that began each frame, and the frame's time in seconds
        for name in _DECIDING:
            setattr(simulation, name, self._keep(name, getattr(simulation, name)))

    def _keep(self, name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def kept(*arguments: Any, **named: Any) -> Any:
            # An array that the caller changes later must not change the log.
            fixed = tuple(each.copy() if hasattr(each, "copy") else each for each in arguments)
            next_s = self._simulation._next_frame()[1] / 1e9 if name == "step_async" else 0.0
            result = call(*arguments, **named)
            if name in ("step", "step_async"):
                self.frames.append((len(self.calls), self._simulation.time_s if name == "step" else next_s))
            self.calls.append((name, fixed, named))
            return result

        return kept

    def repeat(self, simulation: Simulation, before_frame: Callable[[int], None]) -> None:
        """Makes the calls again. `before_frame(i)` is called before call `i` if that begins a frame."""
        frames = {call for call, _ in self.frames}
        for i, (name, arguments, named) in enumerate(self.calls):
            if i in frames:
                before_frame(i)
            getattr(simulation, name)(*arguments, **named)
