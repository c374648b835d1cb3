"""The programs of the documents, the examples and the notebook run."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# What an example needs besides the module, where pip may not have it.
NEEDED = {"follow_mujoco": ("mujoco", "gymnasium", "glfw", "imageio")}


@contextmanager
def working_folder() -> Iterator[None]:
    """A temporary working directory."""
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


class Documents(unittest.TestCase):
    def test_programs_of_the_documents(self) -> None:
        for page in ("README.md", "docs/python.md"):
            programs = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)
            programs = [program for program in programs if "import simvis\n" in program]
            self.assertTrue(programs, page)
            for program in programs:
                with self.subTest(page=page, program=program), working_folder():
                    exec(compile(program, page, "exec"), {"__name__": "document"})

    def test_examples(self) -> None:
        # coco_to_yolo.py converts a dataset: tests/datasets/readers_test.cpp runs it.
        examples = [each for each in (ROOT / "python/examples").glob("*.py") if each.stem != "coco_to_yolo"]
        for example in sorted(examples):
            with self.subTest(example=example.name), tempfile.TemporaryDirectory() as folder:
                for module in NEEDED.get(example.stem, ()):
                    if not find_spec(module):
                        self.skipTest(f"there is no Python module {module}: tools/python_tools installs it where pip can")
                run = subprocess.run([sys.executable, example, "--short"], cwd=folder, capture_output=True, text=True,
                                     env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
                if "No module named 'torch'" not in run.stderr:
                    self.assertEqual(run.returncode, 0, run.stderr)

    def test_the_notebook(self) -> None:
        matplotlib = "import matplotlib; matplotlib.use('Agg')\n"
        cells = json.loads((ROOT / "python/examples/accuracy.ipynb").read_text())["cells"]
        program = matplotlib + "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
        exec(compile(program, "accuracy.ipynb", "exec"), {})


if __name__ == "__main__":
    unittest.main()
