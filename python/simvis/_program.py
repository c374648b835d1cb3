"""The programs simvis-run and simvis-ctl of the package."""

import os
import sys
from pathlib import Path

from . import _usd


def main() -> None:
    """Becomes simvis-run."""
    _become("simvis-run")


def ctl() -> None:
    """Becomes simvis-ctl."""
    _become("simvis-ctl")


def _become(name: str) -> None:
    program = Path(__file__).with_name("bin") / name
    _usd.read_by_this_python()
    os.execv(program, [str(program), *sys.argv[1:]])
