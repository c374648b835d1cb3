"""Reads a KITTI odometry dataset by pykitti, its poses by evo too, and compares it with the files of a run."""
import pathlib
import sys

import numpy as np
import pykitti
from evo.tools import file_interface

from run_files import Run, require, rigid

folder, run = pathlib.Path(sys.argv[1]), Run(sys.argv[2])
with_labels = len(sys.argv) > 3
kitti = pykitti.odometry(str(folder), "00")
optical = run.optical_poses()
expected = [np.linalg.inv(optical[0]) @ optical[i] for i in sorted(optical)]
require(len(kitti.poses) == len(expected), "number of poses")
by_evo = file_interface.read_kitti_poses_file(str(folder / "poses" / "00.txt")).poses_se3
for i, pose in enumerate(expected):
    require(np.abs(kitti.poses[i] - pose).max() <= 1e-7, "pose")  # two poses of nine digits
    require(np.abs(by_evo[i] - pose).max() <= 1e-7, "pose by evo")
require(np.abs([t.total_seconds() for t in kitti.timestamps] -
               np.array([float(row["time_s"]) for row in run.table("CAM_poses")])).max() <= 1e-6, "times")
OCCLUDED = [(0.8, 0), (0.4, 1), (0.0, 2)]  # least visible fractions, as program/datasets/kitti_labels.h says
ROUNDING_M, ROUNDING_PX = 0.5e-4 + 1e-9, 0.5e-2 + 1e-9  # of the decimals of labels


def check_objects(frame, lines):
    """A line for each visible object, in the order of the table of boxes."""
    rows = [row for row in run.table("CAM") if int(row["frame"]) == frame and int(row["visible_pixels"]) > 0]
    require(len(lines) == len(rows), "number of labels")
    for line, row in zip(lines, rows):
        words = line.split()
        truncated, occluded, alpha, left, top, right, bottom, h, w, l, x, y, z, turn = map(float, words[1:])
        require(words[0] == object_classes[int(row["object"])], "type of an object")
        require(abs(truncated - float(row["truncated"])) <= ROUNDING_PX, "truncation")
        require(occluded == next(o for least, o in OCCLUDED if float(row["visible_fraction"]) >= least), "occlusion")
        # No pixel of the silhouette in the picture lies outside of the box, and none is a line farther inside.
        box = [float(row[f"picture_{side}"]) for side in ("x_min", "y_min", "x_max", "y_max")]
        off = np.abs(np.array([left, top, right + 1, bottom + 1]) - box).max()
        require(off <= ROUNDING_PX, f"box of an object: {off} px")
        size = np.array([float(row[f"box_size_{axis}_m"]) for axis in "xyz"])
        require(np.abs(np.array([l, w, h]) - size).max() <= ROUNDING_M, "lengths of an object")
        pose = rigid({**{f"q{axis}": row[f"box_q{axis}"] for axis in "xyzw"}, **{f"{axis}_m": row[f"box_{axis}_m"] for axis in "xyz"}})
        foot = (pose @ [0, 0, -size[2] / 2, 1])[:3]
        require(np.abs(foot - [x, y, z]).max() <= ROUNDING_M, "place of an object")
        ahead = pose[:3, 0] * [1, 0, 1]
        heading = np.array([np.cos(turn), 0, -np.sin(turn)])  # as KITTI turns about y
        require(np.linalg.norm(np.cross(ahead, heading)) <= 1e-4 and ahead @ heading > 0, "rotation of an object")
        require(abs(np.angle(np.exp(1j * (turn - np.arctan2(x, z) - alpha)))) <= 3e-4, "observation angle")
    return len(rows)


object_classes = {int(row["instance"]): row["class"] for row in run.table("objects")}
objects = 0
k, cam_from_velo = kitti.calib.K_cam2, kitti.calib.T_cam2_velo
scan = run.table("SCAN")
classes = {int(row["instance"]): int(row["semantic"]) for row in run.table("shapes")}
for i in range(len(expected)):
    velo = kitti.get_velo(i)
    objects += check_objects(i, (folder / "sequences" / "00" / "label_2" / f"{i:06d}.txt").read_text().splitlines())
    rows = [row for row in scan if int(row["frame"]) == i and row["x_m"]]
    points = np.array([[float(row[c]) for c in ("x_m", "y_m", "z_m")] for row in rows], np.float32)
    require(velo.shape == (len(points), 4) and np.abs(velo[:, :3] - points).max() <= 1e-6, "points")
    at = (cam_from_velo @ np.c_[velo[:, :3], np.ones(len(velo))].T).T
    at = at[at[:, 2] > 0.1]
    u = np.rint(k[0, 0] * at[:, 0] / at[:, 2] + k[0, 2]).astype(int)
    v = np.rint(k[1, 1] * at[:, 1] / at[:, 2] + k[1, 2]).astype(int)
    depth = run.plane("depth", i)
    inside = (u >= 0) & (v >= 0) & (u < depth.shape[1]) & (v < depth.shape[0])
    off = np.abs(depth[v[inside], u[inside]] - at[inside, 2])
    require(inside.sum() > 20, "points in the picture")
    # The scanner stands elsewhere, so some points are hidden from the camera; of the others most are on its surface.
    require((off < 0.1).mean() > 0.7, f"points on the surfaces of the picture: {(off < 0.1).mean()}")
    if with_labels:
        labels = np.fromfile(folder / "sequences" / "00" / "labels" / f"{i:06d}.label", np.uint32)
        ids = sorted(classes)
        truth = [(int(row["true_instance"] or 0), int(row["true_semantic"] or 0)) for row in rows]
        require(len(labels) == len(velo), "number of labels")
        require((labels & 0xffff).tolist() == [semantic for _, semantic in truth], "classes")
        require((labels >> 16).tolist() == [ids.index(instance) + 1 for instance, _ in truth], "instances")
        require((labels & 0xffff).max() > 0, "a class")
require(objects > 5, f"number of objects: {objects}")
