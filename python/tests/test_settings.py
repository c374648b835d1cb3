"""The keywords of Simulation.load follow from the table of settings, in the sources, the documents and the program."""
import inspect
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import simvis
from simvis import _core
from small_scene import SCENE

ROOT = Path(__file__).resolve().parents[2]


class Settings(unittest.TestCase):
    def test_generated_files_are_current(self) -> None:
        build = Path(_core.__file__).parents[2]
        run = subprocess.run([sys.executable, ROOT / "tools/python_settings", "--check", build], capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)

    def test_signatures_have_all_settings(self) -> None:
        names = [row["name"] for row in _core.setting_table()]
        self.assertIn("rate_hz", names)
        for function in (simvis.Simulation.load, simvis.Simulation.from_string):
            parameters = list(inspect.signature(function).parameters)
            self.assertEqual(parameters[-len(names):], names)

    def test_wrong_values_are_refused_by_name(self) -> None:
        wrong = {"rate_hz": "fast", "seed": -1, "threads": 1.5, "device": 3, "strict": 1, "sensors": "IMU", "overrides": [1],
                 "packages": {"a": 1}, "instrumented": "yes", "cache_dir": 5, "progress": 7}
        self.assertEqual(set(wrong), {row["name"] for row in _core.setting_table()})
        for name, value in wrong.items():
            with self.subTest(name), self.assertRaisesRegex(simvis.InputError, name.rstrip("s")):
                simvis.Simulation.from_string(SCENE, **{name: value})

    def test_sensors_that_are_off_are_not_measured_and_load_nothing(self) -> None:
        scene = ('<part file="{file}" name="P" insert_at="ROOT"/><sensor type="imu" name="IMU" insert_at="ROOT"/>'
                 '<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5"/>')
        with tempfile.TemporaryDirectory() as folder:
            broken = Path(folder) / "broken.obj"
            broken.write_text("v 0 0 0\nf 1 2 3\n")
            sim = simvis.Simulation.from_string(scene.format(file=broken), sensors=["IMU"])
            sim.step()
            self.assertEqual(list(sim.measured), ["IMU"])
            with self.assertRaisesRegex(simvis.InputError, "broken.obj"):
                sim.sensors["SCAN"].enabled = True
            with self.assertRaisesRegex(simvis.InputError, "IMO"):
                simvis.Simulation.from_string(scene.format(file=broken), sensors=["IMO"])

    def test_a_setting_that_does_not_exist(self) -> None:
        with self.assertRaises(TypeError):
            simvis.Simulation.from_string(SCENE, sead=1)


if __name__ == "__main__":
    unittest.main()
