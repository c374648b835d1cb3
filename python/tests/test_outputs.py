"""Each output of every sensor type arrives in Python with its name, unit, type, shape and numbers: as simvis-run lists it, and
as it writes it to files. A plug-in brings a type with made-up outputs, which no other file names."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import simvis
from simvis import _outputs

PROGRAM = Path(os.environ["SIMVIS_RUN"])
PLUGIN = PROGRAM.parents[1] / "lib" / "libsimvis_example_plugin.so"
DTYPES = {"u8": "uint8", "u32": "uint32", "i32": "int32", "i64": "float64", "f32": "float32", "f64": "float64"}
OF_THE_PLUGIN = ("distance_probe", "every_output", "ring_lidar")
OF_PHYSICS = ("contact", "force_torque")  # tests/clients/every_consumer_test.cpp has them
MORE = {"camera": 'outputs="color depth" width="16" height="8"', "stereo_camera": 'outputs="color depth disparity" width="16" height="8"',
        "rgbd_camera": 'outputs="color depth depth_state" width="16" height="8"',
        "tof_camera": 'outputs="depth range amplitude" width="16" height="8" bounce_rays="2"',
        "event_camera": 'width="16" height="8"',
        "thermal_camera": 'outputs="temperature raw16 color" width="16" height="8"',
        "laser_scanner": 'samples="5" vertical_samples="3" vertical_min_angle="-9" vertical_max_angle="9" truth="range hit" intensity="on"'}


def run(*arguments: str) -> str:
    return subprocess.run([PROGRAM, "--plugin", PLUGIN, *arguments], check=True, capture_output=True, text=True).stdout


def scene_with(types: list[str]) -> str:
    sensors = [f'<sensor type="{each}" name="{each}" insert_at="ROBOT" {MORE.get(each, "")}/>' for each in types]
    return f"""<simvis>
      <part shape="box" size="0.2 4 4" name="WALL" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>
      <part name="ROBOT" insert_at="ROOT"/>
      <element type="joint" name="NECK" insert_at="ROBOT" axis="0 0 1" lower="-9" upper="9"/>
      {"".join(sensors)}</simvis>"""


class Outputs(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        simvis.load_plugin(os.fspath(PLUGIN))
        kinds = [line.split()[:2] for line in run("--list-types").splitlines()]
        cls.types = [name for kind, name in kinds if kind == "sensor" and name not in OF_PHYSICS]
        cls.folder = tempfile.TemporaryDirectory()
        cls.scene = Path(cls.folder.name) / "scene.xml"
        cls.scene.write_text(scene_with(cls.types))
        cls.sim = simvis.Simulation.load(os.fspath(cls.scene))
        for _ in range(3):
            cls.sim.step()

    @classmethod
    def tearDownClass(cls) -> None:
        cls.sim.close()
        cls.folder.cleanup()

    def test_every_type_gives_what_it_lists(self) -> None:
        listed = {each["name"]: each["outputs"] for each in json.loads(run("--list", "--json", os.fspath(self.scene)))["sensors"]}
        self.assertEqual(set(listed), set(self.types))
        self.assertGreaterEqual(len(listed), 20)
        for name, outputs in listed.items():
            measured = self.sim[name].measurement
            outputs = [each for each in outputs if not each["derived"]]
            if not any("*" in each["name"] for each in outputs):
                self.assertEqual({each["name"] for each in outputs}, set(measured.keys()), name)
            for output in outputs:
                if "*" in output["name"]:
                    continue
                with self.subTest(sensor=name, output=output["name"]):
                    self.check(output, measured)

    def check_declared(self, name: str, value: object) -> None:
        """The type that a type checker takes for the output."""
        declared = _outputs.Outputs.__annotations__.get(name)
        if declared is None:  # it is a property of Sensor
            self.assertIn(name, vars(simvis.Sensor))
        elif declared != "Any":
            shown = "float" if isinstance(value, float) else f"npt.NDArray[np.{getattr(value, 'dtype')}]"
            self.assertEqual(declared, shown, name)

    def check(self, output: dict, measured: simvis.Measurement) -> None:
        value = measured[output["name"]]
        if measured.sensor not in OF_THE_PLUGIN and output["name"].isidentifier():
            self.check_declared(output["name"], value)
        self.assertEqual(measured.units[output["name"]], output["unit"])
        if output["kind"] == "scalar":
            self.assertIsInstance(value, float)
            return
        self.assertEqual(value.dtype, DTYPES[output["number"]])
        self.assertFalse(value.flags.writeable)
        rows, columns, channels = output["shape"]
        if output["kind"] == "table column":
            self.assertEqual(value.ndim, 1)
        elif channels == 1:
            self.assertEqual(value.shape, (rows, columns))
        else:
            self.assertEqual(value.shape, (rows, columns, 3 if channels == 4 else channels))

    def test_made_up_outputs(self) -> None:
        measured, frame = self.sim["every_output"].measurement, 2
        labels = self.sim["every_output"].instance
        np.testing.assert_array_equal(labels, np.arange(12, dtype=np.uint32).reshape(3, 4) + 4_000_000_001 + frame)
        np.testing.assert_array_equal(measured["code"].ravel(), np.arange(12) + frame)
        np.testing.assert_array_equal(measured["offset_mm"].ravel(), np.arange(24) - 2_000_000_001 + frame)
        self.assertEqual(measured["normal"].shape, (3, 4, 3))
        np.testing.assert_array_equal(measured["score"], [frame / 3, frame / 3 + 1])
        out = np.zeros((3, 4), np.uint32)
        self.assertIs(self.sim["every_output"].image("instance").read(out), out)
        np.testing.assert_array_equal(out, labels)

    def test_files_have_the_same_numbers(self) -> None:
        out = Path(self.folder.name) / "out"
        run("--out", os.fspath(out), "--frames", "3", "--format", "npy", "--quiet", os.fspath(self.scene))
        compared = 0
        for name in self.types:
            measured = self.sim[name].measurement
            for output in measured.keys():
                file = out / f"{name}_{output}" / "000002.npy"
                if not file.exists():
                    continue
                compared += 1
                self.assertEqual(np.load(file).tobytes(), measured[output].tobytes(), output)
        self.assertGreaterEqual(compared, 9)


if __name__ == "__main__":
    unittest.main()
