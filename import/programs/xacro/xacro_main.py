"""The program that expands a xacro file for SimVis, which starts it:

  python xacro_main.py LIMITS_LIBRARY MEMORY_BYTES FILE FOLDER...

It reads files in the folders alone. xacro evaluates expressions of the file in Python, from which code can escape, so
that the limits come first. Standard input is JSON: `arguments`, a list of NAME:=VALUE, and `packages`, folders by name.
The scene of the answer is the expanded text.
"""

import errno
import importlib
import io
import json
import os
import re
import sys
import types

from limited_python import GREETING, add, limit, text, write

# The variables that $(env NAME) finds.
VISIBLE = ("ROS_DISTRO", "ROS_PACKAGE_PATH", "ROS_PYTHON_VERSION", "ROS_VERSION")
# What xacro imports when a file uses it first; those of ROS 1 are elsewhere.
LATER = ("xacro.substitution_args", "yaml", "roslaunch.substitution_args", "rospkg")
# As engine/base/read_error.cpp has them.
FAULTS_OF_FILES = "ENOENT ENOTDIR EISDIR EACCES EPERM ELOOP ENAMETOOLONG EILSEQ EINVAL ENXIO ENODEV EOVERFLOW EFBIG"
MOST_CHARACTERS = 8000


def index_packages(packages):
    """Stands in for the package ament_index_python, which xacro asks for the folders of packages, whether ROS is
    installed or not."""

    def get_package_share_directory(name):
        if name not in packages:
            raise KeyError('there is no package "%s", try --package %s=DIR' % (name, name))
        return packages[name]

    index = types.ModuleType("ament_index_python")
    index.packages = types.ModuleType("ament_index_python.packages")
    index.packages.get_package_share_directory = get_package_share_directory
    sys.modules.update({"ament_index_python": index, "ament_index_python.packages": index.packages})


def import_xacro():
    import xacro

    for name in LATER:
        try:
            importlib.import_module(name)
        except ImportError:
            pass
    return xacro


def forget_environment():
    for name in set(os.environ) - set(VISIBLE):
        del os.environ[name]


def expand(xacro, file, arguments):
    """What xacro prints: the expanded text, its messages, and whether it gave up."""
    output, said = io.StringIO(), io.StringIO()
    sys.argv = ["xacro", file, *arguments]
    sys.stdout, sys.stderr = output, said
    try:
        xacro.main()
        gave_up = False
    except SystemExit as end:
        gave_up = end.code not in (None, 0)
    except Exception as wrong:
        print(str(wrong) or type(wrong).__name__, file=said)
        gave_up = True
    return output.getvalue(), said.getvalue(), gave_up


def without_repetitions(reason):
    """xacro names the file for each level of one that includes itself."""
    return "".join(dict.fromkeys(re.split("(?= included from: )", reason)))


def is_fault_of_machine(reason):
    """xacro turns exceptions into texts."""
    numbers = [int(n) for n in re.findall(r"\[Errno (\d+)\]", reason)]
    of_files = [getattr(errno, name) for name in FAULTS_OF_FILES.split()]
    return "MemoryError" in reason or (bool(numbers) and numbers[-1] not in of_files)


def hint(reason):
    if "Undefined substitution argument" in reason:
        return '; the part\'s attribute xacro_arguments="NAME:=VALUE" sets arguments'
    if "ermission denied" in reason:
        return "; files outside the folders of the part are not read; --package NAME=FOLDER adds a folder"
    if "recursion depth" in reason:
        return "; a file includes itself, or a macro or a property uses itself"
    if "environment variable" in reason:
        return "; of the environment, files see " + ", ".join(VISIBLE) + " alone"
    return ""


def answer_for(output, said, gave_up):
    # Messages of older versions come before the text.
    start = 0 if output.startswith("<?xml") else output.find("\n<?xml") + 1
    if not gave_up and output[start:].startswith("<?xml"):
        return b"S", output[start:]
    reason = without_repetitions(" ".join((output + said).split()))[:MOST_CHARACTERS] or "it prints nothing"
    kind = b"M" if is_fault_of_machine(reason) else b"R"
    return kind, "xacro cannot expand it: " + reason + hint(reason)


def main():
    if len(sys.argv) < 4:
        sys.exit("This program expands xacro files for SimVis, which starts it; it does nothing by itself.")
    library, memory_bytes, file, folders = sys.argv[1], int(sys.argv[2]), sys.argv[3], sys.argv[4:]
    request = json.load(sys.stdin.buffer)
    write(GREETING)
    try:
        index_packages(request["packages"])
        xacro = import_xacro()
        forget_environment()
        limit(b"xacro", library, memory_bytes, folders)
        kind, content = answer_for(*expand(xacro, file, request["arguments"]))
        for each in getattr(xacro, "all_includes", ()):
            add(b"I", os.fsencode(each))
        add(kind, text(content))
    except ImportError as missing:
        add(b"R", text(f"is xacro, and its Python, {sys.executable}, cannot load the module xacro: {missing}"))
    except MemoryError:
        add(b"M", b"xacro takes more than %d MiB of memory" % (memory_bytes >> 20))
    except OSError as fault:
        add(b"M", text(str(fault)))


main()
os._exit(0)
