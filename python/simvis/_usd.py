"""Which interpreter reads files of USD."""

import os
import sys


def read_by_this_python() -> None:
    """Lets this interpreter, whose packages may have usd-core, read USD, unless the user names another one. Without it
    the first python3 of PATH would, which need not be that of the virtual environment that has SimVis."""
    if sys.executable:
        os.environ.setdefault("SIMVIS_PYTHON", sys.executable)
