"""Reads a KITTI odometry dataset by pykitti, its poses by evo too, and compares it with the files of a run."""
import pathlib
import sys

import numpy as np
import pykitti
from evo.tools import file_interface

from run_files import Run, require

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
k, cam_from_velo = kitti.calib.K_cam2, kitti.calib.T_cam2_velo
scan = run.table("SCAN")
classes = {int(row["instance"]): int(row["semantic"]) for row in run.table("shapes")}
for i in range(len(expected)):
    velo = kitti.get_velo(i)
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
