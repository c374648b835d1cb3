"""What SimVis raises: the caller's input is wrong, or the machine failed."""

from __future__ import annotations


class Error(Exception):
    """Base of every exception of SimVis.

    file, line, column say where the mistake stands; "" and 0: not known. Lines and columns count from 1.
    """

    def __init__(self, message: str, file: str = "", line: int = 0, column: int = 0) -> None:
        super().__init__(message)
        self.message = message
        self.file = file
        self.line = line
        self.column = column

    def __str__(self) -> str:
        return self.message

    def __reduce__(self) -> tuple[type[Error], tuple[str, str, int, int]]:
        return type(self), (self.message, self.file, self.line, self.column)


class InputError(Error, ValueError):
    """Wrong input: a scene file, a part, a parameter, or a call that is not allowed now."""


class UnknownName(InputError, KeyError, AttributeError):
    """There is no element, parameter or sensor of this name."""


class MachineError(Error, RuntimeError):
    """A failure of the machine: no device, out of memory, disk full."""
