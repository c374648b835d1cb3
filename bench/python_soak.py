#!/usr/bin/env python3
"""What a long run from Python keeps: `bench/python_soak.py [--run build/release] [--steps 1000000]`.

A scanner measures in each step and all its views are read; a thousand views from all over the run are held beside copies.
At the end every view must still be its copy. Prints CSV: steps, resident memory in MB at that time, held views, seconds.
"""
import argparse
import gc
import resource
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
HELD = 1000
SCENE = """<s>
  <part shape="box" size="1 9 9" name="WALL" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>
  <part name="HEAD" insert_at="ROOT"/>
  <element type="pose" name="P" insert_at="HEAD"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="HEAD" samples="9" min_angle="-40" max_angle="40" intensity="on"/></s>"""


def resident_mb() -> float:
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 1e6


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--run", default=str(ROOT / "build/release"), help="build folder with the module")
    arguments.add_argument("--steps", type=int, default=1_000_000)
    options = arguments.parse_args()
    sys.path.insert(0, str(Path(options.run).resolve() / "python"))
    import numpy as np
    import simvis

    sim = simvis.Simulation.from_string(SCENE, threads=1)
    pose, scanner = sim.elements["P"], sim.sensors["SCAN"]
    held = []
    start = time.perf_counter()
    print("steps,resident_mb,held,seconds")
    for step in range(options.steps):
        pose.y = (step % 1000) * 0.001
        sim.step()
        scan = scanner.scan
        views = (scan.range_m, scan.error_bound_m, scan.intensity)
        scan.points("world")
        if step % max(options.steps // HELD, 1) == 0:
            held.append((views, [view.copy() for view in views]))
        if (step + 1) % (options.steps // 10) == 0:
            print(f"{step + 1},{resident_mb():.1f},{len(held)},{time.perf_counter() - start:.0f}", flush=True)
    changed = sum(not np.array_equal(view, copy) for views, copies in held for view, copy in zip(views, copies))
    print(f"{changed} of {3 * len(held)} held views have changed", file=sys.stderr)
    sys.exit(changed > 0)


if __name__ == "__main__":
    main()
