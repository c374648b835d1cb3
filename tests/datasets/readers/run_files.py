"""What a run without --dataset has written of the same frames: the independent side of all comparisons."""
import csv
import pathlib

import numpy as np


class Run:
    def __init__(self, folder, camera="CAM"):
        self.folder, self.camera = pathlib.Path(folder), camera

    def plane(self, name, frame):
        return np.load(self.folder / f"{self.camera}_{name}" / f"{frame:06d}.npy")

    def table(self, name):
        with open(self.folder / f"{name}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def poses(self, sensor=None):
        """world_from_sensor by frame, from positions and quaternions."""
        return {int(row["frame"]): rigid(row) for row in self.table(f"{sensor or self.camera}_poses")}

    def optical_poses(self):
        optical = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)
        return {frame: pose @ optical for frame, pose in self.poses().items()}


def rigid(row):
    x, y, z, w = (float(row[k]) for k in ("qx", "qy", "qz", "qw"))
    pose = np.eye(4)
    pose[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    pose[:3, 3] = [float(row[k]) for k in ("x_m", "y_m", "z_m")]
    return pose


def require(condition, what):
    if not condition:
        raise SystemExit(f"WRONG: {what}")
