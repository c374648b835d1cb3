#!/usr/bin/env python3
"""What the Python module adds to a step, and what its calls cost: `bench/python_overhead.py [--run build/release]`.

Prints CSV: name, value, unit. `step_ratio` is the median time of a step of marvin's three scanners by raycast from Python,
with their ranges read, over that of the bare step in C++ (simvis-run --profile would add the writing of files, so the
bare step is that of the extension module without the arrays: the same C++ call). Both take turns.
"""
import argparse
import statistics
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SCANNERS = ["FRONT_SCANNER", "REAR_SCANNER", "TILT_SCANNER"]


def median_us(call, count: int) -> float:
    times = []
    for _ in range(count):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return 1e6 * statistics.median(times)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--run", default=str(ROOT / "build/release"), help="build folder with the module")
    arguments.add_argument("--steps", type=int, default=2000)
    options = arguments.parse_args()
    sys.path.insert(0, str(Path(options.run) / "python"))
    import numpy as np
    import simvis

    sim = simvis.Simulation.load(ROOT / "scenes/marvin/marvin.xml", overrides={"laser_scanner.method": "raycast"})
    sim.only(*SCANNERS)
    sensors = [sim.sensors[name] for name in SCANNERS]
    robot = sim.elements["R_POSE"]
    bare_step, bare_set = sim.step, sim.set

    def bare() -> None:
        bare_set("R_POSE", "yaw", frame % 360)
        bare_step()

    def whole() -> list[object]:
        robot.yaw = frame % 360
        sim.step()
        return [sensor.range_m for sensor in sensors]

    times: dict[str, list[float]] = {"bare": [], "whole": []}
    for frame in range(options.steps):
        for name, call in (("bare", bare), ("whole", whole)):
            start = time.perf_counter()
            call()
            times[name].append(time.perf_counter() - start)
    step, read = (1e6 * statistics.median(times[name]) for name in ("bare", "whole"))
    print("name,value,unit")
    print(f"step,{step:.1f},us")
    print(f"step_with_three_scans_read,{read:.1f},us")
    print(f"step_ratio,{read / step:.4f},")
    sensor = sensors[0]
    for name, call in (("set", lambda: setattr(robot, "x", 0.5)), ("get", lambda: robot.x),
                       ("range_m", lambda: sensor.range_m), ("scan", lambda: sensor.scan), ("pose", lambda: sensor.pose)):
        print(f"{name},{median_us(call, 20000):.2f},us")
    camera = simvis.Simulation.from_string(
        '<s><part shape="box" size="1 1 1" name="B" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>'
        '<sensor type="camera" name="C" insert_at="ROOT" width="1920" height="1080" outputs="color depth"/></s>')
    camera.step()
    color = camera.sensors["C"].color
    buffer = np.empty(color.shape, np.uint8)
    print(f"depth_1920x1080,{median_us(lambda: camera.sensors['C'].depth, 200):.2f},us")
    print(f"color_1920x1080,{median_us(lambda: camera.sensors['C'].color, 20):.0f},us")
    print(f"rgb_1920x1080_into_buffer,{median_us(lambda: camera.sensors['C'].image().rgb(buffer), 20):.0f},us")


if __name__ == "__main__":
    main()
