"""What the scripts of this folder share: runs of simvis-run, rows of results, and poses."""
import json
import pathlib
import subprocess
import sys
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]


def simvis_run(scene_xml, folder, *arguments):
    """Writes the scene into the folder and runs it there. Results are in folder/out."""
    scene = folder / "scene.xml"
    scene.write_text(f"<simvis>\n{scene_xml}\n</simvis>\n")
    program = ROOT / "build/release/bin/simvis-run"
    subprocess.run([program, scene, "--out", folder / "out", "--quiet", *map(str, arguments)], check=True)
    return folder / "out"


def run_program(*command, cwd=None):
    """Runs a program of this environment. Returns the seconds that it took."""
    begin = time.monotonic()
    subprocess.run([pathlib.Path(sys.executable).with_name(command[0]), *map(str, command[1:])], check=True, cwd=cwd,
                   stdout=subprocess.DEVNULL)
    return time.monotonic() - begin


def rigid(poses_tum):
    """4 x 4 matrices of the rows `time x y z qx qy qz qw`."""
    rows = np.atleast_2d(np.loadtxt(poses_tum))
    x, y, z, w = rows[:, 4:8].T
    matrices = np.tile(np.eye(4), (len(rows), 1, 1))
    matrices[:, :3, 3] = rows[:, 1:4]
    matrices[:, :3, :3] = np.stack([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]).transpose(2, 0, 1)
    return matrices


def trajectory_error(true, estimated):
    """Root mean square of the places, in metres, and the largest angle, in degrees, with the first poses laid together."""
    true, estimated = np.linalg.inv(true[0]) @ true, np.linalg.inv(estimated[0]) @ estimated
    places = np.linalg.norm(true[:, :3, 3] - estimated[:, :3, 3], axis=1)
    turns = (np.linalg.inv(true) @ estimated)[:, :3, :3]
    cosines = (np.trace(turns, axis1=1, axis2=2) - 1) / 2
    return np.sqrt(np.mean(places ** 2)), np.degrees(np.arccos(np.clip(cosines, -1, 1))).max()


def path_length(poses):
    return np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1).sum()


def report(rows):
    """Prints rows (quantity, value, unit, seconds that the program took)."""
    json.dump([{"quantity": quantity, "value": float(value), "unit": unit, "seconds": float(seconds)}
               for quantity, value, unit, seconds in rows], sys.stdout)


def main(measure):
    """Runs measure(folder) in the folder that the command line names."""
    report(measure(pathlib.Path(sys.argv[1])))
