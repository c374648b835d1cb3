"""Reads a TUM dataset by evo and compares it with the files of a run."""
import pathlib
import sys

import numpy as np
from evo.tools import file_interface
from PIL import Image

from run_files import Run, require

folder, run = pathlib.Path(sys.argv[1]), Run(sys.argv[2])
trajectory = file_interface.read_tum_trajectory_file(str(folder / "groundtruth.txt"))
expected = run.optical_poses()
times = [float(row["time_s"]) for row in run.table("CAM_poses")]
require(len(trajectory.poses_se3) == len(expected), "number of poses")
for i, pose in enumerate(trajectory.poses_se3):
    require(abs(trajectory.timestamps[i] - times[i]) <= 1e-6, "time")  # six decimals, cut off
    require(np.abs(pose - expected[i]).max() <= 1e-8, "pose")  # nine digits in the run's table
for name, count in (("rgb.txt", 3), ("depth.txt", 0)):
    lines = [line.split() for line in (folder / name).read_text().splitlines() if not line.startswith("#")]
    require(len(lines) == len(expected), "number of pictures")
    for i, (time, file) in enumerate(lines):
        picture = np.asarray(Image.open(folder / file))
        require(abs(float(time) - times[i]) <= 1e-6, "time of a picture")
        if count == 0:
            depth = run.plane("depth", i)
            seen = np.isfinite(depth) & (depth < 65535 / 5000)
            require(np.abs(picture[seen] / 5000 - depth[seen]).max() <= 0.5 / 5000 + 1e-6, "depth")
            require((picture[~seen] == 0).all(), "missing depth")
            require(seen.mean() > 0.3, "share of pixels with depth")
        else:
            require((picture == np.asarray(Image.open(run.folder / "CAM" / f"{i:06d}.png"))).all(), "colours")
