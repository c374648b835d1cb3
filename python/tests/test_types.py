"""The package and a program that uses it are right for mypy and pyright."""
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import unittest
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import simvis
from simvis import testing

PROGRAM = """
import numpy as np
import simvis
from simvis import testing

sim = simvis.Simulation.load("scene.xml", rate_hz=30, overrides={"laser_scanner.method": "planar"})
ranges: "np.typing.NDArray[np.float32]" = sim.sensors["FRONT"].range_m
scan: simvis.Scan = sim.sensors["FRONT"].scan
count: int = scan.rings * scan.beams
sim.elements["P"].yaw = 90.0
reveal_type(sim.sensors["CAM"].rgb)
force: float = sim.sensors["IMU"].specific_force_z_m_s2
ids: "np.typing.NDArray[np.uint32]" = sim.sensors["CAM"].instance
prices: simvis.PriceList = sim.price("FRONT")
verdict: testing.Verdict = testing.range_near(sim.sensors["FRONT"], 2, beam=180)
run: testing.Run = testing.run("scene.xml", limit_s=20, seed=3)
"""
# Lines with mistakes, and others.
MISTAKES = """
import simvis

sim = simvis.Simulation.load("scene.xml", rate=10)  # wrong
sensor = sim.sensors["IMU"]
print(sensor.specific_force_z)  # wrong
print(sensor.specific_force_z_m_s2, sensor["of_a_plug_in"])
text: str = sensor.specific_force_z_m_s2  # wrong
sim.stepp()  # wrong
sim.step(10)  # wrong
sim.step(dt_s=0.1)
"""
MORE_MODULES = ["data", *(["gym"] if find_spec("gymnasium") else [])]
ROOT = Path(__file__).resolve().parents[2]
README = ROOT / "README.md"
# The oldest Python that the package promises, and one with all that mypy knows: it says which syntax and names came later.
OLDEST = re.findall(r'^requires-python = ">=(.+)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)[0]
NEWEST = "3.99"
BESIDE_THE_PACKAGE = ["exchange/clients", "import/programs", "program/ros", "python/examples", "python/tests"]


def installed(module: str) -> bool:
    return subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True).returncode == 0


def readme_programs() -> list[str]:
    return re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)


def copy_package(folder: Path) -> None:
    """A copy of the package's Python files and stubs, without its links."""
    package = Path(simvis.__file__).parent
    for file in [*package.glob("*.py"), package / "_core.pyi", package / "py.typed"]:
        copy = folder / "simvis" / file.name
        copy.parent.mkdir(exist_ok=True)
        copy.write_text(file.read_text())


class Types(unittest.TestCase):
    def run_on(self, *command: str) -> None:
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder) / "program.py"
            program.write_text(PROGRAM)
            readme = [Path(folder) / f"readme_{i}.py" for i in range(len(readme_programs()))]
            for file, text in zip(readme, readme_programs()):
                file.write_text(text)
            copy_package(Path(folder))
            checked = [*sorted(Path(folder).glob("simvis/*.py*")), program, *readme]
            run = subprocess.run([sys.executable, "-m", *command, *map(str, checked)], cwd=folder, text=True, capture_output=True)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)

    @unittest.skipUnless(installed("mypy"), "mypy is not installed")
    def test_mypy(self) -> None:
        self.run_on("mypy", "--strict", "--python-version", OLDEST, "--cache-dir", os.devnull)

    @unittest.skipUnless(installed("mypy"), "mypy is not installed")
    def test_programs_beside_the_package_need_no_newer_python(self) -> None:
        """Most have no types, so mypy finds mistakes in them: the same ones for the oldest Python and for the newest."""
        files = [file for folder in BESIDE_THE_PACKAGE for file in sorted((ROOT / folder).rglob("*.py"))]
        command = [sys.executable, "-m", "mypy", "--config-file=", "--no-site-packages", "--check-untyped-defs"]
        with tempfile.TemporaryDirectory() as folder:
            found = [subprocess.run([*command, "--cache-dir", os.devnull, "--python-version", version, *files], cwd=folder,
                                    text=True, capture_output=True).stdout for version in (OLDEST, NEWEST)]
        self.assertIn(f"checked {len(files)} source files", found[0])
        self.assertEqual(set(found[0].splitlines()) ^ set(found[1].splitlines()), set())

    @unittest.skipUnless(installed("mypy"), "mypy is not installed")
    def test_mistakes_have_errors_of_types(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            copy_package(Path(folder))
            program = Path(folder) / "mistakes.py"
            program.write_text(MISTAKES)
            run = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", os.devnull, program], cwd=folder,
                                 text=True, capture_output=True)
        wrong = {number for number, line in enumerate(MISTAKES.split("\n"), 1) if line.endswith("# wrong")}
        self.assertEqual({int(line) for line in re.findall(r"mistakes\.py:(\d+): error", run.stdout)}, wrong, run.stdout)

    @unittest.skipUnless(installed("pyright"), "pyright is not installed")
    def test_pyright(self) -> None:
        run = subprocess.run([sys.executable, "-m", "pyright", "--version"], capture_output=True)
        if run.returncode != 0:
            self.skipTest("pyright cannot fetch its program")
        self.run_on("pyright", "--pythonversion", OLDEST, "--pythonpath", sys.executable)

    @unittest.skipUnless(installed("pyright"), "pyright is not installed")
    def test_every_public_name_has_a_type(self) -> None:
        """Of the package and all that it refers to; types of NumPy are its own matter."""
        with tempfile.TemporaryDirectory() as folder:
            copy_package(Path(folder))
            paths = os.pathsep.join([folder, sysconfig.get_path("purelib")])
            run = subprocess.run([sys.executable, "-m", "pyright", "--ignoreexternal", "--verifytypes", "simvis"],
                                 env={**os.environ, "PYTHONPATH": paths}, cwd=folder, text=True, capture_output=True)
        if "score" not in run.stdout:
            self.skipTest("pyright cannot fetch its program")
        self.assertIn("Type completeness score: 100%", run.stdout)

    def test_the_oldest_python_is_the_same_everywhere(self) -> None:
        for file in ("README.md", "docs/python.md", "docs/shared-memory.md", "python/CMakeLists.txt"):
            self.assertIn(f"Python {OLDEST}", (ROOT / file).read_text(), file)

    def test_everything_public_is_documented(self) -> None:
        self.assertTrue(readme_programs())
        for module in (simvis, testing, *[import_module(f"simvis.{name}") for name in MORE_MODULES]):
            for name in module.__all__:
                self.assertTrue(getattr(module, name).__doc__, name)
        for kind in (simvis.Simulation, simvis.Sensor, simvis.Scan, simvis.Image, testing.Run):
            for name in dir(kind):
                if not name.startswith("_") and name not in ("name", "type"):
                    self.assertTrue(getattr(kind, name).__doc__, f"{kind.__name__}.{name}")


if __name__ == "__main__":
    unittest.main()
