"""The matchers, runs and evidence of simvis.testing, and its pytest plug-in on the example's project."""
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from importlib.util import find_spec
from pathlib import Path
from unittest import SkipTest

import numpy as np
import simvis
from simvis import testing
from small_scene import load

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "python/examples/robot_tests"
# A scanner that a test moves towards a wall whose face is at x = 4 m; sizes are exact in binary.
WALL = """<simvis>
  <part shape="box" size="1 4 2" name="WALL" insert_at="ROOT" pose_offset="4.5 0 0 0 0 0"/>
  <part name="ROBOT" insert_at="ROOT"/>
  <element type="pose" name="MOVE" insert_at="ROBOT"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROBOT" samples="3" min_angle="-90" max_angle="90"/>
  <sensor type="camera" name="CAM" insert_at="ROBOT" width="8" height="8" outputs="color depth"/>
</simvis>"""


class WithScene(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.scene = self.folder / "wall.xml"
        self.scene.write_text(WALL)

    def run_of(self, limit_s: float = 1, **settings: object) -> testing.Run:
        run = testing.run(self.scene, limit_s=limit_s, rate_hz=8, **settings)
        self.addCleanup(run.close)
        return run


class Matchers(WithScene):
    def test_ranges(self) -> None:
        run = self.run_of()
        run.step()
        scanner = run.sim["SCAN"]
        bound = float(scanner.error_bound_m[0, 1])
        self.assertTrue(testing.range_near(scanner, 4, beam=1))
        self.assertTrue(testing.range_near(scanner, math.inf, beam=0))
        self.assertFalse(testing.range_near(scanner, 5, beam=0))
        self.assertFalse(testing.range_near(scanner, math.inf, beam=1))
        beyond = testing.range_near(scanner, 4 + 3 * bound + 1e-6, beam=1)  # further than the bound and a float's rounding
        self.assertFalse(beyond)
        self.assertIn("SCAN: beam 1 measures 4 m, expected 4.000001", repr(beyond))
        self.assertTrue(testing.range_near(scanner, 4.01, beam=1, slack_m=0.02))
        with self.assertRaisesRegex(simvis.InputError, "not 3 of ring 0"):
            testing.range_near(scanner, 4, beam=3)
        with self.assertRaisesRegex(simvis.InputError, "slack_m is -1"):
            testing.range_near(scanner, 4, beam=1, slack_m=-1)
        self.assertTrue(testing.clear_of(scanner, 3.9))
        self.assertFalse(testing.clear_of(scanner, 4.1))

    def test_rings(self) -> None:
        sim = load()
        sim.step()
        scanner = sim.sensors["SCAN"]
        expected = float(scanner.range_m[1, 15])
        self.assertNotEqual(expected, float(scanner.range_m[0, 15]))
        self.assertTrue(testing.range_near(scanner, expected, beam=15, ring=1))
        beyond = testing.range_near(scanner, expected + 1, beam=15, ring=1)
        self.assertIn("SCAN: beam 15 of ring 1 measures", repr(beyond))
        self.assertEqual(beyond.select, "beam:SCAN:46")  # of 31 beams in each ring
        self.assertIn("the scan: beam 15 of ring 1", repr(testing.range_near(scanner.scan, expected + 1, beam=15, ring=1)))

    def test_a_scan_is_not_clear_where_a_surface_may_be_at_any_range(self) -> None:
        # A rendered scan does not know what a beam that passes closely beside the box meets.
        def beam_at(angle_deg: float) -> simvis.Scan:
            sim = simvis.Simulation.from_string(
                '<s><part shape="box" size="1 1 1" name="B" insert_at="ROOT" pose_offset="4 0.5 0 0 0 0"/>'
                '<sensor name="SCAN" type="laser_scanner" insert_at="ROOT" method="planar" resolution="64" samples="1" '
                f'min_angle="{angle_deg}" max_angle="{angle_deg}"/></s>')
            sim.step()
            return sim.sensors["SCAN"].scan

        scans = [beam_at(angle_deg) for angle_deg in np.arange(-2.0, 0.0, 0.25)]
        unknown = [scan for scan in scans if math.isinf(scan.range_m[0, 0]) and math.isinf(scan.error_bound_m[0, 0])]
        self.assertTrue(unknown)
        for scan in unknown:
            self.assertFalse(testing.clear_of(scan, 1))

    def test_scans(self) -> None:
        run = self.run_of()
        run.step()
        before = run.sim["SCAN"].scan
        run.step()
        self.assertTrue(testing.scans_near(before, run.sim["SCAN"]))
        run.sim["MOVE"].x = 0.5
        run.step()
        beyond = testing.scans_near(before, run.sim["SCAN"])
        self.assertFalse(beyond)
        self.assertIn("1 of 3 beams", repr(beyond))
        self.assertIn("4 and 3.5 m", repr(beyond))
        self.assertTrue(testing.scans_near(before, run.sim["SCAN"], slack_m=0.6))
        self.assertEqual((testing.scans_near(before, run.sim["SCAN"]).select, testing.scans_near(before, before).select),
                         ("beam:SCAN:1", ""))

    def test_images(self) -> None:
        run = self.run_of()
        run.step()
        camera = run.sim["CAM"]
        depth = camera.depth.copy()
        self.assertTrue(testing.depths_near(camera, depth))
        depth[2, 5] = 1
        self.assertIn("CAM: 1 of 64 pixels", repr(testing.depths_near(camera, depth)))
        depth[2, 5] = np.nan
        self.assertIn("CAM: 1 of 64 pixels", repr(testing.depths_near(camera, depth)))
        picture = camera.rgb
        other = picture.copy()
        other[1, 3] = np.where(picture[1, 3] > 127, picture[1, 3] - 50, picture[1, 3] + 50)
        self.assertTrue(testing.pictures_near(picture, picture))
        self.assertTrue(testing.pictures_near(picture, other, share=1 / 64))
        file = self.folder / "difference.png"
        beyond = testing.pictures_near(picture, other, difference=file)
        self.assertFalse(beyond)
        self.assertIn("pixel (3, 1)", repr(beyond))
        self.assertTrue(file.read_bytes().startswith(b"\x89PNG"))
        pipe = self.folder / "pipe.png"
        os.mkfifo(pipe)
        with self.assertRaisesRegex(simvis.Error, "pipe.png"):
            testing.pictures_near(picture, other, difference=pipe)

    def test_poses_and_paths(self) -> None:
        turned = np.eye(4)
        turned[:2, :2] = [[0, -1], [1, 0]]
        turned[:3, 3] = (3, 4, 0)
        self.assertTrue(testing.pose_near(np.eye(4), turned, position_m=5, angle_deg=90 + 1e-9))
        self.assertFalse(testing.pose_near(np.eye(4), turned, position_m=4.99, angle_deg=91))
        self.assertFalse(testing.pose_near(np.eye(4), turned, position_m=6, angle_deg=89.9))
        self.assertFalse(testing.pose_near(None, turned, position_m=6, angle_deg=180))
        path = [(0, 0), (4, 0), (4, 3)]
        self.assertTrue(testing.near_path((2, 0.5, 9), path, 0.5))
        self.assertFalse(testing.near_path((2, 0.5, 9), path, 0.49))
        self.assertTrue(testing.near_path((4, 5), path, 2))
        with self.assertRaisesRegex(simvis.InputError, "expected \\(n, 2\\)"):
            testing.near_path((0, 0), [1, 2, 3], 1)
        with self.assertRaisesRegex(simvis.InputError, "expected 3 coordinates or more"):
            testing.near_path((0, 0), [(1, 2, 3)], 1)

    def test_contacts(self) -> None:
        self.scene.write_text(WALL.replace("</simvis>", """
            <part shape="box" size="1 1 1" name="BUMPER" insert_at="ROBOT"/>
            <sensor type="bumper" name="BUMP" insert_at="BUMPER"/></simvis>"""))
        run = self.run_of()
        run.step()
        self.assertTrue(testing.no_contact(run.sim["BUMP"]))
        run.sim["MOVE"].x = 3.75
        run.step()
        self.assertFalse(testing.no_contact(run.sim["BUMP"]))
        with self.assertRaisesRegex(simvis.InputError, "SCAN\" is a laser_scanner, expected a contact"):
            testing.no_contact(run.sim["SCAN"])


class Runs(WithScene):
    def test_a_run_ends_at_its_limit(self) -> None:
        self.assertEqual(sum(1 for _ in self.run_of(limit_s=1)), 9)  # at 0, 1/8, ... 1 s
        for wrong in (0, -1, math.inf, math.nan):
            with self.assertRaisesRegex(simvis.InputError, "limit_s"):
                testing.run(self.scene, limit_s=wrong)

    def test_until(self) -> None:
        run = self.run_of(limit_s=10)

        def ahead(sim: simvis.Simulation) -> None:
            sim["MOVE"].x += 0.25

        run.until(lambda sim: testing.range_near(sim["SCAN"], 3, beam=1), ahead)
        self.assertEqual(run.sim["MOVE"].x, 1)
        with self.assertRaisesRegex(AssertionError, "when the limit of 10 s is reached: there: SCAN: beam 1"):
            run.until(lambda sim: testing.range_near(sim["SCAN"], 9, beam=1), name="there")

    def test_evidence_repeats_all_that_changed_the_run(self) -> None:
        run = self.run_of(limit_s=10, evidence_s=0.3)
        run.always(lambda sim: testing.clear_of(sim["SCAN"], 2), "keeps 2 m away")
        # The robot moves on by 0.3 m a frame. Before frame 4, at 1.2 m, a box comes whose face is at 3.7 m, and frame 4 is one
        # of the test's own, so that 3.7 m - x < 2 m first at frame 7, x = 1.8 m.
        with self.assertRaisesRegex(AssertionError, "frame 7: keeps 2 m away: SCAN: beam 1 measures 1.(9|8999)"):
            for i, sim in enumerate(run):
                sim["MOVE"].x += 0.3
                if i == 3:
                    sim.execute('<part shape="box" size="0.5 1 1" name="BOX" insert_at="ROOT" pose_offset="3.95 0 0 0 0 0"/>')
                    sim.step(dt_s=0.001)
        evidence = run.write_evidence(self.folder / "evidence", run.failure or "")
        self.assertNotIn("something else", evidence.text)
        page = evidence.page.read_text()
        frames = len(re.findall(r'id="frame-\d+"', page))
        self.assertEqual(evidence.link, f"{evidence.page.as_uri()}#frame={frames - 1}&select=beam:SCAN:1")
        recording = json.loads(re.findall(r'id="recording">(.*?)</script>', page)[0])
        warnings = [frame["warnings"] for frame in recording["frames"]]
        self.assertEqual(warnings, [warnings[0]] * (frames - 1) + [warnings[0] + 1])  # what failed comes with the last
        self.assertLess(frames, 7)
        self.assertGreater(evidence.recording.stat().st_size, 0)

    def test_evidence_says_if_the_run_does_not_repeat(self) -> None:
        offsets = iter((0.0, 0.5))

        def load() -> simvis.Simulation:
            sim = simvis.Simulation.load(self.scene, rate_hz=8)
            sim["MOVE"].x = next(offsets)
            return sim

        with testing.Run(load, 1) as run:
            run.step()
            evidence = run.write_evidence(self.folder, "failed")
        self.assertIn("The repeated run measured something else: SCAN.", evidence.text)


class Plugin(WithScene):
    def pytest(self, *arguments: str, bug: bool = False) -> subprocess.CompletedProcess[str]:
        try:
            import pytest  # noqa: F401
        except ImportError:
            raise SkipTest("pytest is not installed") from None
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "PYTHONDONTWRITEBYTECODE": "1"}
        return subprocess.run([sys.executable, "-m", "pytest", "-p", "simvis._pytest_plugin", "-p", "no:cacheprovider",
                               "--rootdir", str(self.project), *arguments], cwd=self.project, text=True, capture_output=True,
                              env={**environment, **({"ROBOT_BUG": "1"} if bug else {})})

    def setUp(self) -> None:
        super().setUp()
        self.project = self.folder / "project"
        shutil.copytree(EXAMPLE, self.project, ignore=shutil.ignore_patterns("__pycache__", "simvis-evidence"))

    def test_the_example_passes_without_its_bug(self) -> None:
        run = self.pytest()
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn("6 passed", run.stdout)
        self.assertFalse((self.project / "simvis-evidence").exists())

    def test_its_bug_is_found_and_can_be_seen_again(self) -> None:
        run = self.pytest("-k", "seed1", "--junit-xml=junit.xml", bug=True)
        self.assertEqual(run.returncode, 1, run.stdout + run.stderr)
        failure = re.search(r"the robot keeps 5 cm away: SCANNER: beam \d+ measures 0\.2\d+ m", run.stdout)
        self.assertIsNotNone(failure, run.stdout)
        folder = self.project / "simvis-evidence/test_robot.py_test_keeps_clear_of_everything_seed1_"
        self.assertIn((folder / "failure.html").as_uri() + "#frame=", run.stdout)
        self.assertGreater((folder / "failure.mcap").stat().st_size, 0)
        self.assertEqual(json.loads((folder / "failure.json").read_text())["test"],
                         "test_robot.py::test_keeps_clear_of_everything[seed1]")
        self.assertIn("simvis_evidence", (self.project / "junit.xml").read_text())
        command = re.search(r"^again: .*&& pytest (.*)$", run.stdout, re.MULTILINE)
        assert command is not None and failure is not None
        again = self.pytest(*command[1].split(), bug=True)
        self.assertIn("1 failed", again.stdout)
        self.assertIn(failure[0], again.stdout)

    def test_hypothesis_finds_the_smallest_failure(self) -> None:
        if find_spec("hypothesis") is None:
            self.skipTest("hypothesis is not installed")
        (self.project / "wall.xml").write_text(WALL)
        (self.project / "test_property.py").write_text("""
from hypothesis import given, settings, strategies
from simvis import testing

@settings(deadline=None, max_examples=20, derandomize=True, database=None)
@given(strategies.integers(0, 3))
def test_stays_away(x):
    with testing.run("wall.xml", limit_s=0.1) as run:
        run.sim["MOVE"].x = x
        run.step()
        assert testing.clear_of(run.sim["SCAN"], 2.5)
""")
        run = self.pytest("test_property.py")
        self.assertEqual(run.returncode, 1, run.stdout)
        self.assertIn("x=2", run.stdout)  # 4 m - 1 m is far enough, 4 m - 2 m is not
        self.assertIn("at 0 s: assert SCAN: beam 1 measures 2 m", run.stdout)
        self.assertTrue((self.project / "simvis-evidence/test_property.py_test_stays_away/failure.html").exists())

    def test_mistakes(self) -> None:
        (self.folder / "other.json").write_text("{}")
        for file in ("other.json", "none.json"):
            run = self.pytest("--simvis-again", str(self.folder / file))
            self.assertEqual(run.returncode, 4)
            self.assertIn("is no failure.json of a test", run.stderr)
        (self.folder / "other.json").write_text('{"test": "test_robot.py::test_gone"}')
        run = self.pytest("--simvis-again", str(self.folder / "other.json"))
        self.assertIn("there is no test test_robot.py::test_gone", run.stderr)
        run = self.pytest("-k", "seed1", "--simvis-evidence", "none", bug=True)
        self.assertEqual(run.returncode, 1)
        self.assertFalse((self.project / "simvis-evidence").exists())
        (self.project / "simvis-evidence").write_text("in the way")
        run = self.pytest("-k", "seed1", bug=True)
        self.assertIn("no evidence of the failure: ", run.stdout)
        self.assertIn("the robot keeps 5 cm away", run.stdout)


if __name__ == "__main__":
    unittest.main()
