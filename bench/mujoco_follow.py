#!/usr/bin/env python3
"""What simvis.mujoco.follow() adds to a step: `bench/mujoco_follow.py [--run build/release]`. It needs mujoco.

Prints CSV: bodies, then the median times in us of mj_step() with mj_kinematics(), of update(), and of a step of SimVis
with a scanner of 361 beams, in turns. The model is a chain of boxes on hinges, each 0.1 m long, that hangs from a free
body.
"""
import argparse
import statistics
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BODIES = (2, 14, 50, 200)


def chain(bodies: int) -> str:
    link = '<body pos="0.1 0 0"><joint axis="0 1 0" damping="0.1"/><geom type="box" size="0.04 0.02 0.02"/>'
    return ('<mujoco><option><flag contact="disable"/></option><worldbody><body pos="0 0 20"><freejoint/>'
            '<geom type="box" size="0.1 0.1 0.1"/>' + link * (bodies - 1) + "</body>" * bodies + "</worldbody></mujoco>")


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--run", default=str(ROOT / "build/release"), help="build folder with the module")
    arguments.add_argument("--steps", type=int, default=500)
    options = arguments.parse_args()
    sys.path.insert(0, str(Path(options.run) / "python"))
    import mujoco
    import simvis
    import simvis.mujoco

    print("bodies,mujoco_us,update_us,simvis_us")
    for bodies in BODIES:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "chain.xml"
            file.write_text(chain(bodies))
            model = mujoco.MjModel.from_xml_path(str(file))
            sim = simvis.Simulation.from_string(
                f'<part name="CHAIN" insert_at="ROOT" file="{file}"/>'
                '<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" pose_offset="-3 0 20 0 0 0" samples="361" '
                'min_angle="-90" max_angle="90"/>')
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        followed = simvis.mujoco.follow(sim, model, data)

        def move() -> None:
            mujoco.mj_step(model, data)
            mujoco.mj_kinematics(model, data)

        times: list[list[float]] = [[], [], []]
        for _ in range(options.steps):
            for call, own in zip((move, followed.update, sim.step), times, strict=True):
                start = time.perf_counter()
                call()
                own.append(time.perf_counter() - start)
        print(f"{bodies}," + ",".join(f"{1e6 * statistics.median(own):.0f}" for own in times))


if __name__ == "__main__":
    main()
