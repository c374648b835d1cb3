"""COLMAP: a camera's poses on a robot outdoors from pictures alone, aligned with the ground truth by a similarity transform.

packages: pycolmap==4.2.1 numpy==2.4.6
"""
import time

import numpy as np
import pycolmap

import trial

FRAMES = 20


def similar(true, found):
    """The places found, moved, turned and scaled so that they lie on the true ones (Umeyama)."""
    a, b = true - true.mean(0), found - found.mean(0)
    u, s, v = np.linalg.svd(a.T @ b)
    sign = np.diag([1, 1, np.sign(np.linalg.det(u @ v))])
    return (np.trace(np.diag(s) @ sign) / (b ** 2).sum()) * b @ (u @ sign @ v).T + true.mean(0)


def measure(folder, supersampling=4):
    out = trial.simvis_run(f"""
  <include file="{trial.ROOT}/scenes/ravon/ravon.xml"/>
  <part name="EYE_AT" insert_at="HEAD" pose_offset="0.12 0 0 0 5 0"/>
  <sensor type="camera" name="EYE" insert_at="EYE_AT" width="640" height="480" hfov="70" supersampling="{supersampling}"/>""",
                           folder, "--sensor", "EYE", "--trajectory", trial.ROOT / "scenes/ravon/drive.csv", "--rate", 2,
                           "--frames", FRAMES, "--poses", "EYE_AT")
    begin, database = time.monotonic(), folder / "database.db"
    pycolmap.extract_features(database, out / "EYE", camera_mode=pycolmap.CameraMode.SINGLE)
    pycolmap.match_exhaustive(database)
    models = pycolmap.incremental_mapping(database, out / "EYE", folder / "models")
    seconds = time.monotonic() - begin
    model = max(models.values(), key=lambda each: each.num_reg_images())
    images = sorted((image for image in model.images.values() if image.has_pose), key=lambda image: image.name)
    true = trial.rigid(out / "EYE_AT_poses.tum")[[int(image.name[:6]) for image in images]]
    found = true.copy()
    found[:, :3, 3] = similar(true[:, :3, 3], np.array([image.projection_center() for image in images]))
    places = np.linalg.norm(found[:, :3, 3] - true[:, :3, 3], axis=1)
    trial.draw_paths(folder / "picture.svg", true, found)
    focal_px = 320 / np.tan(np.radians(35))
    return [("pictures with a pose", len(images), f"of {FRAMES}", seconds),
            ("place, RMS", 1000 * np.sqrt(np.mean(places ** 2)), "mm", seconds),
            ("place, RMS over the path", 100 * np.sqrt(np.mean(places ** 2)) / trial.path_length(true), "%", seconds),
            ("reprojection, mean", model.compute_mean_reprojection_error(), "px", seconds),
            ("focal length", abs(next(iter(model.cameras.values())).mean_focal_length() - focal_px), "px", seconds)]


trial.main(measure, supersampling=(1, 4, 16))
