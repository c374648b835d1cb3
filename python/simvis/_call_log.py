"""The calls that decide about a run, so that another simulation can repeat it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ._core import Core

_DECIDING = frozenset(("enable", "execute", "finish", "set", "set_pose", "skip_frame", "step", "step_async", "track_part"))


class CallLog:
    """Stands between a Simulation and its Core, and keeps the calls that succeeded."""

    def __init__(self, core: Core) -> None:
        self._core = core
        self.calls: list[tuple[str, tuple[Any, ...]]] = []
        self.frames: list[tuple[int, float]] = []  #: the call that began each frame, and the frame's time in seconds

    def __getattr__(self, name: str) -> Any:
        member = getattr(self._core, name)
        return self._keep(name, member) if name in _DECIDING else member

    def _keep(self, name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def kept(*arguments: Any) -> Any:
            # An array that the caller changes later must not change the log.
            fixed = tuple(each.copy() if hasattr(each, "copy") else each for each in arguments)
            next_s = self._core.next_frame()[1] / 1e9 if name == "step_async" else 0.0
            result = call(*arguments)
            if name in ("step", "step_async"):
                self.frames.append((len(self.calls), self._core.time_s if name == "step" else next_s))
            self.calls.append((name, fixed))
            return result

        return kept

    def repeat(self, core: Core, before_frame: Callable[[int], None]) -> None:
        """Makes the calls again. `before_frame(i)` is called before call `i` if that begins a frame."""
        frames = {call for call, _ in self.frames}
        for i, (name, arguments) in enumerate(self.calls):
            if i in frames:
                before_frame(i)
            getattr(core, name)(*arguments)
