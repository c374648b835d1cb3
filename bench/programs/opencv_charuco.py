"""OpenCV: the place of a ChArUco board before a camera with a known lens.

packages: opencv-contrib-python-headless==4.12.0.88 numpy==2.2.6
"""
import time

import cv2
import numpy as np

import board
import trial

COLUMNS, ROWS, SQUARE_M, MARKER_M, HFOV_DEG = 7, 5, 0.05, 0.035, 70


def measure(folder):
    charuco = cv2.aruco.CharucoBoard((COLUMNS, ROWS), SQUARE_M, MARKER_M,
                                     cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    cv2.imwrite(str(folder / "board.png"), charuco.generateImage((COLUMNS * 200, ROWS * 200)))
    files, true = board.show(folder, COLUMNS * SQUARE_M, ROWS * SQUARE_M, f'hfov="{HFOV_DEG}" supersampling="16"')
    begin, detector, matrix, found, at = time.monotonic(), cv2.aruco.CharucoDetector(charuco), board.pinhole(HFOV_DEG), [], []
    for i, file in enumerate(files):
        picture = cv2.imread(str(file))
        corners, ids, _, _ = detector.detectBoard(picture)
        if ids is None or len(ids) < 6:
            continue
        points, pixels = charuco.matchImagePoints(corners, ids)
        points -= np.array([COLUMNS, ROWS, 0]) * SQUARE_M / 2  # from the middle
        _, turn, place = cv2.solvePnP(points, pixels, matrix, None)
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3:] = cv2.Rodrigues(turn)[0], place
        found.append(pose)
        at.append(i)
    seconds = time.monotonic() - begin
    cv2.aruco.drawDetectedCornersCharuco(picture, corners, ids)
    cv2.imwrite(str(folder / "picture.png"), picture[::2, ::2])
    places, turns = trial.step_errors(true[at], found)
    return [("boards found", len(at), f"of {board.VIEWS}", seconds), ("place, median", 1000 * np.median(places), "mm", seconds),
            ("place, largest", 1000 * places.max(), "mm", seconds), ("attitude, median", np.median(turns), "deg", seconds)]


trial.main(measure)
