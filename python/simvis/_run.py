"""A run of a scene under test, and the evidence that it leaves where it fails."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from math import inf
from pathlib import Path
from types import TracebackType
from typing import ClassVar
from urllib.parse import quote

from ._call_log import CallLog
from ._errors import InputError
from ._simulation import Simulation
from ._verdict import Verdict

Check = Callable[[Simulation], "Verdict | bool"]


@dataclass(frozen=True)
class Evidence:
    """The files of a failure."""

    page: Path  #: one HTML file, which a browser opens without a server
    link: str  #: the page at the frame that failed
    recording: Path  #: the same frames as ROS 2 messages in an MCAP file
    text: str  #: what failed and when, and how the files relate to the run


class Run:
    """A simulation that a test steps to a limit in simulated seconds: simvis.testing.run() makes one.

    `for sim in run` makes one frame after the other and leaves each to the body of the loop: controllers set values
    there for the next frame. What always() was given is checked after each frame.
    """

    _keep_failed: ClassVar[Callable[[Run], None] | None] = None  #: takes runs whose `with` ends by an exception, and ends them

    def __init__(self, load: Callable[[], Simulation], limit_s: float, evidence_s: float = 10.0) -> None:
        if not 0 < limit_s < inf:
            raise InputError(f"limit_s is {limit_s!r}, expected simulated seconds above 0")
        if not 0 < evidence_s <= inf:
            raise InputError(f"evidence_s is {evidence_s!r}, expected simulated seconds above 0")
        self._load = load
        self._limit_s = limit_s
        self._evidence_s = evidence_s
        self._checks: list[tuple[Check, str]] = []
        self._frame = -1
        self.failure: str | None = None  #: of a check; None: none has failed
        self._select = ""  # what the page selects
        self.sim: Simulation = load()
        self._log = CallLog(self.sim)

    def always(self, check: Check, name: str = "") -> None:
        """Checks a property after each frame from now on: a function of the simulation that returns a Verdict or a bool."""
        self._checks.append((check, name))

    def step(self) -> bool:
        """Makes one frame and checks what always() was given; false, and no frame, where the limit is reached.

        Raises AssertionError with the time, the frame and the verdict if a property does not hold.
        """
        index, time_ns = self.sim._next_frame()
        if time_ns / 1e9 > self._limit_s:
            return False
        self.sim.step()
        self._frame = index
        for check, name in self._checks:
            verdict = check(self.sim)
            if not verdict:
                self._fail(verdict, name)
        return True

    def __iter__(self) -> Iterator[Simulation]:
        while self.step():
            yield self.sim

    def until(self, check: Check, act: Callable[[Simulation], object] | None = None, name: str = "") -> None:
        """Makes frames until a condition holds; `act(sim)` is called after each of them where it does not hold yet.

        Raises AssertionError with the last verdict if the limit is reached before.
        """
        verdict: Verdict | bool = Verdict(False, "no frame was made")
        while self.step():
            verdict = check(self.sim)
            if verdict:
                return
            if act is not None:
                act(self.sim)
        self._fail(verdict, name, f" when the limit of {self._limit_s:g} s is reached")

    def _fail(self, verdict: Verdict | bool, name: str, when: str = "") -> None:
        what = verdict.text if isinstance(verdict, Verdict) else "the condition does not hold"
        named = f"{name}: " if name else ""
        self._select = verdict.select if isinstance(verdict, Verdict) else ""
        self.failure = f"at {self.sim.time_s:.9g} s, frame {self._frame}{when}: {named}{what}"
        raise AssertionError(self.failure)

    def write_evidence(self, folder: str | os.PathLike[str], text: str) -> Evidence:
        """Makes the run again and writes its last frames, to the last one that was made, into a folder.

        The run is repeated from the calls that changed it, so passing tests pay nothing for it. `text` says what failed;
        the page shows it among its warnings. The evidence says if the repeated run measured something else, as it does
        where an element in Python depends on what was before.
        """
        if not self._log.frames:
            raise InputError("no frame was made, so there is nothing to show")
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        page, recording = target / "failure.html", target / "failure.mcap"
        last, end_s = self._log.frames[-1]
        first = next(call for call, time_s in self._log.frames if time_s >= end_s - self._evidence_s)
        with self._load() as again:

            def before_frame(call: int) -> None:
                if call == first:
                    again.record_page(page)
                    again.record(recording)
                if call == last:
                    with suppress(InputError):  # a strict simulation takes no warning
                        again.warn(text)

            self._log.repeat(again, before_frame)
            again.finish()
            again.finish_page()
            again.finish_recording()
            different = _difference(self.sim, again)
        notes = [text]
        if first != self._log.frames[0][0]:
            notes.append(f"The files have the last {self._evidence_s:g} s of the run.")
        if different:
            notes.append(f"The repeated run measured something else: {different}.")
        shown = sum(call >= first for call, _ in self._log.frames) - 1
        link = f"{page.resolve().as_uri()}#frame={shown}" + (f"&select={quote(self._select, safe=':')}" if self._select else "")
        return Evidence(page, link, recording, "\n".join(notes))

    def close(self) -> None:
        """Ends the simulation."""
        self.sim.close()

    def __enter__(self) -> Run:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if error is not None and Run._keep_failed is not None:
            Run._keep_failed(self)
        else:
            self.close()


def _difference(one: Simulation, other: Simulation) -> str:
    """The first output that two simulations measured differently; "": none."""
    import numpy as np

    one.finish()
    for name in one.sensors:
        try:
            first, second = one.sensors[name].measurement, other.sensors[name].measurement
        except InputError:  # it has not measured
            continue
        for output in first.keys():
            if not np.array_equal(np.asarray(first[output]), np.asarray(second[output]), equal_nan=True):
                return f"{name}.{output}"
    return ""
