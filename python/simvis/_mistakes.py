"""Answers to names that do not exist. The nearest name, and the words of other simulators, are those of the C++ library."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable
from typing import ParamSpec, TypeVar

from . import _core

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def suggestion(seen: object, known: Iterable[str]) -> str:
    """', did you mean "NAME"?' with the known name that is most similar or has the same meaning; "": none is."""
    return _core.suggestion(str(seen).encode(errors="replace").decode(), list(known))


def checked_keywords(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """The function, whose TypeError for a keyword that it does not have says the nearest one that it has."""
    keywords = list(inspect.signature(function).parameters)[1:]
    called = function.__qualname__.replace("Loading", "Simulation")

    @functools.wraps(function)
    def checked(*arguments: Arguments.args, **named: Arguments.kwargs) -> Result:
        for name in named:
            if name not in keywords:
                raise TypeError(f'{called}() has no setting "{name}"'
                                + (suggestion(name, keywords) or ", expected one of " + ", ".join(keywords)))
        return function(*arguments, **named)

    return checked
