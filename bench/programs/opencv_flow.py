"""OpenCV: dense optical flow by DIS from pictures of a robot that drives outdoors, beside the true flow.

packages: opencv-contrib-python-headless==4.12.0.88 numpy==2.2.6
authors: 0.66 to 1.89 px of mean end-point error, a pair of Sintel (arXiv:1603.03590, figure 1)
"""
import time

import cv2
import numpy as np

import trial

SCENE = f"""
  <include file="{trial.ROOT}/scenes/ravon/ravon.xml"/>
  <sensor type="camera" name="EYE" insert_at="HEAD" pose_offset="0.12 0 0 0 5 0" width="640" height="480" hfov="70"
          outputs="color flow_backward occlusion" msaa="4"/>"""
FRAMES = 10


def measure(folder):
    out = trial.simvis_run(SCENE, folder, "--sensor", "EYE", "--trajectory", trial.ROOT / "scenes/ravon/drive.csv",
                            "--rate", 10, "--frames", FRAMES, "--format", "color=png,depth=npy")
    matcher = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    pictures = [cv2.imread(str(each), cv2.IMREAD_GRAYSCALE) for each in sorted(out.glob("EYE/*.png"))]
    seconds, errors, lengths = 0.0, [], []
    for frame in range(1, FRAMES):
        begin = time.monotonic()
        found = matcher.calc(pictures[frame], pictures[frame - 1], None)
        seconds += time.monotonic() - begin
        true = np.load(out / f"EYE_flow_backward/{frame:06}.npy")
        visible = np.isfinite(true).all(-1) & (np.load(out / f"EYE_occlusion_backward/{frame:06}.npy").squeeze() == 0)
        errors.append(np.linalg.norm(found - true, axis=-1)[visible])
        lengths.append(np.linalg.norm(true, axis=-1)[visible])
    shown = np.hstack([np.linalg.norm(each, axis=-1)[::2, ::2] for each in (found, np.nan_to_num(true))])
    codes = np.clip(8 * shown, 0, 255).astype(np.uint8)
    cv2.imwrite(str(folder / "picture.png"), cv2.applyColorMap(codes, cv2.COLORMAP_VIRIDIS))
    errors = np.concatenate(errors)
    return [("true flow, mean length", np.concatenate(lengths).mean(), "px", seconds),
            ("end point, mean", errors.mean(), "px", seconds), ("end point, median", np.median(errors), "px", seconds),
            ("beyond 3 px", 100 * np.mean(errors > 3), "%", seconds)]


trial.main(measure)
