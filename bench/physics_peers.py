#!/usr/bin/env python3
"""A step of physics beside MuJoCo and pybullet: `bench/physics_peers.py [--run build/release] [--models FOLDER] [SCENE...]`.

The interpreter needs the packages `mujoco` and `pybullet`; a peer that is missing is left out, with the reason on stderr.
FOLDER has humanoid.xml and ant.xml, such as those of the package `gymnasium`. All take turns, and times are processor time
per step: of SimVis the difference of two runs of simvis-run, so that loading does not count. The least of all turns counts,
since other work on the machine only adds. Without SCENE, all are measured:

  heap       300 boxes fall into a heap for 2 s, steps of 1 ms, 50 passes of the solvers that pass
  heap_rest  the same boxes from the third to the fifth second, in which they lie
  rest       300 boxes stand on a floor for 3 s, and then for the seconds that are measured: those of SimVis sleep
  humanoid, ant  the files as they are, with their own steps, without control, for 30 s: loading is far less

pybullet has each box as a jointed body without joints, its default, and as a rigid body (`pybullet_rigid`), as SimVis has it.
Neither pybullet nor MuJoCo lets bodies sleep by default.

Prints CSV: scene, who, steps, us_per_step, ratio_to_simvis.
"""
import argparse
import importlib
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TURNS, MODEL_S = 3, 30.0
EDGE_M, PASSES, STEP_S, RATE_HZ = 0.2, 50, 1e-3, 10
FLOOR = ('<part name="F" insert_at="ROOT" shape="box" size="200 200 2" pose_offset="0 0 -1 0 0 0"/>\n'
         '<element type="body" name="FB" insert_at="F" kind="static" shape="box"/>\n')
SENSOR = '<part name="E" insert_at="ROOT"/><sensor type="odometry" name="O" insert_at="E"/>\n'


def heap() -> list[tuple[float, float, float]]:
    return [(0.22 * (i % 6) + 0.03 * (i // 36 % 3), 0.22 * (i // 6 % 6) + 0.02 * (i // 36 % 2), 0.3 + 0.22 * (i // 36))
            for i in range(300)]


def rest() -> list[tuple[float, float, float]]:
    return [(i % 20 - 10, i // 20 - 7, EDGE_M / 2) for i in range(300)]


def scene_of_boxes(places: list[tuple[float, float, float]]) -> str:
    boxes = "".join(
        f'<part name="P{i}" insert_at="ROOT" shape="box" size="{EDGE_M} {EDGE_M} {EDGE_M}" '
        f'pose_offset="{x} {y} {z} 0 0 0"/><element type="body" name="B{i}" insert_at="P{i}" shape="box" mass="1"/>\n'
        for i, (x, y, z) in enumerate(places))
    return f'<simvis>\n<element type="physics" name="PHYSICS" insert_at="ROOT"/>\n{FLOOR}{boxes}{SENSOR}</simvis>\n'


def scene_of_model(file: Path) -> str:
    return (f'<simvis>\n<part name="WORLD" insert_at="ROOT" file="{file}"/>\n'
            '<element type="physics" name="PHYSICS" insert_at="ROOT" world="WORLD"/>\n'
            f'<element type="models" name="MODELS" insert_at="WORLD"/>\n{SENSOR}</simvis>\n')


def simvis_us(program: Path, scene: str, step_s: float, from_s: float, seconds: float) -> float:
    """Of the steps from `from_s` on."""
    def processor_s(until_s: float) -> float:
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run([program, file, "--rate", str(RATE_HZ), "--frames", str(round(until_s * RATE_HZ) + 1), "--quiet",
                        "--out", folder], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.xml"
        file.write_text(scene)
        return (processor_s(from_s + seconds) - processor_s(from_s)) / (seconds / step_s) * 1e6


def mujoco_us(mujoco, model, from_s: float, seconds: float) -> float:
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, round(from_s / model.opt.timestep))
    steps = round(seconds / model.opt.timestep)
    before = time.process_time()
    mujoco.mj_step(model, data, steps)
    return (time.process_time() - before) / steps * 1e6


def mujoco_boxes(mujoco, places: list[tuple[float, float, float]]):
    boxes = "".join(f'<body pos="{x} {y} {z}"><freejoint/><geom type="box" size="{EDGE_M / 2} {EDGE_M / 2} {EDGE_M / 2}" '
                    'mass="1"/></body>' for x, y, z in places)
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{STEP_S}"/><size memory="1G"/><worldbody><geom type="box" size="100 100 1" '
        f'pos="0 0 -1"/>{boxes}</worldbody></mujoco>')


def pybullet_us(pybullet, is_rigid: bool, places: list[tuple[float, float, float]], from_s: float, seconds: float) -> float:
    world = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.80665)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=STEP_S, numSolverIterations=PASSES)
    floor = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[100, 100, 1])
    box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[EDGE_M / 2] * 3)
    pybullet.createMultiBody(0, floor, basePosition=[0, 0, -1])
    for place in places:
        body = pybullet.createMultiBody(1, box, basePosition=place, useMaximalCoordinates=is_rigid)
        pybullet.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
    for _ in range(round(from_s / STEP_S)):
        pybullet.stepSimulation()
    steps = round(seconds / STEP_S)
    before = time.process_time()
    for _ in range(steps):
        pybullet.stepSimulation()
    used = time.process_time() - before
    pybullet.disconnect(world)
    return used / steps * 1e6


def peer(name: str):
    try:
        return importlib.import_module(name)
    except ImportError as error:
        print(f"{name} is left out: {error}", file=sys.stderr)
        return None


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--run", default=ROOT / "build/release", type=Path)
    parser.add_argument("--models", type=Path)
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    options = parser.parse_args()
    program = options.run.resolve() / "bin/simvis-run"
    mujoco, pybullet = peer("mujoco"), peer("pybullet")
    tasks = {}  # name: step, and a function for each engine
    for name, places, from_s, seconds in (("heap", heap(), 0.0, 2.0), ("heap_rest", heap(), 3.0, 2.0),
                                          ("rest", rest(), 3.0, 2.0)):
        scene, all_of = scene_of_boxes(places), {}
        all_of["simvis"] = lambda s=scene, f=from_s, t=seconds: simvis_us(program, s, STEP_S, f, t)
        if mujoco:
            model = mujoco_boxes(mujoco, places)
            all_of["mujoco"] = lambda m=model, f=from_s, t=seconds: mujoco_us(mujoco, m, f, t)
        if pybullet:
            all_of["pybullet"] = lambda p=places, f=from_s, t=seconds: pybullet_us(pybullet, False, p, f, t)
            all_of["pybullet_rigid"] = lambda p=places, f=from_s, t=seconds: pybullet_us(pybullet, True, p, f, t)
        tasks[name] = (round(seconds / STEP_S), all_of)
    for name in ("humanoid", "ant") if options.models and mujoco else ():
        file = (options.models / f"{name}.xml").resolve()
        model = mujoco.MjModel.from_xml_path(str(file))
        step_s = model.opt.timestep
        tasks[name] = (round(MODEL_S / step_s), {
            "simvis": lambda f=file, h=step_s: simvis_us(program, scene_of_model(f), h, 0, MODEL_S),
            "mujoco": lambda m=model: mujoco_us(mujoco, m, 0, MODEL_S)})
    print("scene,who,steps,us_per_step,ratio_to_simvis")
    if unknown := set(options.scenes) - set(tasks):
        parser.error(f"no scene {', '.join(sorted(unknown))}; there are {', '.join(tasks)}")
    for name, (steps, all_of) in tasks.items():
        if options.scenes and name not in options.scenes:
            continue
        times = {who: [] for who in all_of}
        for _ in range(TURNS):
            for who, measure in all_of.items():
                times[who].append(measure())
        own = min(times["simvis"])
        for who, each in times.items():
            us = min(each)
            print(f"{name},{who},{steps},{us:.1f},{us / own:.2f}", flush=True)


if __name__ == "__main__":
    main()
