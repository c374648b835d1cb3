#!/usr/bin/env python3
"""Time and memory of large files of models.

  bench/large_models.py [--program simvis-run] [--small] [--work FOLDER] [KIND...]

Makes a file of each kind, loads it with one laser scanner of one beam, and prints CSV: seconds by the clock, seconds of the
processor with helper programs, the largest resident memory of one process and of all at once, and the status with the
last line of errors. Caches are empty before each. KIND: obj, obj_camera, ply_text, ply_points, pcd_points, splats,
heights, heights_camera. With --small, files are a hundredth as large.
"""

import argparse
import csv
import os
import random
import shutil
import struct
import subprocess
import sys
import threading
import time
import zlib
from pathlib import Path

SCENE = """<simvis>
  <part {part} name="LARGE" insert_at="ROOT"/>
  <sensor type="{sensor}" name="SENSOR" insert_at="ROOT" pose_offset="0 0 50 0 90 0" {more}/>
</simvis>
"""


def write_obj(file, side):
    """A grid of side x side vertices, two triangles for each square, with normals and texture coordinates."""
    with file.open("w") as out:
        for i in range(side):
            out.writelines(f"v {0.01 * i:.6f} {0.01 * j:.6f} {0.5 * ((i * j) % 97) / 97:.6f}\n" for j in range(side))
            out.writelines(f"vt {i / side:.6f} {j / side:.6f}\nvn 0.0 0.0 1.0\n" for j in range(side))
        for i in range(side - 1):
            row = []
            for j in range(side - 1):
                a, b, c, d = (1 + i * side + j, 2 + i * side + j, 2 + (i + 1) * side + j, 1 + (i + 1) * side + j)
                row.append(f"f {a}/{a}/{a} {d}/{d}/{d} {c}/{c}/{c}\nf {a}/{a}/{a} {c}/{c}/{c} {b}/{b}/{b}\n")
            out.writelines(row)


def write_points(file, count, head, fields):
    numbers = random.Random(1)
    block = b"".join(
        struct.pack("<fff", numbers.uniform(-20, 20), numbers.uniform(-20, 20), numbers.uniform(0, 5))
        + bytes(numbers.randrange(256) for _ in range(fields))
        for _ in range(10000)
    )
    with file.open("wb") as out:
        out.write(head(count))
        for _ in range(count // 10000):
            out.write(block)


def ply_head(count):
    return (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    ).encode()


def pcd_head(count):
    return (
        f"VERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH {count}\nHEIGHT 1\n"
        f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary\n"
    ).encode()


def write_ply_text(file, count):
    numbers = random.Random(1)
    with file.open("w") as out:
        out.write(
            f"ply\nformat ascii 1.0\nelement vertex {3 * count}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {count}\nproperty list uchar int vertex_indices\nend_header\n"
        )
        for _ in range(3 * count):
            out.write(f"{numbers.uniform(-20, 20):.6f} {numbers.uniform(-20, 20):.6f} {numbers.uniform(0, 5):.6f}\n")
        for i in range(count):
            out.write(f"3 {3 * i} {3 * i + 1} {3 * i + 2}\n")


def write_splats(file, count):
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"] + [f"f_rest_{i}" for i in range(45)]
    names += ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    numbers = random.Random(1)
    splats = []
    for _ in range(1000):
        place = [numbers.uniform(-20, 20), numbers.uniform(-20, 20), numbers.uniform(0, 5)]
        color = [numbers.uniform(-1, 1) for _ in range(48)]
        shape = [numbers.uniform(-4, -2) for _ in range(3)]
        turn = [1, numbers.uniform(-1, 1), numbers.uniform(-1, 1), numbers.uniform(-1, 1)]
        splats.append((place, struct.pack("<56f", *color, 0.5, *shape, *turn)))
    with file.open("wb") as out:
        properties = "".join(f"property float {name}\n" for name in names)
        out.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{properties}end_header\n".encode())
        for i in range(count // 1000):
            shift = 0.01 * (i % 100)
            out.write(b"".join(struct.pack("<fff", p[0] + shift, p[1] - shift, p[2]) + rest for p, rest in splats))


def write_heights(file, side):
    """A PNG of 16 bits."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(
        b"\0" + b"".join(struct.pack(">H", (i * 37 + j * 91 + (i * j) % 511) % 65536) for j in range(side))
        for i in range(side)
    )
    head = struct.pack(">IIBBBBB", side, side, 16, 0, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))


MAP = 'shape="heightmap" heights="{}" size="100 100" z_range="0 5"'
SCANNER = ("laser_scanner", 'range_max="100"')
# name, ending, full size, writer, attributes of the part, sensor with its attributes
KINDS = [
    ("obj", ".obj", 1300, write_obj, 'file="{}"', SCANNER),
    ("obj_camera", ".obj", 1300, write_obj, 'file="{}"', ("camera", "")),
    ("ply_text", ".ply", 1000000, write_ply_text, 'file="{}"', SCANNER),
    ("ply_points", ".ply", 20000000, lambda file, count: write_points(file, count, ply_head, 3), 'file="{}"', ("camera", "")),
    ("pcd_points", ".pcd", 20000000, lambda file, count: write_points(file, count, pcd_head, 4), 'file="{}"', ("camera", "")),
    ("splats", ".ply", 1000000, write_splats, 'file="{}"', ("camera", "")),
    ("heights", ".png", 4096, write_heights, MAP, SCANNER),
    ("heights_camera", ".png", 4096, write_heights, MAP, ("camera", "")),
]


def resident_bytes(process):
    """Of a process and of those that it has started: the sum."""
    total = 0
    try:
        children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
        for line in Path(f"/proc/{process}/status").read_text().splitlines():
            if line.startswith("VmRSS:"):
                total = 1024 * int(line.split()[1])
    except OSError:
        return 0
    for task in Path(f"/proc/{process}/task").glob("*/children") if total else []:
        try:
            children += task.read_text().split()
        except OSError:
            pass
    return total + sum(resident_bytes(int(child)) for child in set(children))


def measured(command, cache):
    shutil.rmtree(cache, ignore_errors=True)
    environment = {**os.environ, "XDG_CACHE_HOME": str(cache.resolve())}
    before = os.times()
    start = time.monotonic()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment) as process:
        peaks = [0]

        def watch():
            while process.poll() is None:
                peaks[0] = max(peaks[0], resident_bytes(process.pid))
                time.sleep(0.02)

        watcher = threading.Thread(target=watch)
        watcher.start()
        errors = process.stderr.read()
        process.wait()
        watcher.join()
    seconds, after = time.monotonic() - start, os.times()
    used = after.children_user + after.children_system - before.children_user - before.children_system
    last = (errors.strip().splitlines() or [""])[-1] if process.returncode else ""
    return f"{seconds:.2f}", f"{used:.2f}", f"{peaks[0] / 2**30:.2f}", process.returncode, last


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/simvis-run")
    parser.add_argument("--work", type=Path, default=Path("build/large_models"))
    parser.add_argument("--small", action="store_true")
    parser.add_argument("kinds", nargs="*", metavar="KIND")
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    out = csv.writer(sys.stdout)
    out.writerow(["kind", "file_mb", "wall_s", "processor_s", "peak_gib", "status", "error"])
    for name, ending, size, write, part, (sensor, more) in KINDS:
        if options.kinds and name not in options.kinds:
            continue
        size = max(size // (10 if ending in (".obj", ".png") else 100), 10) if options.small else size
        file = options.work / f"{write.__name__.strip('<>')}_{size}{ending}"
        if not file.exists():
            write(file, size)
        scene = options.work / f"{name}.xml"
        scene.write_text(SCENE.format(part=part.format(file.name), sensor=sensor, more=more))
        command = [options.program, "--out", str(options.work / "out"), str(scene)]
        out.writerow([name, f"{file.stat().st_size / 1e6:.0f}", *measured(command, options.work / "cache")])
        sys.stdout.flush()


main()
