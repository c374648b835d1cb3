"""The program that reads a part from USD for SimVis, which starts it:

  python usd_main.py LIMITS_LIBRARY MEMORY_BYTES FILE FOLDER...

It reads files in the folders alone. The answer goes to the descriptor 3 as import/sandbox/import_answer.h has it. Its scene is
the size of a text of JSON in eight bytes, the text, which holds a glTF document and a model for physics, and the bytes
of the document's buffer.
"""

import os

# Threads that start before the limits have none. OpenBLAS, a part of numpy, starts some when it is loaded.
os.environ.update({"PXR_WORK_THREAD_LIMIT": "1", "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"})

import sys

from limited_python import GREETING, add, limit, text, write


def reason_of(wrong):
    """USD gives a list of errors, of which the first names the place; others have one text."""
    first = wrong.args[0] if wrong.args else wrong
    reason = getattr(first, "commentary", None) or str(wrong) or type(wrong).__name__
    return " ".join(reason.split())[:500]


def main():
    if len(sys.argv) < 4:
        sys.exit("This program reads parts of USD for SimVis, which starts it; it does nothing by itself.")
    library, memory_bytes, file, folders = sys.argv[1], int(sys.argv[2]), sys.argv[3], sys.argv[4:]
    write(GREETING)
    try:
        from usd_stage import read_stage  # before the limits, so that all modules are there
    except ImportError as missing:
        packages = "USD is read by the Python packages usd-core and numpy: pip install usd-core numpy"
        add(b"R", text(f"{packages} ({missing})"))
        return
    try:
        limit(b"usd", library, memory_bytes, folders)
        content, warnings, inputs = read_stage(file, folders)
        for warning in warnings[:100]:
            add(b"W", text(warning))
        for each in inputs:
            add(b"I", os.fsencode(each))
        add(b"S", content)
    except (MemoryError, OSError) as fault:
        add(b"M", text(str(fault) or "there is no memory"))
    except Exception as wrong:  # USD's errors have many types
        add(b"R", text(reason_of(wrong)))


main()
os._exit(0)
