#!/usr/bin/env python3
"""What it costs to hold xacro by the kernel: `bench/xacro_cost.py [--run build/release]`, by a Python with xacro.

Prints CSV: name, value, unit. `held` is the median processor time of the program that expands a xacro file for SimVis, with
its limits, `bare` that of xacro alone; both take turns. `ratio` is the first by the second. The file
is a robot of 100 links.
"""
import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LINK = """<xacro:macro name="l" params="i"><link name="l${i}"><visual><geometry><box size="1 1 ${i * 0.1 + 1}"/></geometry></visual>
</link></xacro:macro>"""


def processor_s(command, **options) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, **options)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def held_s(helpers: Path, file: str) -> float:
    request = json.dumps({"arguments": [], "packages": {}}).encode()
    script, limits = str(helpers / "python/xacro_main.py"), str(helpers / "simvis-python-limits.so")
    command = [sys.executable, "-B", script, limits, str(4 << 30), file, str(Path(file).parent)]
    with tempfile.TemporaryFile() as answer:
        hand_over = ["sh", "-c", f'exec "$@" 3>&{answer.fileno()}', "sh", *command]  # it answers to the descriptor 3
        used_s = processor_s(hand_over, input=request, pass_fds=[answer.fileno()])
        answer.seek(0)
        if b'name="l99"' not in answer.read():
            raise RuntimeError("the program has not expanded the file")
        return used_s


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--run", default=str(ROOT / "build/release"), help="build folder with the library")
    arguments.add_argument("--times", type=int, default=20)
    options = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        file = folder + "/robot.xacro"
        links = "".join(f'<xacro:l i="{i}"/>' for i in range(100))
        Path(file).write_text(f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{LINK}{links}</robot>')
        bare = [sys.executable, "-B", "-c", "import xacro; xacro.main()", file]
        turns = [(processor_s(bare), held_s(Path(options.run) / "lib/simvis", file)) for _ in range(options.times)]
    bare_s, all_held_s = (statistics.median(times) for times in zip(*turns))
    print("name,value,unit")
    print(f"bare,{1e3 * bare_s:.1f},ms")
    print(f"held,{1e3 * all_held_s:.1f},ms")
    print(f"ratio,{all_held_s / bare_s:.3f},")


if __name__ == "__main__":
    main()
