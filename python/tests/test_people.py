"""What people see: tables, trees, pictures, trajectories, and the programs of the documents."""
import re
import tempfile
import unittest
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import simvis
from small_scene import load

ROOT = Path(__file__).resolve().parents[2]


class People(unittest.TestCase):
    def setUp(self) -> None:
        self.sim: Any = load()
        self.sim.step()

    def test_reprs(self) -> None:
        self.assertIn("ROBOT", repr(self.sim))
        self.assertEqual(repr(self.sim.sensors), "4 sensors\n  SCAN  laser_scanner\n  CAM   camera\n  EYES  stereo_camera\n"
                                                 "  PSD   psd")
        self.assertEqual(repr(self.sim.elements), "1 elements\n  P  pose")
        self.assertIn("<pre>", self.sim._repr_html_())
        self.assertRegex(repr(self.sim["P"]), r'pose "P"\n  x +0 m')
        self.assertIn("<td>vertical_samples</td><td>3</td>", self.sim["SCAN"]._repr_html_())
        self.assertRegex(repr(self.sim["SCAN"]), r"\n  measurements +1\n")
        self.assertIn("3 x 31 beams at 0 s", repr(self.sim["SCAN"].scan))
        self.assertTrue(self.sim["CAM"].image()._repr_png_().startswith(b"\x89PNG"))
        self.assertEqual(repr(self.sim["CAM"].image("depth")), 'image "depth" of "CAM": 32 x 16 pixels')

    def test_a_repr_fits_a_screen(self) -> None:
        command = '<sensor type="camera" name="C{0}" insert_at="ROBOT" width="8" height="8" outputs="{1}"/>'
        many = "color depth normal instance semantic flow_forward flow_backward scene_flow occlusion boxes silhouettes"
        sim = load("<s><part name='ROBOT' insert_at='ROOT'/>" + "".join(command.format(i, many) for i in range(20))
                   + "<repeat count='40' as='i'><element type='pose' name='P${i}' insert_at='ROBOT'/></repeat></s>")
        for shown in (sim, sim.sensors, sim.elements, sim.parameters, sim.sensors["C0"], sim.elements["P1"]):
            with self.subTest(of=type(shown).__name__):
                lines = repr(shown).split("\n")
                self.assertLessEqual(len(lines), 30)
                self.assertLessEqual(max(map(len, lines)), 100)
                whole = str(shown).split("\n")
                self.assertEqual(lines[0], whole[0])
                if len(whole) > len(lines):
                    self.assertEqual(lines[-1], f"... and {len(whole) - 29} lines more, which print() shows")
        self.assertIn("P39 (pose)", str(sim))
        self.assertIn("P39 (pose)", sim._repr_html_())
        self.assertIn(many[:60], repr(sim.sensors["C0"]))

    def test_completion(self) -> None:
        self.assertIn("SCAN", self.sim._ipython_key_completions_())
        self.assertIn("yaw", dir(self.sim["P"]))
        self.assertIn("P.yaw", self.sim.parameters._ipython_key_completions_())

    @unittest.skipUnless(find_spec("IPython"), "IPython is not installed")
    def test_ipython_completes_names(self) -> None:
        from IPython.core.completer import IPCompleter, provisionalcompleter

        known = {"sim": self.sim, "pose": self.sim["P"], "scanner": self.sim["SCAN"], "measured": self.sim["SCAN"].measurement}
        completer: Any = IPCompleter(namespace=known, global_namespace={})
        completer.disable_matchers = ["IPCompleter.magic_matcher", "IPCompleter.custom_completer_matcher"]  # they need a shell

        def completed(text: str) -> set[str]:
            with provisionalcompleter():
                return {each.text for each in completer.completions(text, len(text))}

        self.assertEqual(completed('sim["'), {"P", "SCAN", "CAM", "EYES", "PSD"})
        self.assertEqual(completed("pose.ya"), {"yaw"})
        self.assertIn("range_m", completed("scanner.ra"))
        self.assertIn("range_m", completed('measured["'))
        completer.evaluation = "unsafe"  # what %config Completer.evaluation sets, as docs/python.md says
        completer.use_jedi = False
        self.assertEqual(completed('sim["P"].ya'), {".yaw"})
        self.assertIn("P.yaw", completed('sim.parameters["P.'))
        self.assertEqual(completed('sim.sensors["S'), {"SCAN"})

    def test_parameters(self) -> None:
        self.sim["P"].yaw = 90
        self.assertEqual(self.sim.get("P", "yaw"), 90)
        self.sim.parameters["P.x"] = 1
        self.sim["P"].set(y=2, z=3)
        self.assertEqual([self.sim["P"].x, self.sim["P"]["y"], self.sim.parameters["P.z"]], [1, 2, 3])
        self.assertIn("P.roll", self.sim.parameters)
        matrix = np.eye(4)
        matrix[0, 3] = 0.25
        self.sim["P"].set_pose(matrix)
        self.assertEqual(self.sim["P"].x, 0.25)

    def test_price_and_plan(self) -> None:
        prices = self.sim.price("SCAN", frames=1)
        self.assertEqual(sum(row["in_scene"] for row in prices), 1)
        self.assertIn("raycast", {row["method"] for row in prices})
        self.assertEqual({row["scanner"] for row in prices}, {"SCAN"})
        self.assertIn("0.001", " ".join(row["cheapest_for"] for row in prices).split())
        self.assertLess({"bound_largest_rel", "max_error_m", "beams"}, prices[0].keys())
        self.assertIn("in the scene", repr(prices))
        self.assertIn("every beam of laser scanner SCAN", self.sim.explain())

    def test_trajectories(self) -> None:
        trajectory = simvis.Trajectory({"P.x": [0, 1], "P.yaw": lambda t: 90 * t}, times_s=[0, 1])
        self.sim = load(rate_hz=2)
        seen = []
        for index in self.sim.run(4, simvis.Trajectory({"P.x": [0, 1]}, times_s=[0, 1]), progress=False):
            seen.append((index, self.sim["P"].x))
        self.assertEqual(seen, [(0, 0), (1, 0.5), (2, 1), (3, 1)])
        trajectory.apply(self.sim, 0.5)
        self.assertEqual((self.sim["P"].x, self.sim["P"].yaw), (0.5, 45))

    def test_times(self) -> None:
        sim = load(rate_hz=10)
        self.assertNotEqual(sim.time_s, sim.time_s)
        for expected in (0, 0.1, 0.2):
            sim.step()
            self.assertAlmostEqual(sim.time_s, expected)
        sim.step(dt_s=0.05)
        self.assertAlmostEqual(sim.time_s, 0.25)
        self.assertAlmostEqual(sim.sensors["SCAN"].scan.time_s, 0.25)

    def test_the_time_is_that_of_the_last_frame_also_after_skipped_ones_and_errors(self) -> None:
        sim: Any = load(rate_hz=10)
        sim.step()
        sim.skip_frame()
        self.assertEqual(sim.time_s, 0)
        sim.step(dt_s=0.05)
        self.assertAlmostEqual(sim.time_s, 0.15)
        self.assertAlmostEqual(sim.sensors["SCAN"].scan.time_s, 0.15)

        class Once(simvis.CustomElement, type="python_once"):
            attributes = [simvis.Attribute("wrong", 0.0, live=True)]

            def __init__(self, context: simvis.Context) -> None:
                pass

            def update(self, values: Mapping[str, float]) -> None:
                if values["wrong"]:
                    raise RuntimeError("not now")

        sim.execute('<element type="python_once" name="O" insert_at="ROOT"/>')
        sim.parameters["O.wrong"] = 1
        with self.assertRaises(RuntimeError):
            sim.step(dt_s=0.05)
        sim.parameters["O.wrong"] = 0
        sim.step(dt_s=0.05)
        self.assertAlmostEqual(sim.time_s, sim.sensors["SCAN"].scan.time_s)

    def test_a_page_has_the_frame_that_step_finishes(self) -> None:
        sim = load()
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.html"
            sim.record_page(page)
            sim.step_async()
            sim.step()
            sim.finish_page()
            self.assertEqual(len(re.findall(r'id="frame-\d+"', page.read_text())), 2)

    def test_loading_tells_how_far_it_is(self) -> None:
        reported: list[tuple[str, int, int]] = []
        simvis.Simulation.load(ROOT / "scenes/first/first.xml", progress=lambda *how: reported.append(how))
        self.assertTrue(any(work.startswith("reading") for work, _, _ in reported), reported)

        def refuse(*how: object) -> None:
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            simvis.Simulation.load(ROOT / "scenes/first/first.xml", progress=refuse)

    def test_scans_and_depth_are_pictures_in_a_notebook(self) -> None:
        for measured in (self.sim["SCAN"].scan, self.sim["CAM"].image("depth"), self.sim["EYES"].image("disparity")):
            self.assertTrue(measured._repr_png_().startswith(b"\x89PNG"))


if __name__ == "__main__":
    unittest.main()
