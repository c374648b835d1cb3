#!/usr/bin/env python3
"""One second of robots that others made, beside MuJoCo (MJCF) and pybullet (URDF): `bench/robots_of_others.py [NAME...]`.

The interpreter needs the module `simvis` of a build (PYTHONPATH=build/release/python) and NumPy, and of the packages
`mujoco`, `gymnasium`, `robosuite`, `dm_control` and `pybullet` those whose models are compared (README.md says how). Nothing
is changed in the files. NAME is a model of the table below, such as gymnasium/ant; without one, all are compared.

MJCF      an element `models` in the file's own world, with its gravity and step; MuJoCo with the file as it is, except that
          its Runge-Kutta steps become its Euler steps, which are those of SimVis. The control value of all actuators is 0.
URDF      an element `robot` without drives; in pybullet, the default motors are off and its own damping is 0. Both take
          steps of 1 ms, the inertia of the file, and the friction that SimVis has. Arms and the cart are fixed 2 m above
          the floor, the others fall freely on it from 1 cm.
Start     the pose of the file, with joints that are beyond a limit there at the limit. Robots that stand still there
          start with all hinges and slides 0.3 rad or m further.
Measures  over all links that both name: the distance of the origins of the links, in mm, and the angle between their
          frames, in degrees. The largest of all links counts, after 0.1 s and after 1 s. `way_mm` is how far the farthest
          link of the peer has come by then. `stiff_mm` is the distance from MuJoCo with contacts and limits that hardly give
          way, where those of the file sink in by millimetres. `peer_mm` is the distance between the peer and the peer with
          half the step: how well the motion is determined at all.

Prints CSV: model, links, way_mm, apart_100ms_mm, apart_mm, stiff_mm, turned_deg, peer_mm, farthest, warnings, message."""
import argparse
import csv
import importlib.util
import math
import os
import re
import sys
from pathlib import Path
from typing import Callable
from xml.sax.saxutils import quoteattr

import numpy as np

import simvis

MJCF = {
    "gymnasium": ("envs/mujoco/assets", "ant half_cheetah hopper humanoid inverted_double_pendulum walker2d_v5"),
    "dm_control": ("suite", "acrobot ball_in_cup cheetah finger humanoid humanoid_CMU manipulator quadruped"),
    "robosuite": ("models/assets/robots", "iiwa/robot kinova3/robot panda/robot sawyer/robot spot/robot ur5e/robot"),
}
FIXED_URDF = "cartpole franka_panda/panda kuka_iiwa/model xarm/xarm6_robot pr2_gripper"
FREE_URDF = ("a1/a1 aliengo/aliengo laikago/laikago mini_cheetah/mini_cheetah quadruped/minitaur quadruped/spirit40 "
             "quadruped/vision60 r2d2 racecar/racecar")
STAND_STILL = ("gymnasium/inverted_double_pendulum", "dm_control/acrobot", "dm_control/finger", "pybullet/cartpole")
START_RAD_M = 0.3
TIMES_S = (0.1, 1.0)
RATE_HZ = 10
URDF_STEP_S, PASSES, FRICTION, HEIGHT_M, DROP_M = 1e-3, 50, 0.5, 2.0, 0.01
COLUMNS = ("model", "links", "way_mm", "apart_100ms_mm", "apart_mm", "stiff_mm", "turned_deg", "peer_mm", "farthest",
           "warnings", "message")
Poses = list[dict[str, np.ndarray]]  # for each time the world_from_link of each link


def folder_of(package: str) -> Path | None:
    """Where a package lies. It is not imported, so what it needs itself may be missing."""
    found = importlib.util.find_spec(package)
    return Path(found.submodule_search_locations[0]) if found else None


def pose_of(place, matrix) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = np.reshape(matrix, (3, 3)), place
    return pose


def own_poses(scene: str, links: list[str], start: dict[str, float]) -> tuple[Poses, list[str]]:
    """The poses of links in SimVis, and the warnings. `start` has values of joints, in degrees or m."""
    sensors = "".join(f'<sensor type="odometry" name="LINK{i}" insert_at={quoteattr(link)}/>\n'
                      for i, link in enumerate(links))
    poses = []
    with simvis.Simulation.from_string(f"<simvis>\n{scene}{sensors}</simvis>", rate_hz=RATE_HZ) as simulation:
        for joint, value in start.items():
            simulation.set(joint, "value", value)
        for frame in range(round(TIMES_S[-1] * RATE_HZ) + 1):
            simulation.step()
            if any(math.isclose(frame / RATE_HZ, time_s) for time_s in TIMES_S):
                poses.append({link: np.array(simulation[f"LINK{i}"].pose) for i, link in enumerate(links)})
        return poses, list(simulation.warnings)


def clamped(value: float, lower: float, upper: float) -> float:
    return min(max(value, lower), upper) if lower <= upper else value


class Mjcf:
    def __init__(self, file: Path, start: float):
        import mujoco
        self.mujoco, self.file = mujoco, file
        self.model = mujoco.MjModel.from_xml_path(str(file))
        if self.model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
            self.model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
        self.links = [name for i in range(1, self.model.nbody) if (name := self.model.body(i).name)]
        self.start = {}  # of each joint that starts elsewhere than the file says: MuJoCo's value, and that of SimVis
        for joint in (self.model.joint(i) for i in range(self.model.njnt)):
            turns = int(joint.type[0]) == int(mujoco.mjtJoint.mjJNT_HINGE)
            if not turns and int(joint.type[0]) != int(mujoco.mjtJoint.mjJNT_SLIDE):
                continue
            zero = float(joint.qpos0[0])
            value = clamped(zero + start, *joint.range) if joint.limited[0] else zero + start
            if value != zero:
                self.start[joint.name] = value, math.degrees(value - zero) if turns else value - zero

    def stiffen(self) -> None:
        """Constraints give way as little as the step allows, for all that follows."""
        model = self.model
        for solref in (model.geom_solref, model.jnt_solref, model.eq_solref, model.dof_solref, model.tendon_solref_lim):
            solref[:] = 2 * model.opt.timestep, 1
        for solimp in (model.geom_solimp, model.jnt_solimp, model.eq_solimp, model.dof_solimp, model.tendon_solimp_lim):
            solimp[:] = 0.99, 0.999, 0.001, 0.5, 2
        model.geom_margin[:] = model.geom_gap[:] = 0
        model.opt.cone, model.opt.impratio = self.mujoco.mjtCone.mjCONE_ELLIPTIC, 10
        model.opt.solver, model.opt.iterations = self.mujoco.mjtSolver.mjSOL_NEWTON, 200

    def peer(self, steps: int) -> Poses:
        """With so many steps in place of each."""
        mujoco, model = self.mujoco, self.model
        data, poses, step_s = mujoco.MjData(model), [], model.opt.timestep
        for joint, (value, _) in self.start.items():
            data.joint(joint).qpos = value
        model.opt.timestep = step_s / steps
        for time_s in (0.0, *TIMES_S):
            while data.time + model.opt.timestep < time_s + 1e-9:
                mujoco.mj_step(model, data)
            mujoco.mj_kinematics(model, data)
            poses.append({link: pose_of(data.body(link).xpos, data.body(link).xmat) for link in self.links})
        model.opt.timestep = step_s
        return poses

    def own(self) -> tuple[Poses, list[str]]:
        return own_poses(f'<part name="WORLD" insert_at="ROOT" file={quoteattr(str(self.file))}/>\n'
                         '<element type="physics" name="PHYSICS" insert_at="ROOT" world="WORLD"/>\n'
                         '<element type="models" name="MODELS" insert_at="WORLD"/>\n', self.links,
                         {joint: value for joint, (_, value) in self.start.items()})


class Urdf:
    def __init__(self, file: Path, is_fixed: bool, start: float):
        import pybullet
        self.pybullet, self.file, self.is_fixed = pybullet, file, is_fixed
        self.start, self.height_m = start, 0.0
        pybullet.connect(pybullet.DIRECT)
        robot = self.load()
        lowest_m = min(pybullet.getAABB(robot, i)[0][2] for i in range(-1, pybullet.getNumJoints(robot)))
        self.height_m = HEIGHT_M if is_fixed else DROP_M - lowest_m
        self.links = [pybullet.getBodyInfo(robot)[0].decode(), *(joint[12].decode() for joint in self.joints)]
        pybullet.disconnect()

    def load(self) -> int:
        p = self.pybullet
        robot = p.loadURDF(str(self.file), useFixedBase=self.is_fixed, flags=p.URDF_USE_INERTIA_FROM_FILE)
        # pybullet places the centre of mass of the root link, SimVis the origin of the file.
        center, turn = p.getDynamicsInfo(robot, -1)[3:5]
        p.resetBasePositionAndOrientation(robot, [center[0], center[1], center[2] + self.height_m], turn)
        self.joints = [p.getJointInfo(robot, i) for i in range(p.getNumJoints(robot))]
        self.moving = [joint for joint in self.joints if joint[2] in (p.JOINT_REVOLUTE, p.JOINT_PRISMATIC)]
        for joint in self.moving:
            p.resetJointState(robot, joint[0], clamped(self.start, *joint[8:10]))
        return robot

    def stiffen(self) -> None:
        """Bullet's constraints are stiff."""

    def peer(self, steps: int) -> Poses:
        p = self.pybullet
        p.connect(p.DIRECT)
        p.setGravity(0, 0, -9.80665)
        p.setPhysicsEngineParameter(fixedTimeStep=URDF_STEP_S / steps, numSolverIterations=PASSES)
        floor = p.createMultiBody(0, p.createCollisionShape(p.GEOM_BOX, halfExtents=[20, 20, 1]), basePosition=[0, 0, -1])
        robot = self.load()
        for body, link in ((floor, -1), *((robot, i) for i in range(-1, len(self.joints)))):
            p.changeDynamics(body, link, linearDamping=0, angularDamping=0, lateralFriction=FRICTION, rollingFriction=0,
                             spinningFriction=0, restitution=0)
        for joint in self.moving:  # the motor's largest force stands for the friction of the file
            p.setJointMotorControl2(robot, joint[0], p.VELOCITY_CONTROL, targetVelocity=0, force=joint[7])
        for joint in self.joints:
            if joint[2] == p.JOINT_SPHERICAL:
                p.setJointMotorControlMultiDof(robot, joint[0], p.POSITION_CONTROL, targetPosition=[0, 0, 0, 1],
                                               positionGain=0, velocityGain=0, force=[0, 0, 0])
        poses = [self.places(robot)]
        for step in range(1, round(TIMES_S[-1] / URDF_STEP_S) * steps + 1):
            p.stepSimulation()
            if any(math.isclose(step * URDF_STEP_S / steps, time_s) for time_s in TIMES_S):
                poses.append(self.places(robot))
        p.disconnect()
        return poses

    def places(self, robot: int) -> dict[str, np.ndarray]:
        p = self.pybullet
        place, turn = p.getBasePositionAndOrientation(robot)
        center, axes = p.getDynamicsInfo(robot, -1)[3:5]
        place, turn = p.multiplyTransforms(place, turn, *p.invertTransform(center, axes))
        poses = {self.links[0]: pose_of(place, p.getMatrixFromQuaternion(turn))}
        for i in range(len(self.joints)):
            state = p.getLinkState(robot, i, computeForwardKinematics=1)
            poses[self.links[i + 1]] = pose_of(state[4], p.getMatrixFromQuaternion(state[5]))
        return poses

    def own(self) -> tuple[Poses, list[str]]:
        start = {}
        for joint in self.moving if self.start else ():
            value = clamped(self.start, *joint[8:10])
            start[joint[1].decode()] = math.degrees(value) if joint[2] == self.pybullet.JOINT_REVOLUTE else value
        return own_poses(
            f'<element type="physics" name="PHYSICS" insert_at="ROOT" step="{1e3 * URDF_STEP_S:g}" iterations="{PASSES}"/>\n'
            '<part name="FLOOR" insert_at="ROOT" shape="box" size="40 40 2" pose_offset="0 0 -1 0 0 0"/>\n'
            '<element type="body" name="FLOOR_BODY" insert_at="FLOOR" kind="static" shape="box" '
            f'friction="{FRICTION}"/>\n'
            f'<part name="ROBOT" insert_at="ROOT" file={quoteattr(str(self.file))} '
            f'pose_offset="0 0 {self.height_m} 0 0 0"/>\n'
            f'<element type="robot" name="LINKS" insert_at="ROBOT" control="none" friction="{FRICTION}" '
            f'base="{"fixed" if self.is_fixed else "free"}"/>\n', self.links, start)


def apart(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> tuple[float, float, str]:
    """Of two sets of poses: the largest distance in mm, the largest angle in degrees, and the link that is farthest."""
    distances = {link: 1e3 * float(np.linalg.norm(a[link][:3, 3] - b[link][:3, 3])) for link in a}
    # The chord of the turn, which is exact for small angles too.
    chord = max(float(np.linalg.norm(a[link][:3, :3] - b[link][:3, :3])) for link in a)
    farthest = max(distances, key=distances.get)
    return distances[farthest], math.degrees(2 * math.asin(min(1, chord / math.sqrt(8)))), farthest


def compared(make: Callable[[], Mjcf | Urdf]) -> dict[str, object]:
    try:
        model = make()
        peer, halves = model.peer(steps=1), model.peer(steps=2)
        own, warnings = model.own()
        model.stiffen()
        stiff = model.peer(steps=1)
    except (simvis.Error, ValueError, RuntimeError) as error:
        return {"message": str(error).splitlines()[0]}
    distance_mm, turned_deg, farthest = apart(peer[-1], own[-1])
    return {"links": len(model.links),
            "way_mm": f"{apart(peer[0], peer[-1])[0]:.0f}",
            "apart_100ms_mm": f"{apart(peer[1], own[0])[0]:.2g}",
            "apart_mm": f"{distance_mm:.2g}",
            "stiff_mm": f"{apart(stiff[-1], own[-1])[0]:.2g}",
            "turned_deg": f"{turned_deg:.2g}",
            "peer_mm": f"{apart(peer[-1], halves[-1])[0]:.2g}",
            "farthest": farthest,
            "warnings": len(warnings),
            "message": "; ".join(re.sub(r"^\S+: (warning: )?", "", each) for each in warnings)}


def models() -> dict[str, Callable[[], Mjcf | Urdf] | str]:
    """Maps the name of each model to the function that makes it, or to the reason why it cannot be had."""
    def start(name: str) -> float:
        return START_RAD_M if name in STAND_STILL else 0.0

    found = {}
    for package, (below, names) in MJCF.items():
        folder = folder_of(package)
        for file in names.split():
            name = f"{package}/{file.removesuffix('/robot')}"
            found[name] = (lambda f=folder / below / f"{file}.xml", s=start(name): Mjcf(f, s)) \
                if folder and folder_of("mujoco") else f"{package} or mujoco is not installed"
    folder = folder_of("pybullet_data")
    for names, is_fixed in ((FIXED_URDF, True), (FREE_URDF, False)):
        for file in names.split():
            name = f"pybullet/{file}"
            found[name] = (lambda f=folder / f"{file}.urdf", b=is_fixed, s=start(name): Urdf(f, b, s)) \
                if folder else "pybullet is not installed"
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    arguments = parser.parse_args()
    every = models()
    if unknown := set(arguments.names) - set(every):
        parser.error(f"no model {', '.join(sorted(unknown))}; there are {', '.join(every)}")
    # pybullet prints on the standard output, which has the table alone.
    with os.fdopen(os.dup(sys.stdout.fileno()), "w") as out:
        os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
        table = csv.DictWriter(out, COLUMNS)
        table.writeheader()
        for name in arguments.names or every:
            make = every[name]
            table.writerow({"model": name} | ({"message": make} if isinstance(make, str) else compared(make)))
            out.flush()


if __name__ == "__main__":
    main()
