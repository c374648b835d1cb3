"""AprilTag (pupil-apriltags): the place of a tag of 20 cm, half a metre to 80 cm before a camera.

packages: pupil-apriltags==1.0.4.post11 opencv-contrib-python-headless==4.12.0.88 numpy==2.2.6
authors: 0.7 mm across and 3.3 mm along the view at 1 m, a real rc_visard by its maker (Roboception, manual, table 7.3.4)
"""
import time

import cv2
import numpy as np
import pupil_apriltags

import board
import trial

TAG_M, HFOV_DEG = 0.2, 70
CODES = np.arange(256) / 255
LINEAR = np.round(255 * np.where(CODES <= 0.04045, CODES / 12.92, ((CODES + 0.055) / 1.055) ** 2.4)).astype(np.uint8)


def find(pictures):
    """The poses of the tag, the numbers of their pictures, and the corners in the last one."""
    detector, found, at, corners = pupil_apriltags.Detector(families="tag36h11", quad_decimate=1), [], [], None
    focal_px = board.pinhole(HFOV_DEG)[0, 0]
    for i, picture in enumerate(pictures):
        for tag in detector.detect(picture, True, (focal_px, focal_px, board.WIDTH / 2, board.HEIGHT / 2), TAG_M):
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3:] = tag.pose_R, tag.pose_t
            found.append(pose)
            at.append(i)
            corners = tag.corners
    return found, at, corners


def measure(folder):
    marker = cv2.aruco.generateImageMarker(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11), 0, 800)
    marker = cv2.copyMakeBorder(marker[::-1, ::-1], 100, 100, 100, 100, cv2.BORDER_CONSTANT, value=255)
    cv2.imwrite(str(folder / "board.png"), marker)
    files, true = board.show(folder, TAG_M * 1.25, TAG_M * 1.25, f'hfov="{HFOV_DEG}" supersampling="16"')
    begin, pictures = time.monotonic(), [cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) for file in files]
    found, at, corners = find(pictures)
    seconds = time.monotonic() - begin
    shown = cv2.polylines(cv2.cvtColor(pictures[at[-1]], cv2.COLOR_GRAY2BGR), [corners.astype(int)], True, (0, 0, 255), 2)
    cv2.imwrite(str(folder / "picture.png"), shown[::2, ::2])
    places, turns = trial.step_errors(true[at], found)
    found_linear, at_linear, _ = find([LINEAR[picture] for picture in pictures])
    places_linear, _ = trial.step_errors(true[at_linear], found_linear)
    return [("tags found", len(at), f"of {board.VIEWS}", seconds), ("place, median", 1000 * np.median(places), "mm", seconds),
            ("place, largest", 1000 * places.max(), "mm", seconds), ("attitude, median", np.median(turns), "deg", seconds),
            ("place in linear light, median", 1000 * np.median(places_linear), "mm", seconds)]


trial.main(measure)
