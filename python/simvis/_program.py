"""The program simvis-run of the package."""

import os
import sys
from pathlib import Path


def main() -> None:
    program = Path(__file__).with_name("bin") / "simvis-run"
    os.execv(program, [str(program), *sys.argv[1:]])
