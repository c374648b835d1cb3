"""Every sensor of every scene, and every type of sensor, gives from Python the numbers that simvis-run writes."""
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import simvis

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ["SIMVIS_RUN"]
FRAMES = 2
NOT_WHOLE = ("marvin/view.xml",)  # what a follower adds to another scene

ARM = """<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.6 0.1 0.1"/></geometry></collision>
    <visual><geometry><box size="0.6 0.1 0.1"/></geometry></visual>
  </link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="500" velocity="3"/></joint></robot>"""

# One sensor of each type near a wall, a ball and a falling crate, so that each has something to measure.
ALL_TYPES = """<simvis>
  <element type="physics" name="PHYSICS" insert_at="ROOT"/>
  <element type="light" name="SUN" insert_at="ROOT"/>
  <part shape="box" size="20 20 1" name="FLOOR" insert_at="ROOT" pose_offset="0 0 -0.5 0 0 0"/>
  <element type="body" name="FLOOR_BODY" insert_at="FLOOR" kind="static" shape="box"/>
  <part shape="box" size="0.2 4 2" name="WALL" insert_at="ROOT" pose_offset="3 0 1 0 0 0"/>
  <part shape="box" size="0.4 0.3 0.2" name="CRATE" insert_at="ROOT" pose_offset="0 3 0.1 0 0 0"/>
  <element type="body" name="CRATE_BODY" insert_at="CRATE" shape="box" mass="3"/>
  <part file="arm.urdf" name="ARM" insert_at="ROOT" pose_offset="0 -3 1 0 0 0"/>
  <element type="robot" name="ROBOT" insert_at="ARM"/>
  <part name="MARK" insert_at="ROOT" pose_offset="1 1 1 0 0 0"/>
  <part name="HEAD" insert_at="ROOT"/>
  <element type="pose" name="P" insert_at="HEAD" x="0.1" z="0.5" yaw="10"/>
  <part shape="box" size="0.3 0.3 0.3" name="BUFFER" insert_at="HEAD" pose_offset="0 0 -0.4 0 0 0"/>
  <sensor type="altimeter" name="altimeter" insert_at="HEAD"/>
  <sensor type="barometer" name="barometer" insert_at="HEAD" stddev="3"/>
  <sensor type="beacon" name="beacon" insert_at="HEAD" beacons="MARK"/>
  <sensor type="bumper" name="bumper" insert_at="BUFFER"/>
  <sensor type="camera" name="camera" insert_at="HEAD" width="16" height="12" outputs="color depth"/>
  <sensor type="contact" name="contact" insert_at="CRATE"/>
  <sensor type="force_torque" name="force_torque" insert_at="upper" joint="shoulder"/>
  <sensor type="event_camera" name="event_camera" insert_at="HEAD" width="16" height="12" shot_noise="50"/>
  <sensor type="gnss" name="gnss" insert_at="HEAD" horizontal_stddev="0.5"/>
  <sensor type="gnss_satellites" name="satellites" insert_at="HEAD"/>
  <sensor type="imu" name="imu" insert_at="HEAD" gyroscope_noise_density="1.7e-4"/>
  <sensor type="joint_state" name="joint_state" insert_at="ARM"/>
  <sensor type="keypoints" name="keypoints" insert_at="HEAD" points="MARK" width="16" height="12"/>
  <sensor type="laser_scanner" name="laser_scanner" insert_at="HEAD" samples="9" range_noise="0.01" intensity="on"/>
  <sensor type="light_sensor" name="light_sensor" insert_at="HEAD"/>
  <sensor type="magnetometer" name="magnetometer" insert_at="HEAD"/>
  <sensor type="odometry" name="odometry" insert_at="HEAD" kind="wheel" right_scale_error="0.01"/>
  <sensor type="psd" name="psd" insert_at="HEAD" pose_offset="0.4 0 0 0 90 0"/>
  <sensor type="radar" name="radar" insert_at="HEAD"/>
  <sensor type="range" name="range" insert_at="HEAD"/>
  <sensor type="rgbd_camera" name="rgbd_camera" insert_at="HEAD" width="16" height="12" disparity_noise="0.1"/>
  <sensor type="sonar" name="sonar" insert_at="HEAD"/>
  <sensor type="stereo_camera" name="stereo_camera" insert_at="HEAD" width="16" height="12" outputs="color depth disparity"/>
  <sensor type="thermal_camera" name="thermal_camera" insert_at="HEAD" width="16" height="12" netd="0.05" time_constant="0.1"/>
  <sensor type="tof_camera" name="tof_camera" insert_at="HEAD" width="16" height="12" signal_e="5000"/>
  <sensor type="touch" name="touch" insert_at="HEAD" length="4"/>
</simvis>"""


def small(scene: Path, folder: Path) -> Path:
    """The scene with cameras of 64 x 48, in another folder."""
    text = re.sub(r'width="\d+"(\s+)height="\d+"', r'width="64"\1height="48"', scene.read_text())
    text = re.sub(r'file="(?=[^/"])', f'file="{scene.parent}/', text)
    file = folder / scene.name
    file.write_text(text)
    return file


def newest(folder: Path) -> Path:
    """The file of the last frame in which the sensor measured."""
    return max(file for file in folder.iterdir() if file.stem.isdigit())


def without_exif(png: bytes) -> bytes:
    """A picture without the focal length of its camera, which files have and image.png() has not."""
    at = png.find(b"eXIf") - 4  # the length of its content comes first
    return png if at < 0 else png[:at] + png[at + 12 + int.from_bytes(png[at:at + 4], "big"):]


class Bytes(unittest.TestCase):
    def check(self, file: Path) -> dict[str, str]:
        """The types of the sensors that were compared, by name."""
        out = file.parent / "out"
        subprocess.run([PROGRAM, "--quiet", "--frames", str(FRAMES), "--out", out, "--format", "color=png", "--format",
                        "depth=npy", "--format", "scan=npy", file], check=True)
        sim = simvis.Simulation.load(file)
        for _ in range(FRAMES):
            sim.step()
        for sensor in sim.sensors.values():
            with self.subTest(sensor=sensor.name):
                self.compare(sensor, out)
        return {name: sensor.type for name, sensor in sim.sensors.items()}

    def compare(self, sensor: simvis.Sensor, out: Path) -> None:
        if sensor.type == "laser_scanner":
            rows = np.load(newest(out / sensor.name))
            self.assertEqual(rows["range_m"].tobytes(), sensor.range_m.tobytes())
            self.assertEqual(rows["error_bound_m"].tobytes(), sensor.error_bound_m.tobytes())
            for name in sensor.scan.channels:
                self.compare_column(rows[name], sensor.scan.channel(name).ravel())
        elif sensor.images:
            for name in sensor.images:
                self.compare_image(sensor, name, out)
        else:
            self.compare_table(sensor, np.load(newest(out / sensor.name)))

    def compare_image(self, sensor: simvis.Sensor, name: str, out: Path) -> None:
        image = sensor.image(name)
        view = "" if name == "color" else f"_{name}"
        written = newest(out / f"{sensor.name}{view}")
        if written.suffix == ".npy":
            self.assertEqual(np.load(written).tobytes(), image.array.tobytes())
        else:
            self.assertEqual(without_exif(written.read_bytes()), image.png())

    def compare_table(self, sensor: simvis.Sensor, rows: np.ndarray) -> None:
        self.assertGreater(len(rows), 0, "it has measured nothing")
        self.assertEqual(tuple(sensor.units), rows.dtype.names)
        for name in rows.dtype.names:
            self.compare_column(rows[name], sensor.reading[name])

    def compare_column(self, written: np.ndarray, measured: np.ndarray) -> None:
        """Files have some columns as float32 or as whole numbers, of which SimVis has doubles."""
        self.assertEqual(written.tobytes(), measured.astype(written.dtype).tobytes())

    def test_every_sensor_of_every_scene(self) -> None:
        scenes = [file for file in sorted(ROOT.glob("scenes/*/*.xml")) if not str(file).endswith(NOT_WHOLE)]
        self.assertGreaterEqual(len(scenes), 7)
        for scene in scenes:
            with self.subTest(scene=scene.name), tempfile.TemporaryDirectory() as folder:
                self.assertTrue(self.check(small(scene, Path(folder))))

    def test_every_type_of_sensor(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "arm.urdf").write_text(ARM)
            scene = Path(folder) / "types.xml"
            scene.write_text(ALL_TYPES)
            compared = self.check(scene)
        listed = subprocess.run([PROGRAM, "--list-types"], check=True, capture_output=True, text=True).stdout
        self.assertEqual(sorted(compared.values()), re.findall(r"^sensor +(\w+)", listed, re.MULTILINE))


if __name__ == "__main__":
    unittest.main()
