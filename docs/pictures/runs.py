"""Runs simvis-run for a picture and reads what it wrote."""
import csv
import subprocess
import tempfile
from pathlib import Path

from matplotlib.pyplot import imread

ROOT = Path(__file__).resolve().parents[2]
SIMVIS_RUN = ROOT / "build/release/bin/simvis-run"


class Run:
    """The results of one run."""

    def __init__(self, folder):
        self._folder = Path(folder)

    def image(self, camera):
        """The picture of the last frame, rows from the top."""
        return imread(sorted((self._folder / camera).glob("*.png"))[-1])

    def scan(self, scanner, frames=1):
        """The rows of the last frames of a scanner's table, numbers as floats, None where a field is empty."""
        with open(self._folder / f"{scanner}.csv", newline="", encoding="utf-8") as file:
            rows = [{name: float(text) if text else None for name, text in row.items()}
                    for row in csv.DictReader(file)]
        last = rows[-1]["frame"]
        return [row for row in rows if row["frame"] > last - frames]


def run_scene(path, out, *arguments):
    subprocess.run([SIMVIS_RUN, "--quiet", "--out", out, *arguments, path], check=True)
    return Run(out)


class Bench:
    """Runs scenes that are given as text; their part files are relative to scenes/. Its folder goes with it."""

    def __init__(self):
        self._folder = tempfile.TemporaryDirectory()
        self._count = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._folder.cleanup()

    def run(self, commands, frames=1, trajectory=""):
        """`trajectory`: the text of a trajectory's CSV; empty: nothing moves."""
        folder = Path(self._folder.name) / str(self._count)
        self._count += 1
        folder.mkdir()
        (folder / "scene.xml").write_text("<simvis>" + commands.replace('file="', f'file="{ROOT}/scenes/') + "</simvis>",
                                          encoding="utf-8")
        arguments = ["--frames", str(frames)]
        if trajectory:
            (folder / "trajectory.csv").write_text(trajectory, encoding="utf-8")
            arguments += ["--trajectory", folder / "trajectory.csv"]
        return run_scene(folder / "scene.xml", folder / "out", *arguments)
