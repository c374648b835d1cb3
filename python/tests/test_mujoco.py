"""simvis.mujoco: links stand where MuJoCo, or an array, has them."""
import subprocess
import sys
import tempfile
import unittest
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import simvis
import simvis.mujoco

if find_spec("mujoco"):
    import mujoco

# Bodies that are free, welded, jointed, without a name, turned by a ball, in a frame, driven by mocap, and nested; a site
# with the name of a body; a geom of the world.
MODEL = """<mujoco model="tried">
  <compiler angle="degree"/>
  <worldbody>
    <geom name="floor" type="plane" size="9 9 1"/>
    <body name="base" pos="0 0 1" euler="10 20 30">
      <freejoint name="root"/>
      <site name="tip" pos="0.1 0 0"/>
      <geom type="box" size="0.3 0.2 0.1" mass="2"/>
      <body name="welded" pos="0.2 0 0.1" euler="0 0 45">
        <geom type="sphere" size="0.05" mass="0.1"/>
        <body pos="0.1 0.2 0">
          <joint name="hinge" axis="0 1 1" pos="0.05 0 0" range="20 60"/>
          <joint name="slide" type="slide" axis="1 0 0"/>
          <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.03" mass="0.2"/>
          <frame pos="0.2 0 0" euler="0 90 0">
            <body name="tip"><joint name="ball" type="ball"/><geom type="box" size="0.1 0.05 0.02" mass="0.1"/></body>
          </frame>
        </body>
      </body>
    </body>
    <body name="hand" mocap="true" pos="1 0 1"><geom type="box" size="0.1 0.1 0.1" contype="0" conaffinity="0"/>
      <body name="finger" pos="0.2 0 0"><geom type="sphere" size="0.05" contype="0" conaffinity="0"/></body></body>
    <body><joint name="mast" axis="0 0 1"/><geom type="box" pos="0 3 0.5" size="0.1 0.1 0.5" mass="1"/></body>
  </worldbody>
</mujoco>"""
SCENE = """<part name="TRIED" insert_at="ROOT" file="tried.xml" pose_offset="0.5 -1 0.2 5 6 70"/>
<part name="WALL" insert_at="ROOT" shape="box" size="0.2 20 20" pose_offset="6 0 0 0 0 0"/>
<sensor type="range" name="RANGE" insert_at="ROOT" pose_offset="0 0 0 0 0 0"/>"""

# A chain of four links of some metres: each of its products of matrices and its angles is rounded by some 2^-52.
POSE_ERROR = 1e-12


def pose_of(place: Any, quaternion: Any) -> Any:
    w, x, y, z = quaternion
    pose = np.eye(4)
    pose[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    pose[:3, 3] = place
    return pose


class Scene(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "tried.xml").write_text(MODEL)

    def load(self, scene: str = SCENE) -> simvis.Simulation:
        return simvis.Simulation.from_string(scene, folder=self.folder)

    def expect(self, message: str, call: Any) -> None:
        with self.assertRaisesRegex(simvis.InputError, message):
            call()

    def near(self, sim: simvis.Simulation, link: str, expected: Any) -> None:
        got = sim.part_pose(link)
        self.assertIsNotNone(got)
        self.assertLess(np.abs(got - expected).max(), POSE_ERROR, link)


class Poses(Scene):
    """What an array does. MuJoCo is not needed."""

    def test_links_and_parts_stand_where_the_array_says(self) -> None:
        random = np.random.default_rng(1)
        for part, names in ((None, ["tip_2", "base", "WALL", "finger"]), ("TRIED", ["finger", "welded", "base"])):
            sim = self.load()
            for name in [*names, "TRIED"]:
                sim.track_part(name)
            quaternions = random.normal(size=(len(names), 4))
            quaternions[0] = [np.sqrt(0.5), 0, np.sqrt(0.5), 0]  # it looks straight down
            quaternions /= np.linalg.norm(quaternions, axis=1)[:, None]
            poses = np.concatenate([random.uniform(-3, 3, size=(len(names), 3)), quaternions], axis=1)
            followed = simvis.mujoco.follow(sim, names, poses, part=part)
            self.assertEqual(followed.names, names)
            for turn in range(3):
                sim.step()
                base = sim.part_pose("TRIED") if part else np.eye(4)
                for name, pose in zip(names, poses, strict=True):
                    self.near(sim, name, base @ pose_of(pose[:3], pose[3:]))
                poses[:, :3] += 0.1 * (turn + 1)
                poses[:, 3:] = np.roll(poses[:, 3:], 1, axis=1)
                followed.update()

    def test_matrices_are_as_good_as_quaternions(self) -> None:
        matrices = np.array([pose_of([1, 2, 3], [0.5, 0.5, -0.5, 0.5]), pose_of([0, 0, 0], [0, 0, 0, 1])])
        sim = self.load()
        sim.track_part("base")
        sim.track_part("hand")
        simvis.mujoco.follow(sim, ["base", "hand"], matrices)
        sim.step()
        self.near(sim, "base", matrices[0])
        self.near(sim, "hand", matrices[1])

    def test_poses_of_any_kind_are_read_at_each_update(self) -> None:
        first, second = pose_of([1, 2, 3], [0.5, 0.5, -0.5, 0.5]), pose_of([0.5, 0, 2], [0, 0, 0, 1])
        seven = ([1, 2, 3, 0.5, 0.5, -0.5, 0.5], [0.5, 0, 2, 0, 0, 0, 1])
        for before, after in ((first, second), seven):
            for poses in (np.array([before]), np.array([before], np.float32), np.array([before]).tolist(),
                          memoryview(np.array([before]))):
                with self.subTest(type=type(poses), size=np.shape(before)):
                    sim = self.load()
                    sim.track_part("base")
                    followed = simvis.mujoco.follow(sim, ["base"], poses)
                    sim.step()
                    self.near(sim, "base", first)
                    if isinstance(poses, list):
                        poses[0] = np.array(after).tolist()
                    else:
                        np.asarray(poses)[0] = after
                    followed.update()
                    sim.step()
                    self.near(sim, "base", second)

    def test_matrices_that_are_almost_rotations_become_some(self) -> None:
        # Each may be off by 1e-6. Their products along a chain would be no rotations.
        poses = np.array([pose_of([i, 0, 0], [1, 0, 0, 0]) for i in range(3)])
        poses[:, 0, 0] *= [1 + 4e-7, 1 - 4e-7, 1 + 4e-7]
        sim = self.load()
        for name in ("base", "welded", "tip_2"):
            sim.track_part(name)
        simvis.mujoco.follow(sim, ["base", "welded", "tip_2"], poses)
        sim.step()
        for i, name in enumerate(("base", "welded", "tip_2")):
            self.near(sim, name, pose_of([i, 0, 0], [1, 0, 0, 0]))

    def test_values_that_were_just_set_count(self) -> None:
        sim = self.load()
        sim.set("slide", "value", 0.7)
        sim.track_part("tip_2")
        pose = pose_of([1, 2, 3], [0.5, 0.5, -0.5, 0.5])
        simvis.mujoco.follow(sim, ["base", "tip_2"], np.array([np.eye(4), pose]))
        sim.step()
        self.near(sim, "tip_2", pose)

    def test_all_that_stands_at_a_link_moves_along(self) -> None:
        # On the link itself before and after it is followed, on one behind it, and on a part that it carries.
        sim = self.load(SCENE + '<sensor type="range" name="OWN" insert_at="hand" pose_offset="0.5 0 0 0 0 0"/>'
                        '<sensor type="range" name="BEHIND" insert_at="finger"/>'
                        '<part name="HAT" insert_at="hand" pose_offset="0.3 0 0 0 0 0"/>'
                        '<sensor type="range" name="CARRIED" insert_at="HAT"/>')
        for name in ("finger", "HAT"):
            sim.track_part(name)
        simvis.mujoco.follow(sim, ["hand"], np.array([pose_of([1, 2, 3], [1, 0, 0, 0])]))
        sim.execute('<sensor type="range" name="LATER" insert_at="hand" pose_offset="0.6 0 0 0 0 0"/>')
        sim.step()
        self.near(sim, "finger", pose_of([1.2, 2, 3], [1, 0, 0, 0]))
        self.near(sim, "HAT", pose_of([1.3, 2, 3], [1, 0, 0, 0]))
        for sensor, x in (("OWN", 1.5), ("BEHIND", 1.2), ("CARRIED", 1.3), ("LATER", 1.6)):
            self.assertAlmostEqual(sim[sensor].value("range_m"), 5.9 - x, 6)

    def test_a_carried_part_may_be_followed_with_its_carrier(self) -> None:
        sim = self.load(SCENE + '<part name="HAT" insert_at="hand" pose_offset="0.3 0 0 10 20 30"/>')
        for name in ("hand", "HAT"):
            sim.track_part(name)
        poses = np.array([pose_of([1, 2, 3], [0.5, 0.5, -0.5, 0.5]), pose_of([-1, 0, 2], [0, 0, 0, 1])])
        simvis.mujoco.follow(sim, ["HAT", "hand"], poses)
        sim.step()
        self.near(sim, "HAT", poses[0])
        self.near(sim, "hand", poses[1])

    def test_mistakes(self) -> None:
        sim = self.load()
        one = np.array([[0, 0, 0, 1, 0, 0, 0.0]])
        changes = list(sim.changes)
        self.expect('there is no part or link "hnad", did you mean "hand"', lambda: simvis.mujoco.follow(sim, ["hnad"], one))
        self.expect(r"shape \(1, 7\), expected \(2, 7\) or \(2, 4, 4\) for 2 names",
                    lambda: simvis.mujoco.follow(sim, ["hand", "base"], one))
        self.expect("named twice", lambda: simvis.mujoco.follow(sim, ["hand", "hand"], np.tile(one, (2, 1))))
        self.expect("a quaternion of length 1", lambda: simvis.mujoco.follow(sim, ["hand"], 0 * one))
        self.expect("a rotation and a translation",
                    lambda: simvis.mujoco.follow(sim, ["hand"], np.diag([-1.0, 1, 1, 1])[None]))
        far = np.array([[0, 0, 0, 1, 0, 0, 0], [2e15, 0, 0, 1, 0, 0, 0.0]])
        self.expect("coordinates of at most 1e15 m", lambda: simvis.mujoco.follow(sim, ["hand", "base"], far))
        apart = np.array([pose_of([x, 0, 0], [1, 0, 0, 0]) for x in (-9e14, 9e14)])
        self.expect("coordinates of at most 1e15 m", lambda: simvis.mujoco.follow(sim, ["base", "welded"], apart))
        self.expect("the poses are no array of numbers", lambda: simvis.mujoco.follow(sim, ["hand"], [["here"]]))
        self.expect('the part "hand" is one of the names', lambda: simvis.mujoco.follow(sim, ["hand"], one, part="hand"))
        self.assertEqual(list(sim.changes), changes)  # none of them has changed the scene
        poses = np.concatenate([one, one])
        followed = simvis.mujoco.follow(sim, ["base", "hand"], poses)
        self.expect('"hand" is followed already', lambda: simvis.mujoco.follow(sim, ["hand"], one))
        sim.step()
        sim.track_part("base")
        poses[0, 0], poses[1, 1] = 2, np.nan
        self.expect('the pose of "hand" is .*nan.*, expected finite numbers', followed.update)
        sim.step()
        self.near(sim, "base", np.eye(4))  # nothing has moved
        poses[1, 1] = 2e15
        self.expect("coordinates of at most 1e15 m", followed.update)
        sim.step()
        self.near(sim, "base", np.eye(4))

    def test_it_needs_no_mujoco(self) -> None:
        program = ("import sys; sys.modules['mujoco'] = None\n"
                   "import numpy, simvis, simvis.mujoco\n"
                   "sim = simvis.Simulation.from_string('<part name=\"P\" insert_at=\"ROOT\"/>')\n"
                   "simvis.mujoco.follow(sim, ['P'], numpy.eye(4)[None])\n"
                   "sim.step()\n")
        subprocess.run([sys.executable, "-c", program], check=True)


@unittest.skipUnless(find_spec("mujoco"), "there is no Python module mujoco: tools/python_tools installs it where pip can")
class Bodies(Scene):
    """What a model does, beside MuJoCo's own poses."""

    def model(self, text: str = MODEL) -> tuple[Any, Any]:
        model = mujoco.MjModel.from_xml_string(text)
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        return model, data

    def test_all_bodies_stand_where_mujoco_has_them(self) -> None:
        model, data = self.model()
        sim = self.load()
        followed = simvis.mujoco.follow(sim, model, data)
        self.assertEqual(followed.names, ["base", "welded", "body", "tip_2", "hand", "finger", "body_2"])
        for name in [*followed.names, "TRIED"]:
            sim.track_part(name)
        random = np.random.default_rng(2)
        for step in range(20):
            if step > 0:  # the first one is the pose of the file, in which a joint is outside of its range
                data.qpos[:] = random.uniform(-2, 2, size=model.nq)
                mujoco.mj_normalizeQuat(model, data.qpos)
                data.mocap_pos[:] = random.uniform(-2, 2, size=(1, 3))
                turn = random.normal(size=4)
                data.mocap_quat[0] = turn / np.linalg.norm(turn)
                mujoco.mj_kinematics(model, data)
                followed.update()
            sim.step()
            for i, name in enumerate(followed.names, 1):
                self.near(sim, name, sim.part_pose("TRIED") @ pose_of(data.xpos[i], data.xquat[i]))

    def test_a_loop_of_mujoco(self) -> None:
        model, data = self.model()
        sim = self.load()
        followed = simvis.mujoco.follow(sim, model, data)
        sim.track_part("tip_2")
        sim.track_part("TRIED")
        for _ in range(50):
            mujoco.mj_step(model, data)
            mujoco.mj_kinematics(model, data)
            followed.update()
            sim.step()
        self.near(sim, "tip_2", sim.part_pose("TRIED") @ pose_of(data.body("tip").xpos, data.body("tip").xquat))
        self.assertGreater(np.abs(data.qvel).max(), 0.1)

    def test_the_part_is_found_or_named(self) -> None:
        model, data = self.model()
        twice = SCENE + '<part name="OTHER" insert_at="ROOT" file="tried.xml"/>'
        self.expect("the parts TRIED, OTHER have these bodies, expected part=",
                    lambda: simvis.mujoco.follow(self.load(twice), model, data))
        sim = self.load(twice)
        followed = simvis.mujoco.follow(sim, model, data, part="OTHER")
        self.assertTrue(followed.names[0].endswith("/base"))
        sim.track_part(followed.names[0])
        sim.step()
        self.near(sim, followed.names[0], pose_of(data.xpos[1], data.xquat[1]))

    def test_another_model_is_an_error(self) -> None:
        model, data = self.model()
        sim = self.load()
        renamed, renamed_data = self.model(MODEL.replace('"finger"', '"thumb"'))
        self.expect('the link "finger" stands in place of the body "thumb"',
                    lambda: simvis.mujoco.follow(sim, renamed, renamed_data))
        small, small_data = self.model("<mujoco><worldbody><body name='base'/></worldbody></mujoco>")
        self.expect('in "TRIED" are 7 links for 1 bodies; expected a part from the model\'s file',
                    lambda: simvis.mujoco.follow(sim, small, small_data))
        self.expect("expected the MjData of this one", lambda: simvis.mujoco.follow(sim, model, small_data))
        self.expect('there is no part "CAR", expected one of', lambda: simvis.mujoco.follow(sim, model, data, part="CAR"))
        self.expect('in "WALL" are 0 links', lambda: simvis.mujoco.follow(sim, model, data, part="WALL"))
        data.xpos[2, 1] = np.inf
        self.expect('the pose of "welded" is .*inf', lambda: simvis.mujoco.follow(sim, model, data))


if __name__ == "__main__":
    unittest.main()
