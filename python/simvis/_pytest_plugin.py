"""The pytest plug-in: the fixtures simvis_run and simvis_seed, and evidence of what fails."""

from __future__ import annotations

import json
import os
import re
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from .testing import Run

_RUNS = pytest.StashKey[list[Any]]()  # of the fixture
_KEPT = pytest.StashKey[Any]()        # the last one of a `with` that failed


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("simvis", "tests of robot software with SimVis")
    group.addoption("--simvis-evidence", metavar="DIR", default="simvis-evidence",
                    help="folder of pages and recordings of tests that fail; none: write none (default: %(default)s)")
    group.addoption("--simvis-again", metavar="FILE",
                    help="run only the test of this failure.json, with the same seed, as the message of a failure says")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "simvis_seeds(n): runs the test with simvis_seed from 0 to n - 1")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "simvis_seed" not in metafunc.fixturenames:
        return
    marker = metafunc.definition.get_closest_marker("simvis_seeds")
    count = marker.args[0] if marker and marker.args else 1
    metafunc.parametrize("simvis_seed", range(count), ids=lambda seed: f"seed{seed}")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    file = config.getoption("--simvis-again")
    if file is None:
        return
    try:
        test = json.loads(Path(file).read_text())["test"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise pytest.UsageError(f"--simvis-again: {file} is no failure.json of a test: {error}") from None
    kept = [item for item in items if item.nodeid == test]
    if not kept:
        raise pytest.UsageError(f"--simvis-again: there is no test {test} among those that were collected")
    config.hook.pytest_deselected(items=[item for item in items if item.nodeid != test])
    items[:] = kept


@pytest.fixture
def simvis_run(request: pytest.FixtureRequest) -> Iterator[Callable[..., Run]]:
    """Makes runs, as simvis.testing.run() does, and ends them after the test; their evidence belongs to the test."""
    from . import testing

    runs: list[Run] = []
    request.node.stash[_RUNS] = runs

    def make(scene: str | os.PathLike[str], *, limit_s: float, evidence_s: float = 10.0, **settings: Any) -> Run:
        beside = request.path.parent / scene
        runs.append(testing.run(beside if beside.exists() else scene, limit_s=limit_s, evidence_s=evidence_s, **settings))
        return runs[-1]

    yield make
    for run in runs:
        run.close()


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """Keeps the last run of `with simvis.testing.run(...)` that failed: of Hypothesis that is the smallest example."""
    if "simvis" not in sys.modules:
        yield
        return
    from .testing import Run

    def keep(run: Run) -> None:
        _end_kept(item)
        item.stash[_KEPT] = run

    Run._keep_failed = keep
    yield
    Run._keep_failed = None


def _end_kept(item: pytest.Item) -> None:
    kept = item.stash.get(_KEPT, None)
    if kept is not None:
        kept.close()
        del item.stash[_KEPT]


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    outcome = yield
    report = outcome.get_result()  # type: ignore[attr-defined]
    if call.when != "call":
        return
    root = str(item.config.getoption("--simvis-evidence"))
    if report.failed and call.excinfo is not None and root != "none":
        runs = item.stash.get(_RUNS, []) + [run for run in [item.stash.get(_KEPT, None)] if run is not None]
        folder = item.config.rootpath / root / re.sub(r"[^A-Za-z0-9._-]+", "_", item.nodeid)
        for i, run in enumerate(runs):
            place = folder if len(runs) == 1 else folder / str(i)
            text = _write(item, run, place, str(call.excinfo.value).splitlines() or ["the test failed"])
            report.sections.append(("simvis", text))
            item.user_properties.append(("simvis_evidence", str(place)))
        report.user_properties = item.user_properties
    _end_kept(item)


def _write(item: pytest.Item, run: Run, folder: Path, lines: list[str]) -> str:
    from ._errors import Error

    try:
        evidence = run.write_evidence(folder, run.failure or f"at {run.sim.time_s:.9g} s: {lines[0]}")
        (folder / "failure.json").write_text(json.dumps({"test": item.nodeid, "failure": evidence.text}, indent=1) + "\n")
    except (Error, OSError) as error:
        return f"no evidence of the failure: {error}"
    again = shlex.join(["pytest", item.nodeid.split("::")[0], "--simvis-again", str(folder / "failure.json")])
    return (f"{evidence.text}\npage:      {evidence.link}\nrecording: {evidence.recording}\n"
            f"again:     cd {shlex.quote(str(item.config.rootpath))} && {again}")
