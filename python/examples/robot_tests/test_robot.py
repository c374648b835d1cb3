"""The robot's software in a simulated room. ROBOT_BUG=1 tests the follower that has a bug, so that a test fails."""
import math
import os

import numpy as np
import pytest
from robot import FollowerWithBug, Mapper, WallFollower, Wheels

import simvis
from simvis import testing

ROBOT_RADIUS_M = 0.2
START = np.array([-2.0, -1.2, 0.0])


class FollowerState(simvis.CustomElement, type="follower_state", summary="What the follower decides by, for graphs and recordings."):
    attributes = [simvis.Attribute("ahead", 0, "m", "how far the way ahead is free", live=True),
                  simvis.Attribute("speed", 0, "m/s", "forward speed", live=True)]

    def update(self, values) -> None:
        """It moves nothing."""


class Robot:
    """The software, its wheels and its place in the scene."""

    def __init__(self, sim, seed: int = 0) -> None:
        moved = np.random.default_rng(seed).uniform(-0.1, 0.1, 3) if seed else np.zeros(3)
        self.follower = FollowerWithBug() if os.environ.get("ROBOT_BUG") else WallFollower()
        self.wheels = Wheels(*(START + moved))
        sim.execute('<element type="follower_state" name="FOLLOWER" insert_at="ROOT"/>')
        self.place(sim)

    def place(self, sim) -> None:
        sim["R_POSE"].set(x=self.wheels.x, y=self.wheels.y, yaw=math.degrees(self.wheels.yaw))

    def act(self, sim) -> None:
        ranges = sim["SCANNER"].range_m[0]
        speed, turn = self.follower.drive(ranges)
        self.wheels.move(speed, turn, seconds=1 / 15)
        self.place(sim)
        sim["FOLLOWER"].set(ahead=self.follower.ahead(ranges), speed=speed)


@pytest.mark.simvis_seeds(3)
def test_keeps_clear_of_everything(simvis_run, simvis_seed):
    run = simvis_run("room.xml", limit_s=25, seed=simvis_seed)
    run.always(lambda sim: testing.clear_of(sim["SCANNER"], ROBOT_RADIUS_M + 0.05), "the robot keeps 5 cm away")
    robot = Robot(run.sim, simvis_seed)
    for sim in run:
        robot.act(sim)


def test_reaches_the_other_corner(simvis_run):
    run = simvis_run("room.xml", limit_s=60)
    robot = Robot(run.sim)
    run.until(lambda sim: math.hypot(sim["R_POSE"].x - 2, sim["R_POSE"].y - 1) < 0.7, robot.act, "the corner at (2, 1)")


def test_the_map_has_the_walls(simvis_run):
    run = simvis_run("room.xml", limit_s=8)
    robot, mapper = Robot(run.sim), Mapper()
    for sim in run:
        points = sim["SCANNER"].points("world")
        mapper.add(points[np.isfinite(points[:, 0])][:, :2])
        robot.act(sim)
    walls = [(-3, -2), (3, -2), (3, 2), (-3, 2), (-3, -2)]
    half_diagonal_m = mapper.cell_m * math.sqrt(0.5)
    for cell in mapper.occupied():
        post = math.hypot(cell[0] - 0.4, cell[1] + 1.02) < 0.06 + half_diagonal_m
        on_wall = testing.near_path(cell, walls, half_diagonal_m)
        assert on_wall or post


def test_ranges_of_the_first_frame(simvis_run):
    run = simvis_run("room.xml", limit_s=1)
    run.step()
    assert testing.range_near(run.sim["SCANNER"], 0.8, beam=0)                                # the south wall, beside it
    assert testing.range_near(run.sim["SCANNER"], 3.2, beam=180)                              # the north wall
    assert testing.range_near(run.sim["SCANNER"], 5.0, beam=90)                               # the east wall, ahead
    assert testing.range_near(run.sim["SCANNER"], 0.8 / math.cos(math.radians(30)), beam=30)  # the south wall at -60 deg
