"""OpenCV: a camera with a lens is calibrated from pictures of a chessboard.

packages: opencv-contrib-python-headless==4.12.0.88 numpy==2.2.6
authors: 0.26 px of reprojection, a real fisheye by Kalibr (rpng/open_vins, cam_calib-report-cam.pdf)
"""
import time

import cv2
import numpy as np

import board
import chessboard
import trial

HFOV_DEG = 70
LENS = {"k1": -0.28, "k2": 0.09, "p1": 0.0006, "p2": -0.0004, "k3": -0.01}


def measure(folder, supersampling=16, full_well_e=0):
    lens = " ".join(f'{name}="{value}"' for name, value in LENS.items())
    files = chessboard.show(folder, f"""hfov="{HFOV_DEG}" distortion="brown_conrady" {lens}
          supersampling="{supersampling}" full_well_e="{full_well_e}" """)
    begin, (points, seen) = time.monotonic(), chessboard.find(files)
    rms_px, matrix, found_lens, *_ = cv2.calibrateCamera(points, seen, (board.WIDTH, board.HEIGHT), None, None)
    seconds, true = time.monotonic() - begin, board.pinhole(HFOV_DEG)
    chessboard.overlay(folder / "picture.png", files[0], seen[0])
    return [("boards found", len(seen), f"of {board.VIEWS}", seconds), ("reprojection, RMS", rms_px, "px", seconds),
            ("focal length", abs(matrix[0, 0] - true[0, 0]), "px", seconds),
            ("principal point", np.hypot(*(matrix[:2, 2] - true[:2, 2])), "px", seconds),
            ("lens where boards were seen, largest", lens_error_px(np.concatenate(seen), matrix, found_lens, true),
             "px", seconds)]


def lens_error_px(pixels, matrix, lens, true_matrix):
    """The largest difference of the two models over the rays of these pixels."""
    pixels = pixels.astype(float)
    true_lens = np.array([LENS[name] for name in ("k1", "k2", "p1", "p2", "k3")])
    rays = cv2.undistortPointsIter(pixels, true_matrix, true_lens, np.eye(3), np.eye(3), (3, 100, 1e-12))
    points = np.concatenate([rays, np.ones((len(rays), 1, 1))], -1)
    projected, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, lens)
    return np.abs(projected - pixels).max()


trial.main(measure, supersampling=(1, 4, 16), full_well_e=(0, 20000, 2000, 200))
