#!/usr/bin/env python3
"""What a run costs until its first row: processor time, memory, libraries and files, of an IMU, an IMU beside a mesh of a million
triangles, a scan by rays and by drawing, a camera, and physics. Prints a table as CSV.

  bench/start_up.py [--runs N] [--triangles N]

Each run is `simvis-run` with one frame, started as users start it, N times (default 15) in turns with the others, after one that
fills the caches. Processor time is that of the process with all its threads and children, as the kernel counts it; memory is the
largest resident size of one of them. Libraries are those that the dynamic linker reports (LD_DEBUG=files); files are inputs in
run.json."""
import argparse
import csv
import json
import os
import re
import statistics
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RUN = ROOT / "build/release/bin/simvis-run"
MARVIN = ROOT / "scenes/marvin/marvin.xml"
IMU = '<sensor type="imu" name="IMU" insert_at="ROOT"/>'
DRIVER = re.compile(r"libvulkan_|libLLVM")


def write_mesh(file, triangles):
    """A square of 2 m with hills, as binary STL."""
    import struct
    side = int((triangles / 2) ** 0.5)
    cells = ((i, j) for i in range(side) for j in range(side))
    with open(file, "wb") as out:
        out.write(bytes(80) + struct.pack("<I", 2 * side * side))
        for i, j in cells:
            p = [(2 * (i + a) / side, 2 * (j + b) / side, ((i + a) * (j + b)) % 7 / 100) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
            for triangle in ((p[0], p[1], p[2]), (p[0], p[2], p[3])):
                out.write(struct.pack("<12fH", 0, 0, 0, *(x for point in triangle for x in point), 0))


def cases(folder, triangles):
    write_mesh(folder / "mesh.stl", triangles)
    mesh = '<part file="mesh.stl" name="MESH" insert_at="ROOT"/>'
    scenes = {
        "imu": IMU,
        "imu_mesh": mesh + IMU,
        "physics": '<element type="physics" name="P" insert_at="ROOT"/><part name="BOX" shape="box" size="1 1 1" insert_at="ROOT"/>'
                   '<element type="body" name="B" insert_at="BOX" mass="1"/>' + IMU.replace("ROOT", "BOX"),
    }
    for name, commands in scenes.items():
        (folder / f"{name}.xml").write_text(f"<simvis>{commands}</simvis>")
    own = {name: [str(folder / f"{name}.xml")] for name in scenes}
    return {
        "an IMU alone": own["imu"],
        f"an IMU beside a mesh of {triangles:,} triangles": own["imu_mesh"],
        "an IMU on a body of physics": own["physics"],
        "marvin, a scan of 361 beams by raycast": [str(MARVIN), "--sensor", "FRONT_SCANNER", "--method", "raycast"],
        "marvin, the same by planar": [str(MARVIN), "--sensor", "FRONT_SCANNER", "--method", "planar"],
        "marvin, the robot's camera": [str(MARVIN), "--sensor", "ROBOT_CAM"],
    }


def run(arguments, out, environment=None):
    """Processor time in ms and memory in MB."""
    command = [str(RUN), *arguments, "--frames", "1", "--quiet", "--out", str(out)]
    with open(out.parent / "err", "w") as err:
        pid = os.posix_spawn(command[0], command, {**os.environ, **(environment or {})},
                             file_actions=[(os.POSIX_SPAWN_DUP2, err.fileno(), 2)])
        _, status, use = os.wait4(pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(command)}: {(out.parent / 'err').read_text()}")
    return (use.ru_utime + use.ru_stime) * 1e3, use.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=15)
    parser.add_argument("--triangles", type=int, default=1_000_000)
    options = parser.parse_args()
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(["case", "runs", "cpu_ms", "cpu_ms_min", "memory_mb", "libraries", "driver", "files"])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        all_cases, measured = cases(folder, options.triangles), {}
        facts = {}
        for case, arguments in all_cases.items():
            run(arguments, folder / "out", {"LD_DEBUG": "files"})
            loaded = set(re.findall(r"calling init: (\S+)", (folder / "err").read_text()))
            inputs = json.loads((folder / "out/run.json").read_text())["inputs"]
            facts[case] = [len(loaded), int(any(DRIVER.search(each) for each in loaded)), len(inputs)]
        for _ in range(options.runs):
            for case, arguments in all_cases.items():
                measured.setdefault(case, []).append(run(arguments, folder / "out"))
        for case, results in measured.items():
            times, memory = [each[0] for each in results], max(each[1] for each in results)
            writer.writerow([case, len(results), f"{statistics.median(times):.1f}", f"{min(times):.1f}", f"{memory:.1f}", *facts[case]])


if __name__ == "__main__":
    main()
