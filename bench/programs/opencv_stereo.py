"""OpenCV: semi-global matching of a stereo pair in an office, beside the true disparity.

packages: opencv-contrib-python-headless==4.12.0.88 numpy==2.2.6
authors: 7.64 % beyond 3 px of the pixels that both cameras see, KITTI 2012 by its makers (cvlibs.net, stereo 2012, OCV-SGBM)
"""
import time

import cv2
import numpy as np

import trial

RANGE_PX = 64


def scene(msaa, full_well_e):
    return f"""
  <include file="{trial.ROOT}/scenes/marvin/marvin.xml"/>
  <sensor type="stereo_camera" name="EYES" insert_at="ROBOT" pose_offset="0.06 0.06 1.41 0 8 0" width="640" height="480"
          hfov="65" baseline="0.12" outputs="color disparity" msaa="{msaa}" full_well_e="{full_well_e}"/>"""


def measure(folder, msaa=4, full_well_e=0):
    out = trial.simvis_run(scene(msaa, full_well_e), folder, "--sensor", "EYES", "--trajectory",
                           trial.ROOT / "scenes/marvin/drive.csv", "--rate", 1, "--frames", 8, "--format",
                           "color=png,depth=npy")
    matcher = cv2.StereoSGBM_create(numDisparities=RANGE_PX, blockSize=5, P1=8 * 25, P2=32 * 25, uniquenessRatio=10,
                                    speckleWindowSize=100, speckleRange=2, disp12MaxDiff=1)
    seconds, errors, visible = 0.0, [], 0
    for left in sorted(out.glob("EYES_left/*.png")):
        pair = [cv2.imread(str(out / f"EYES_{side}" / left.name), cv2.IMREAD_GRAYSCALE) for side in ("left", "right")]
        begin = time.monotonic()
        found = matcher.compute(*pair).astype(float) / 16
        seconds += time.monotonic() - begin
        true = np.load(out / "EYES_disparity" / f"{left.stem}.npy").squeeze()
        in_both = (true > 0) & (true < RANGE_PX) & (np.arange(true.shape[1]) >= RANGE_PX)
        visible += in_both.sum()
        errors.append(np.abs(found - true)[in_both & (found > 0)])
    codes = np.hstack([np.clip(each, 0, RANGE_PX)[::2, ::2] * (255 / RANGE_PX) for each in (found, true)])
    cv2.imwrite(str(folder / "picture.png"), cv2.applyColorMap(codes.astype(np.uint8), cv2.COLORMAP_VIRIDIS))
    errors = np.concatenate(errors)
    return [("pixels with a disparity", 100 * len(errors) / visible, "%", seconds),
            ("disparity, median", np.median(errors), "px", seconds),
            ("beyond 3 px", 100 * np.mean(errors > 3), "%", seconds)]


trial.main(measure, msaa=(1, 4), full_well_e=(0, 20000, 2000, 200))
