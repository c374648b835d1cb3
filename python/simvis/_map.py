"""Many simulations of one scene, in processes of their own."""

from __future__ import annotations

import os
import pickle
import reprlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from importlib import import_module
from typing import Any, TypeVar

from ._errors import InputError
from ._simulation import Simulation

Result = TypeVar("Result")


def _one(job: tuple[Callable[[Simulation], Any], str, dict[str, Any], dict[str, float]]) -> Any:
    function, scene, settings, parameters = job
    with Simulation.load(scene, **settings) as simulation:
        for name, value in parameters.items():
            simulation.parameters[name] = value
        return function(simulation)


def map(function: Callable[[Simulation], Result], scene: str | os.PathLike[str], *, seeds: Iterable[int] | None = None,
        parameters: Iterable[Mapping[str, float]] | None = None, workers: int | None = None,
        executor: Any = None, **settings: Any) -> Iterator[Result]:
    """Yields function(simulation) for each seed, or for each set of parameters, in their order.

    Each simulation is loaded in a process of its own with one thread, so the results do not depend on the number of
    workers. `function` is one that a module defines (it is pickled), and copies what it returns of the simulation.

    workers    processes; None: as many as the machine has cores, 0: this process
    executor   an object with submit() as concurrent.futures has it: a Dask client or its get_executor(), or "ray"
    settings   as of Simulation.load()
    """
    if (seeds is None) == (parameters is None):
        raise InputError("expected either seeds or parameters")
    path = os.path.abspath(scene)
    if not os.path.exists(path):
        raise InputError(f"{reprlib.repr(scene)} is no scene file")
    common = {"threads": 1, **settings}
    jobs: list[Any]
    if seeds is not None:
        jobs = [(function, path, {**common, "seed": int(seed)}, {}) for seed in seeds]
    else:
        jobs = [(function, path, common, dict(values)) for values in parameters or ()]
    if executor == "ray":
        return _by_ray(jobs)
    if executor is not None:
        return _by_executor(executor, jobs)
    if workers is not None and workers < 0:
        raise InputError(f"workers is {workers}, expected 0 or more")
    if workers == 0:
        return (_one(job) for job in jobs)
    try:
        pickle.dumps(function)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise InputError(f"{function!r} cannot be pickled, expected a function that a module defines") from error
    return _by_processes(jobs, workers)


def _by_processes(jobs: list[Any], workers: int | None) -> Iterator[Any]:
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        yield from pool.map(_one, jobs)


def _by_executor(executor: Any, jobs: list[Any]) -> Iterator[Any]:
    futures = [executor.submit(_one, job) for job in jobs]
    for future in futures:
        yield future.result()


def _by_ray(jobs: list[Any]) -> Iterator[Any]:
    ray = import_module("ray")
    remote = ray.remote(_one)
    for reference in [remote.remote(job) for job in jobs]:
        yield ray.get(reference)
