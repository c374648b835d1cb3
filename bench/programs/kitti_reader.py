"""pykitti: the points of a scanner outdoors, drawn into the picture by the calibration, beside the true depth.

packages: pykitti==0.3.1 opencv-python-headless==5.0.0.93 matplotlib==3.11.2 numpy==2.4.6
"""
import time

import numpy as np
import pykitti

import trial

SCENE = f"""
  <include file="{trial.ROOT}/scenes/ravon/ravon.xml"/>
  <part name="EYE_AT" insert_at="ROBOT" pose_offset="0.3 0 2.3 0 5 0"/>
  <sensor type="laser_scanner" name="SCANNER" insert_at="EYE_AT" preset="velodyne_vlp16" range_bias="0" firing="together"/>
  <sensor type="camera" name="EYE" insert_at="EYE_AT" width="640" height="240" hfov="80" outputs="color depth"/>"""
FRAMES = 3


def measure(folder):
    arguments = ("--sensor", "EYE", "--sensor", "SCANNER", "--trajectory", trial.ROOT / "scenes/ravon/drive.csv", "--rate", 10,
                 "--frames", FRAMES)
    (folder / "plain").mkdir()
    out = trial.simvis_run(SCENE, folder, *arguments, "--dataset", "kitti")
    plain = trial.simvis_run(SCENE, folder / "plain", *arguments, "--format", "depth=npy,color=png,scan=bin")
    begin, data, errors = time.monotonic(), pykitti.odometry(str(out), "00"), []
    for frame, depth in enumerate(sorted(plain.glob("EYE*/*.npy"))):
        points = data.get_velo(frame).copy()
        points[:, 3] = 1
        seen = points @ data.calib.T_cam2_velo.T
        x, y, z = data.calib.K_cam2 @ seen[seen[:, 2] > 0.5][:, :3].T
        column, row = np.round(x / z).astype(int), np.round(y / z).astype(int)
        inside = (column >= 0) & (column < 640) & (row >= 0) & (row < 240)
        true = np.load(depth).squeeze()[row[inside], column[inside]]
        errors.append(np.abs(true - z[inside])[np.isfinite(true)])
    seconds, errors = time.monotonic() - begin, np.concatenate(errors)
    return [("points in the picture", len(errors), "", seconds), ("depth, median", np.median(errors), "m", seconds)]


trial.main(measure)
