"""Tests of robot software against a scene: a run with a limit, matchers that use error bounds, evidence of a failure.

    import simvis.testing as testing

    def test_keeps_its_distance(simvis_run):                       # a fixture of the pytest plug-in
        run = simvis_run("room.xml", limit_s=20)
        run.always(lambda sim: testing.clear_of(sim["FRONT"], 0.3))
        for sim in run:
            controller.act(sim)

A failing test leaves a page and a recording of its last seconds. docs/testing.md says more.
"""

from __future__ import annotations

import os
from typing import Any

from ._matchers import (clear_of, depths_near, near_path, no_contact, pictures_near, pose_near, range_near, scans_near)
from ._run import Evidence, Run
from ._simulation import Simulation
from ._verdict import Verdict

__all__ = [
    "Evidence", "Run", "Verdict", "clear_of", "depths_near", "near_path", "no_contact", "pictures_near", "pose_near",
    "range_near", "run", "scans_near",
]


def run(scene: str | os.PathLike[str], *, limit_s: float, evidence_s: float = 10.0, **settings: Any) -> Run:
    """Loads a scene file for a test.

    limit_s     simulated seconds after which the run ends
    evidence_s  simulated seconds before a failure that its page and recording show
    settings    as of Simulation.load(), such as seed and rate_hz
    """
    path = os.path.abspath(scene)
    return Run(lambda: Simulation.load(path, **settings), limit_s, evidence_s)
