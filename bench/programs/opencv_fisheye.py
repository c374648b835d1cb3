"""OpenCV: a fisheye camera is calibrated from pictures of a chessboard.

packages: opencv-contrib-python-headless==4.12.0.88 numpy==2.2.6
"""
import time

import cv2
import numpy as np

import board
import chessboard
import trial

FOCAL_PX, LENS = 300, (0.03, -0.008, 0.002, -0.0005)


def measure(folder):
    coefficients = " ".join(f'k{i + 1}="{k}"' for i, k in enumerate(LENS))
    files = chessboard.show(folder, f'distortion="kannala_brandt" fx="{FOCAL_PX}" {coefficients} supersampling="16"')
    begin, (points, seen) = time.monotonic(), chessboard.find(files)
    shaped = [each.reshape(1, -1, 3).astype(float) for each in points], [each.reshape(1, -1, 2).astype(float) for each in seen]
    rms_px, matrix, lens, *_ = cv2.fisheye.calibrate(
        *shaped, (board.WIDTH, board.HEIGHT), None, None,
        flags=cv2.fisheye.CALIB_RECOMPUTE_EXTRINSIC | cv2.fisheye.CALIB_FIX_SKEW)
    chessboard.overlay(folder / "picture.png", files[0], seen[0])
    true = np.array([[FOCAL_PX, 0, (board.WIDTH - 1) / 2], [0, FOCAL_PX, (board.HEIGHT - 1) / 2], [0, 0, 1]])
    pixels = np.concatenate(seen).astype(float)
    rays = cv2.fisheye.undistortPoints(pixels, true, np.array(LENS))
    projected = cv2.fisheye.distortPoints(rays, matrix, lens)
    seconds = time.monotonic() - begin
    return [("boards found", len(seen), f"of {board.VIEWS}", seconds), ("reprojection, RMS", rms_px, "px", seconds),
            ("focal length", abs(matrix[0, 0] - FOCAL_PX), "px", seconds),
            ("lens where boards were seen, largest", np.abs(projected - pixels).max(), "px", seconds)]


trial.main(measure)
