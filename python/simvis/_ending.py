"""The end of the interpreter, which waits for threads that are inside the extension module."""

from __future__ import annotations

import atexit
import os
import signal
import time

from ._core import begin_end, is_inside

_LOOK_S = 0.005


def _wait_for_threads() -> None:
    """Waits for what other threads began. An interrupt ends the process at once, as it does without a handler."""
    begin_end()
    try:
        while is_inside():
            time.sleep(_LOOK_S)
    except KeyboardInterrupt:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGINT)


atexit.register(_wait_for_threads)
