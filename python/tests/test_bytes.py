"""Every sensor of every scene gives from Python the bytes that simvis-run writes."""
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


class Bytes(unittest.TestCase):
    def check(self, scene: str) -> None:
        """`scene` is a file in scenes/."""
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            file = small(ROOT / "scenes" / scene, folder)
            subprocess.run([PROGRAM, "--quiet", "--frames", "2", "--out", folder / "out", "--format", "color=png", "--format",
                            "depth=npy", "--format", "scan=npy", file], check=True)
            sim = simvis.Simulation.load(file)
            sim.step()
            sim.step()
            compared = sum(self.compare(sensor, folder / "out") for sensor in sim.sensors.values())
            self.assertEqual(compared, len(sim.sensors))

    def compare(self, sensor: simvis.Sensor, out: Path) -> bool:
        if sensor.type == "laser_scanner":
            rows = np.load(newest(out / sensor.name))
            self.assertEqual(rows["range_m"].tobytes(), sensor.range_m.tobytes(), sensor.name)
            self.assertEqual(rows["error_bound_m"].tobytes(), sensor.error_bound_m.tobytes(), sensor.name)
            return True
        compared = False
        for name in sensor.images:
            side = "_left" if sensor.type == "stereo_camera" and name in ("color", "depth") else ""
            side = "_right" if name.startswith("right") else side
            image = sensor.image(name)
            if name == "disparity":
                continue  # simvis-run writes it as EXR alone
            if name.endswith("depth"):
                array = np.load(newest(out / f"{sensor.name}{side}_depth"))
                self.assertEqual(array.tobytes(), image.array.tobytes(), sensor.name)
            else:
                self.assertEqual(newest(out / f"{sensor.name}{side}").read_bytes(), image.png(), sensor.name)
            compared = True
        return compared

    def test_marvin(self) -> None:
        self.check("marvin/marvin.xml")

    def test_arm(self) -> None:
        self.check("arm/arm.xml")

    def test_ravon(self) -> None:
        self.check("ravon/ravon.xml")

    def test_first(self) -> None:
        self.check("first/first.xml")

    def test_showcase(self) -> None:
        self.check("showcase/showcase.xml")
        self.check("showcase/surfaces.xml")


if __name__ == "__main__":
    unittest.main()
