"""The program that reads a part from USD for SimVis, which starts it:

  python usd_main.py LIMITS_LIBRARY MEMORY_BYTES FILE FOLDER...

It reads files in the folders alone. The answer goes to the descriptor 3 as sandbox/import_answer.h has it. Its scene is
the size of a text of JSON in eight bytes, the text, which holds a glTF document and a model for physics, and the bytes
of the document's buffer.
"""

import os

os.environ["PXR_WORK_THREAD_LIMIT"] = "1"

import ctypes
import struct
import sys
import sysconfig

ANSWER = 3
GREETING = b"simvis-import-5\n"


def write(data):
    data = memoryview(data)
    while data:
        data = data[os.write(ANSWER, data) :]


def add(kind, content):
    write(struct.pack("<cQ", kind, len(content)))
    write(content)


def text(message):
    return message.encode(errors="surrogateescape")


def folders_of_python():
    """What Python and USD read while they run: modules, plug-ins and their libraries."""
    import pxr

    paths = {os.path.dirname(p) for p in pxr.__path__} | {sys.prefix, sys.base_prefix}
    paths |= set(sysconfig.get_paths().values())
    return [p for p in paths if os.path.isdir(p)] + ["/usr/lib", "/lib", "/lib64", "/etc/ld.so.cache"]


def limit(library, memory_bytes, folders):
    function = ctypes.CDLL(library).simvis_limit_process
    function.restype = ctypes.c_int
    names = [os.fsencode(f) for f in folders]
    reason = ctypes.create_string_buffer(1024)
    array = (ctypes.c_char_p * len(names))(*names)
    if function(ctypes.c_size_t(memory_bytes), array, len(names), reason, len(reason)) != 0:
        raise OSError(reason.value.decode(errors="replace"))


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
        limit(library, memory_bytes, folders + folders_of_python())
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
