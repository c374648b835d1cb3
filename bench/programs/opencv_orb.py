"""OpenCV: visual odometry indoors by ORB features, depth and PnP, from frame to frame.

packages: opencv-contrib-python-headless==4.12.0.88 numpy==2.2.6
"""
import time

import cv2
import numpy as np

import trial

SCENE = f"""
  <include file="{trial.ROOT}/scenes/marvin/marvin.xml"/>
  <part name="EYE_AT" insert_at="ROBOT" pose_offset="0.06 0.06 1.41 0 8 0"/>
  <sensor type="camera" name="EYE" insert_at="EYE_AT" width="640" height="480" hfov="65" outputs="color depth" msaa="4"/>"""
MATRIX = np.array([[320 / np.tan(np.radians(65 / 2)), 0, 319.5], [0, 320 / np.tan(np.radians(65 / 2)), 239.5], [0, 0, 1]])
FRAMES = 50


def step(before, after, depth):
    """The pose of a camera in the frame of the camera before."""
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(before[1], after[1])
    old = np.array([before[0][match.queryIdx].pt for match in matches])
    new = np.array([after[0][match.trainIdx].pt for match in matches])
    z = depth[tuple(np.round(old[:, ::-1]).astype(int).T)]
    near = np.isfinite(z)
    rays = np.column_stack([old, np.ones(len(old))]) @ np.linalg.inv(MATRIX).T
    _, turn, place, _ = cv2.solvePnPRansac((rays * z[:, None])[near], new[near], MATRIX, None, reprojectionError=2)
    after_from_before = np.eye(4)
    after_from_before[:3, :3], after_from_before[:3, 3:] = cv2.Rodrigues(turn)[0], place
    return np.linalg.inv(after_from_before)


def measure(folder):
    out = trial.simvis_run(SCENE, folder, "--sensor", "EYE", "--trajectory", trial.ROOT / "scenes/marvin/drive.csv", "--rate",
                           10, "--frames", FRAMES, "--poses", "EYE_AT", "--format", "color=png,depth=npy")
    begin, orb = time.monotonic(), cv2.ORB_create(2000)
    pictures = [cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) for file in sorted(out.glob("EYE/*.png"))]
    features = [orb.detectAndCompute(picture, None) for picture in pictures]
    depths = [np.load(file).squeeze() for file in sorted(out.glob("EYE*/*.npy"))]
    poses = [np.eye(4)]
    for before, after, depth in zip(features, features[1:], depths):
        poses.append(poses[-1] @ step(before, after, depth))
    seconds = time.monotonic() - begin
    true = trial.rigid(out / "EYE_AT_poses.tum")
    found = trial.OPTICAL @ np.array(poses) @ np.linalg.inv(trial.OPTICAL)
    trial.draw_paths(folder / "picture.svg", true, found)
    return trial.path_rows(true, found, seconds)


trial.main(measure)
