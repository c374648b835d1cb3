"""Many simulations of one scene, in processes of their own."""

from __future__ import annotations

import os
import pickle
import reprlib
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from importlib import import_module
from itertools import islice
from typing import Any, TypeVar

from ._errors import InputError
from ._simulation import Simulation

Result = TypeVar("Result")
_JOBS_A_WORKER = 4      # so that no worker waits for another's long job
_OTHERS_WORKERS = 256  # of executors, which do not say how many they have


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
    `seeds` and `parameters` may be without end: they are read as results are taken, a few jobs a worker ahead.

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
    jobs: Iterator[Any]
    if seeds is not None:
        jobs = ((function, path, {**common, "seed": int(seed)}, {}) for seed in seeds)
    else:
        jobs = ((function, path, common, dict(values)) for values in parameters or ())
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


def _by_processes(jobs: Iterator[Any], workers: int | None) -> Iterator[Any]:
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    count = workers or os.cpu_count() or 1
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        yield from _in_order(jobs, lambda job: pool.submit(_one, job), lambda future: future.result(), count)


def _by_executor(executor: Any, jobs: Iterator[Any]) -> Iterator[Any]:
    return _in_order(jobs, lambda job: executor.submit(_one, job), lambda future: future.result(), _OTHERS_WORKERS)


def _by_ray(jobs: Iterator[Any]) -> Iterator[Any]:
    ray = import_module("ray")
    remote = ray.remote(_one)
    return _in_order(jobs, remote.remote, ray.get, _OTHERS_WORKERS)


def _in_order(jobs: Iterator[Any], submit: Callable[[Any], Any], result_of: Callable[[Any], Any],
              workers: int) -> Iterator[Any]:
    """The results in the order of the jobs, with few enough jobs under way that memory does not grow."""
    under_way = deque(submit(job) for job in islice(jobs, _JOBS_A_WORKER * workers))
    try:
        while under_way:
            result = result_of(under_way.popleft())
            under_way.extend(submit(job) for job in islice(jobs, 1))
            yield result
    finally:
        for job in under_way:  # their results are not taken any more; a job of Ray ends by itself
            if hasattr(job, "cancel"):
                job.cancel()
