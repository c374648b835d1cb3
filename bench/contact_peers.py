#!/usr/bin/env python3
"""Contacts of pybullet in the trials of bench/contact_matrix.cpp: `bench/contact_peers.py [STEP_MS...]`, 1 and 4 without one.

The interpreter needs the package `pybullet`. Bodies are rigid bodies (useMaximalCoordinates) without damping, with the
masses, frictions, passes and starts of the C++ program. Prints the same CSV, for the bodies and floors that pybullet has as
shapes of its own; the carrier is `pybullet`.
"""
import math
import sys

import pybullet as pb

GRAVITY, MASS, PASSES = 9.80665, 0.5, 50


def cube(half: float, at: tuple[float, float, float] = (0, 0, 0)) -> list[list[float]]:
    return [[at[0] + half * x, at[1] + half * y, at[2] + half * z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]


def mesh(cells: int, half: float) -> int:
    points = [[-half + 2 * half * i / cells, -half + 2 * half * j / cells, 0] for j in range(cells + 1)
              for i in range(cells + 1)]
    corners = []
    for j in range(cells):
        for i in range(cells):
            a = j * (cells + 1) + i
            corners += [a, a + 1, a + cells + 2, a, a + cells + 2, a + cells + 1]
    return pb.createCollisionShape(pb.GEOM_MESH, vertices=points, indices=corners)


def table() -> int:
    legs = [(x, y, -0.02) for x in (-0.08, 0.08) for y in (-0.08, 0.08)]
    return pb.createCollisionShapeArray(
        shapeTypes=[pb.GEOM_BOX] * 5, halfExtents=[[0.1, 0.1, 0.02]] + [[0.02, 0.02, 0.08]] * 4,
        collisionFramePositions=[(0, 0, 0.08), *legs])


LYING = pb.getQuaternionFromEuler([math.pi / 2, 0, 0])
ALONG_X = pb.getQuaternionFromEuler([0, math.pi / 2, 0])
# Name: the shape, the height of its centre, and the moment of inertia of what rolls over m r^2.
BODIES = {
    "box": (lambda: pb.createCollisionShape(pb.GEOM_BOX, halfExtents=[0.1] * 3), 0.1, 0),
    "sphere": (lambda: pb.createCollisionShape(pb.GEOM_SPHERE, radius=0.1), 0.1, 0.4),
    "cylinder": (lambda: pb.createCollisionShape(pb.GEOM_CYLINDER, radius=0.1, height=0.2), 0.1, 0),
    "lying cyl": (lambda: pb.createCollisionShape(pb.GEOM_CYLINDER, radius=0.1, height=0.2,
                                                  collisionFrameOrientation=LYING), 0.1, 0.5),
    "capsule": (lambda: pb.createCollisionShape(pb.GEOM_CAPSULE, radius=0.05, height=0.16,
                                                collisionFrameOrientation=ALONG_X), 0.05, 0),
    "hull": (lambda: pb.createCollisionShape(pb.GEOM_MESH, vertices=cube(0.1)), 0.1, 0),
    "table": (table, 0.1, 0),
    "hull 1 cm": (lambda: pb.createCollisionShape(pb.GEOM_MESH, vertices=cube(0.005)), 0.005, 0),
}
FLOORS = {
    "box": lambda: pb.createCollisionShape(pb.GEOM_BOX, halfExtents=[20, 20, 0.5],
                                           collisionFramePosition=[0, 0, -0.5]),
    "mesh 2": lambda: mesh(1, 20),
    "mesh 5cm": lambda: mesh(160, 4),
    "plane": lambda: pb.createCollisionShape(pb.GEOM_PLANE),
}


class Trial:
    def __init__(self, body: str, floor: str, step_s: float, height_m: float = 0, friction: float = 0.5,
                 restitution: float = 0, turn_deg: tuple[float, float] = (0, 0),
                 gravity: tuple[float, float, float] = (0, 0, -GRAVITY)):
        make, center_m, rolls = BODIES[body]
        pb.resetSimulation()
        pb.setGravity(*gravity)
        pb.setPhysicsEngineParameter(fixedTimeStep=step_s, numSolverIterations=PASSES)
        ground = pb.createMultiBody(0, FLOORS[floor](), useMaximalCoordinates=True)
        pb.changeDynamics(ground, -1, lateralFriction=1, restitution=1)
        about_x = pb.getQuaternionFromEuler([math.radians(turn_deg[0]), 0, 0])
        about_y = pb.getQuaternionFromEuler([0, math.radians(turn_deg[1]), 0])
        turn = pb.multiplyTransforms([0, 0, 0], about_x, [0, 0, 0], about_y)[1]
        self.id = pb.createMultiBody(MASS, make(), basePosition=[0.013, 0.007, center_m + height_m],
                                     baseOrientation=turn, useMaximalCoordinates=True)
        edge_m = 0.01 if body == "hull 1 cm" else 0.2
        self.moment = rolls * MASS * center_m**2 if rolls else MASS * edge_m**2 / 6
        pb.changeDynamics(self.id, -1, mass=MASS, linearDamping=0, angularDamping=0, lateralFriction=friction,
                          restitution=restitution, localInertiaDiagonal=[self.moment] * 3)
        self.step_s, self.gravity, self.turn = step_s, gravity, turn

    def place(self) -> tuple[float, float, float]:
        return pb.getBasePositionAndOrientation(self.id)[0]

    def tilt_deg(self) -> float:
        turn = pb.getBasePositionAndOrientation(self.id)[1]
        away = pb.getDifferenceQuaternion(self.turn, turn)
        up_z = pb.getMatrixFromQuaternion(away)[8]
        return math.degrees(math.acos(min(1, up_z)))

    def energy(self) -> float:
        speed, spin = pb.getBaseVelocity(self.id)
        dot = lambda a, b: sum(x * y for x, y in zip(a, b))
        return (MASS * dot(speed, speed) / 2 + self.moment * dot(spin, spin) / 2 - MASS * dot(self.gravity, self.place()) +
                MASS * self.step_s / 2 * dot(self.gravity, speed))


def measure(body: str, floor: str, step_s: float) -> list[float]:
    _, center_m, rolls = BODIES[body]
    steps = lambda seconds: range(int(seconds / step_s))
    trial, rebound, tilt = Trial(body, floor, step_s, height_m=1), 0.0, 0.0
    for i in steps(1.2):
        pb.stepSimulation()
        if i * step_s < math.sqrt(2 / GRAVITY) + 2.5 * step_s:
            continue
        rebound = max(rebound, trial.place()[2] - center_m)
        tilt = tilt if rolls else max(tilt, trial.tilt_deg())
    aside = math.dist(trial.place()[:2], (0.013, 0.007))
    trial = Trial(body, floor, step_s)
    start, moved = trial.place(), 0.0
    for _ in steps(2):
        pb.stepSimulation()
        moved = max(moved, math.dist(trial.place(), start))
    angle, time_s = math.atan(0.5) + math.radians(2), 0.5
    trial = Trial(body, floor, step_s, friction=1 if rolls else 0.5,
                  gravity=(GRAVITY * math.sin(angle), 0, -GRAVITY * math.cos(angle)))
    start = trial.place()
    for _ in range(round(time_s / step_s)):
        pb.stepSimulation()
    along = math.sin(angle) / (1 + rolls) if rolls else math.sin(angle) - 0.5 * math.cos(angle)
    way = (trial.place()[0] - start[0]) / (GRAVITY * along * time_s * (time_s + step_s) / 2)
    slope_aside = abs(trial.place()[1] - start[1])
    worst = 0.0
    for friction in (0.0, 0.7):
        for turn in ((1, 2), (30, 20), (45, 35.264)):
            trial = Trial(body, floor, step_s, 1, friction, 1, turn)
            first = trial.energy()
            for _ in steps(2):
                pb.stepSimulation()
                worst = max(worst, trial.energy() / first)
    return [rebound * 1e3, tilt, aside * 1e3, moved * 1e3, way, slope_aside * 1e3, worst]


def main() -> None:
    pb.connect(pb.DIRECT)
    print("carrier,body,floor,step_ms,rebound_mm,tilt_deg,aside_mm,rest_mm,slope_share,slope_aside_mm,energy_share")
    for step_ms in [float(text) for text in sys.argv[1:]] or [1.0, 4.0]:
        for body in BODIES:
            for floor in FLOORS:
                values = ",".join(f"{value:.5f}" for value in measure(body, floor, step_ms * 1e-3))
                print(f"pybullet,{body},{floor},{step_ms:g},{values}", flush=True)


if __name__ == "__main__":
    main()
