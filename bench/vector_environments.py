#!/usr/bin/env python3
"""Many environments with a planar scanner, stepped together and one by one: `bench/vector_environments.py [--run build/release]`.

The interpreter needs NumPy; with the package `mujoco` it measures MuJoCo too. Each turn sets the yaw of every robot, makes a frame of each environment and has all
ranges in one array, (environments, 361). All take turns in one process, and a ratio is the median over the turns of a time
over that of `vector` in the same turn. Ranges that differ end the program: by a bit one by one, by 1 mm from MuJoCo.

  vector      simvis.VectorSimulation
  one_by_one  simvis.Simulation for each environment: set(), step(), range_m, and numpy.stack()
  steps       of these the calls of step() alone
  mujoco      mujoco.rollout with 361 rangefinders, as many threads as there are cores

The scenes: `room`, 20 spheres in a box (MuJoCo has the same ones), and `marvin`, the
scene's FRONT_SCANNER (SimVis alone).

Prints CSV: scene, environments, who, turns, ms, processor_ms, ratio_to_vector, memory_kb (of one environment more).
"""
import argparse
import importlib
import importlib.util
import math
import os
import statistics
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
BEAMS, REACH_M, RADIUS_M, HALF_M = 361, 80.0, 0.3, np.array([5.0, 5.0, 1.5])
SPHERES = [((i % 5) * 1.5 - 3, (i // 5) * 1.5 - 2.2, 0.0) for i in range(20)]
START = (0.75, 0.2, 0.0)  # between the spheres


def room() -> str:
    spheres = "".join(f'<part name="S{i}" insert_at="ROOT" shape="sphere" radius="{RADIUS_M}" pose_offset="{x} {y} {z} 0 0 0"/>'
                      for i, (x, y, z) in enumerate(SPHERES))
    return (f'<simvis><part name="ROOM" insert_at="ROOT" shape="box" size="{" ".join(str(2 * half) for half in HALF_M)}"/>{spheres}'
            '<part name="ROBOT" insert_at="ROOT"/><element type="pose" name="R_POSE" insert_at="ROBOT" '
            f'x="{START[0]}" y="{START[1]}"/><sensor type="laser_scanner" name="FRONT_SCANNER" insert_at="ROBOT" '
            f'samples="{BEAMS}" min_angle="-90" max_angle="90" range_max="{REACH_M}"/></simvis>')


def memory_kb() -> float:
    return next(int(line.split()[1]) for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmRSS"))


class Vector:
    def __init__(self, simvis, scene: str, count: int) -> None:
        settings = {"sensors": ["FRONT_SCANNER"]}
        self.sims = (simvis.VectorSimulation.from_string(room(), count, **settings) if scene == "room" else
                     simvis.VectorSimulation.load(simvis.scene(scene), count, **settings))

    def __call__(self, yaws: np.ndarray) -> np.ndarray:
        self.sims.parameters["R_POSE.yaw"] = yaws
        self.sims.step()
        return self.sims.outputs["FRONT_SCANNER.range_m"][:, 0]


class OneByOne:
    def __init__(self, simvis, scene: str, count: int) -> None:
        settings = {"sensors": ["FRONT_SCANNER"]}
        self.sims = [simvis.Simulation.from_string(room(), seed=i, **settings) if scene == "room" else
                     simvis.Simulation.load(simvis.scene(scene), seed=i, **settings) for i in range(count)]
        self.sensors = [sim.sensors["FRONT_SCANNER"] for sim in self.sims]
        self.steps_s = 0.0

    def __call__(self, yaws: np.ndarray) -> np.ndarray:
        for sim, yaw in zip(self.sims, yaws):
            sim.set("R_POSE", "yaw", yaw)
        start = time.perf_counter()
        for sim in self.sims:
            sim.step()
        self.steps_s = time.perf_counter() - start
        return np.stack([sensor.range_m[0] for sensor in self.sensors])


class MuJoCo:
    """A mocap body has the rangefinders; a rollout of one step takes its pose from the state."""

    def __init__(self, mujoco, count: int) -> None:
        self.rollout = importlib.import_module("mujoco.rollout")
        angles = np.radians(np.linspace(-90, 90, BEAMS))
        sites = "".join(f'<site name="s{i}" zaxis="{math.cos(a)} {math.sin(a)} 0"/>' for i, a in enumerate(angles))
        rays = "".join(f'<rangefinder site="s{i}" cutoff="{REACH_M}"/>' for i in range(BEAMS))
        walls = "".join(f'<geom type="box" size="{" ".join("0.1" if k == axis else str(HALF_M[k]) for k in range(3))}" '
                        f'pos="{" ".join(str(sign * (HALF_M[k] + 0.1)) if k == axis else "0" for k in range(3))}"/>'
                        for axis in range(3) for sign in (-1, 1))
        spheres = "".join(f'<geom type="sphere" size="{RADIUS_M}" pos="{x} {y} {z}"/>' for x, y, z in SPHERES)
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco><worldbody>{walls}{spheres}<body name="r" mocap="true" pos="{START[0]} {START[1]} 0">{sites}</body>'
            f'</worldbody><sensor>{rays}</sensor></mujoco>')
        self.data = [mujoco.MjData(self.model) for _ in range(os.cpu_count() or 1)]
        self.spec = mujoco.mjtState.mjSTATE_MOCAP_QUAT
        state = np.zeros(mujoco.mj_stateSize(self.model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
        mujoco.mj_getState(self.model, self.data[0], state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        self.states = np.tile(state, (count, 1))

    def __call__(self, yaws: np.ndarray) -> np.ndarray:
        half = np.radians(yaws) / 2
        control = np.zeros((len(yaws), 1, 4))
        control[:, 0, 0], control[:, 0, 3] = np.cos(half), np.sin(half)
        _, sensed = self.rollout.rollout(self.model, self.data, self.states, control, control_spec=self.spec)
        return sensed[:, 0]


def compare(simvis, scene: str, count: int, turns: int) -> None:
    before = memory_kb()
    all_of = {"vector": Vector(simvis, scene, count)}
    all_of["vector"](np.zeros(count))
    memory = (memory_kb() - before) / count
    all_of["one_by_one"] = OneByOne(simvis, scene, count)
    if scene == "room" and importlib.util.find_spec("mujoco"):
        all_of["mujoco"] = MuJoCo(importlib.import_module("mujoco"), count)
    times = {name: [] for name in (*all_of, "steps")}
    processor = {name: [] for name in all_of}
    for turn in range(turns + 1):
        yaws = (7.0 * turn + np.arange(count)) % 360
        ranges = {}
        for name, measure in all_of.items():
            start, used = time.perf_counter(), time.process_time()
            ranges[name] = measure(yaws)
            if turn > 0:  # the first one prepares
                times[name].append(time.perf_counter() - start)
                processor[name].append(time.process_time() - used)
        if turn > 0:
            times["steps"].append(all_of["one_by_one"].steps_s)
        for name, measured in ranges.items():
            worst = np.abs(measured - ranges["vector"]).max()
            if worst > (0 if name == "one_by_one" else 1e-3):
                sys.exit(f"{scene}: {name} measures other ranges, by up to {worst} m")
    for name, each in times.items():
        ratio = statistics.median(a / b for a, b in zip(each, times["vector"]))
        used = f"{1e3 * statistics.median(processor[name]):.2f}" if name in processor else ""
        print(f"{scene},{count},{name},{turns},{1e3 * statistics.median(each):.2f},{used},{ratio:.2f},"
              f"{f'{memory:.0f}' if name == 'vector' else ''}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--run", default=str(ROOT / "build/release"), help="build folder with the module")
    parser.add_argument("--environments", type=int, default=100)
    parser.add_argument("--turns", type=int, default=200)
    options = parser.parse_args()
    sys.path.insert(0, str(Path(options.run) / "python"))
    simvis = importlib.import_module("simvis")
    print("scene,environments,who,turns,ms,processor_ms,ratio_to_vector,memory_kb")
    for scene in ("room", "marvin"):
        compare(simvis, scene, options.environments, options.turns)


if __name__ == "__main__":
    main()
