"""What the programs in Python share that SimVis starts to read a stranger's file: their limits and their answer, which
goes to the descriptor 3 as import/sandbox/import_answer.h has it."""

import ctypes
import os
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
    """What Python reads while it runs: modules, plug-ins and their libraries."""
    paths = {sys.prefix, sys.base_prefix, *sysconfig.get_paths().values()}
    for folder in [*sys.path, *(p for module in list(sys.modules.values()) for p in getattr(module, "__path__", ()))]:
        if os.path.isabs(folder):
            paths.add(folder)
    return [p for p in paths if os.path.exists(p)] + ["/usr/lib", "/lib", "/lib64", "/etc/ld.so.cache"]


def limit(program, library, memory_bytes, folders):
    """From now on this process reads files in the folders and in those of Python alone, and makes few system calls."""
    function = ctypes.CDLL(library).simvis_limit_process
    function.restype = ctypes.c_int
    names = [os.fsencode(f) for f in folders + folders_of_python()]
    reason = ctypes.create_string_buffer(1024)
    array = (ctypes.c_char_p * len(names))(*names)
    if function(program, ctypes.c_size_t(memory_bytes), array, len(names), reason, ctypes.c_size_t(len(reason))) != 0:
        raise OSError(reason.value.decode(errors="replace"))
