"""What the scripts of this folder share: runs of simvis-run, drives with a laser scanner, rows of results, and poses."""
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


# The optical frame (x right, y down, z forward) in that of a camera (x forward, y left, z up).
OPTICAL = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]])
MAST_M = {"marvin": 1.7, "ravon": 2.3}  # above the robot


def drive_with_scanner(folder, name, scanner, *arguments, frames=100):
    """Drives the robot of this scene at 10 Hz with a laser scanner SCANNER on a mast. `scanner` are its attributes. Returns the
    folder of results, with clouds as SCANNER/000000.bin, and the true poses of the mast."""
    out = simvis_run(f"""
  <include file="{ROOT}/scenes/{name}/{name}.xml"/>
  <part name="MAST" insert_at="ROBOT" pose_offset="0 0 {MAST_M[name]} 0 0 0"/>
  <sensor type="laser_scanner" name="SCANNER" insert_at="MAST" {scanner}/>""", folder, "--sensor", "SCANNER", "--trajectory",
                     ROOT / f"scenes/{name}/drive.csv", "--rate", 10, "--frames", frames, "--poses", "MAST", "--format",
                     "scan=bin", *arguments)
    return out, rigid(out / "MAST_poses.tum")


def cloud(file):
    """The points of a cloud (n x 3), in metres."""
    return np.fromfile(file, np.float32).reshape(-1, 4)[:, :3].astype(float)


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
    return np.sqrt(np.mean(places ** 2)), step_errors(true, estimated)[1].max()


def step_errors(true_steps, found_steps):
    """Distances in metres and angles in degrees between rigid transforms."""
    off = np.linalg.inv(np.array(true_steps)) @ np.array(found_steps)
    cosines = (np.trace(off[:, :3, :3], axis1=1, axis2=2) - 1) / 2
    return np.linalg.norm(off[:, :3, 3], axis=1), np.degrees(np.arccos(np.clip(cosines, -1, 1)))


def odometry_rows(folder, program, poses, scanner=""):
    """Rows about a program's odometry outdoors from the clouds of an Ouster OS1-32 with these further attributes, read from a
    bag. The program leaves `poses` in the folder."""
    _, true = drive_with_scanner(folder, "ravon", f'preset="ouster_os1_32" {scanner}', "--record", f"{folder}/bag/")
    seconds = run_program(program, folder / "bag", "--topic", "/SCANNER/points", cwd=folder)
    estimated = np.load(folder / poses)
    draw_paths(folder / "picture.svg", true, estimated)
    return path_rows(true, estimated, seconds)


PAIRS, APART = 12, 5  # pairs of clouds, and the frames from one cloud to the next


def pair_rows(folder, align_all):
    """Rows about pairs of clouds indoors. align_all(clouds) finds the pose of each cloud but the first in the frame of the one
    before it."""
    out, poses = drive_with_scanner(folder, "marvin", 'preset="ouster_os1_32" firing="together"', frames=PAIRS * APART + 1)
    clouds = [cloud(file) for file in sorted(out.glob("SCANNER/*.bin"))[::APART]]
    poses, begin = poses[::APART], time.monotonic()
    found = align_all(clouds)
    seconds = time.monotonic() - begin
    places, turns = step_errors(np.linalg.inv(poses[:-1]) @ poses[1:], found)
    return [(f"place, median of {PAIRS} pairs", np.median(places), "m", seconds),
            ("place, largest", places.max(), "m", seconds),
            ("attitude, largest", turns.max(), "deg", seconds)]


def path_rows(true, estimated, seconds):
    """Rows about an estimated trajectory."""
    place_m, turn_deg = trajectory_error(true, estimated)
    return [("place, RMS", place_m, "m", seconds),
            ("place, RMS over the path", 100 * place_m / path_length(true), "%", seconds),
            ("attitude, largest", turn_deg, "deg", seconds)]


def draw_paths(file, true, estimated):
    """The true path in grey and the estimated one in blue, seen from above with x to the right, as SVG with a bar of 1 m."""
    paths = [(np.linalg.inv(poses[0]) @ poses)[:, :2, 3] * (1, -1) for poses in (true, estimated)]
    low, high = np.min(np.concatenate(paths), 0) - 0.5, np.max(np.concatenate(paths), 0) + 0.5
    lines = [f'<polyline fill="none" stroke="{color}" stroke-width="{width}" vector-effect="non-scaling-stroke" points="'
             + " ".join(f"{x:.3f},{y:.3f}" for x, y in path) + '"/>'
             for path, color, width in zip(paths, ("#bbbbbb", "#1060c0"), (6, 1.5))]
    x, y, width, height = *low, *(high - low)
    box = f'x="{x:.3f}" y="{y:.3f}" width="{width:.3f}" height="{height:.3f}"'
    bar = (f'<path stroke="black" stroke-width="1.5" vector-effect="non-scaling-stroke" '
           f'd="M{x + 0.1:.3f},{high[1] - 0.15:.3f}h1"/><text x="{x + 1.2:.3f}" y="{high[1] - 0.1:.3f}" '
           f'font-family="sans-serif" font-size="{0.03 * width:.3f}">1 m</text>')
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{x:.3f} {y:.3f} {width:.3f} {height:.3f}" width="400">'
    file.write_text("\n".join([head, f'<rect {box} fill="white"/>', *lines, bar, "</svg>"]) + "\n")


def path_length(poses):
    return np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1).sum()


def main(measure, **curves):
    """Prints rows (quantity, value, unit, seconds that the program took) of measure(folder) in the folder that the command line
    names. With --curves, those of measure(folder, SETTING=VALUE) for each setting and its values in `curves`."""
    settings = [(name, value) for name, values in curves.items() for value in values]
    rows = []
    for name, value in settings if "--curves" in sys.argv else [("", "")]:
        folder = pathlib.Path(sys.argv[1]) / f"{name}{value}"
        folder.mkdir(exist_ok=True)
        rows += [{"setting": name, "at": value, "quantity": quantity, "value": float(number), "unit": unit,
                  "seconds": float(seconds)}
                 for quantity, number, unit, seconds in measure(folder, **({name: value} if name else {}))]
    json.dump(rows, sys.stdout)
