"""Reads a nuScenes dataset by nuscenes-devkit and compares it with the files of a run."""
import pathlib
import sys

import numpy as np
from nuscenes.nuscenes import NuScenes
from nuscenes.utils.data_classes import LidarPointCloud
from nuscenes.utils.geometry_utils import BoxVisibility, points_in_box
from PIL import Image

from run_files import Run, require

folder, run = pathlib.Path(sys.argv[1]), Run(sys.argv[2])
nusc = NuScenes(version="v1.0-simvis", dataroot=str(folder), verbose=False)
WIDER = 1.001  # points are float32, and lie on the faces of boxes
optical, scans, instances = run.optical_poses(), run.table("SCAN"), run.table("objects")
classes = {int(row["instance"]): row["class"] for row in instances if row["class"]}


def instance_of(annotation):
    """The id of the run: the token of an instance ends with it."""
    return int(annotation["instance_token"][4:16], 16)


def world_from(data):
    """The pose of a sensor, by the two transforms of the format."""
    pose = np.eye(4)
    for table, key in (("ego_pose", "ego_pose_token"), ("calibrated_sensor", "calibrated_sensor_token")):
        record = nusc.get(table, data[key])
        w, x, y, z = record["rotation"]
        step = np.eye(4)
        step[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
        step[:3, 3] = record["translation"]
        pose = pose @ step
    return pose


require(len(nusc.scene) == 1 and nusc.scene[0]["nbr_samples"] == len(nusc.sample) == len(optical), "number of samples")
require({record["name"] for record in nusc.category} == set(classes.values()), "categories")
sample, frames, compared = nusc.get("sample", nusc.scene[0]["first_sample_token"]), 0, 0
levels = set()
while True:
    frame = frames
    frames += 1
    camera, lidar = (nusc.get("sample_data", sample["data"][channel]) for channel in ("CAM", "SCAN"))
    time_us = float(run.table("CAM_poses")[frame]["time_s"]) * 1e6
    require(abs(sample["timestamp"] - time_us) <= 1, "time")  # cut off
    require(np.abs(world_from(camera) - optical[frame]).max() <= 1e-7, "pose of the camera")
    require(np.abs(world_from(lidar) - run.poses("SCAN")[frame]).max() <= 1e-7, "pose of the scanner")
    require((np.asarray(Image.open(folder / camera["filename"])) ==
             np.asarray(Image.open(run.folder / "CAM" / f"{frame:06d}.png"))).all(), "colours")
    rows = [row for row in scans if int(row["frame"]) == frame and row["x_m"]]
    cloud = LidarPointCloud.from_file(str(folder / lidar["filename"])).points
    raw = np.fromfile(folder / lidar["filename"], np.float32).reshape(-1, 5)
    points = np.array([[float(row[c]) for c in ("x_m", "y_m", "z_m")] for row in rows], np.float32)
    require(cloud.shape == (4, len(points)) and np.abs(cloud[:3].T - points).max() <= 1e-6, "points")
    require((raw[:, 4] == [float(row["ring"]) for row in rows]).all(), "rings")
    truth = np.array([int(row["true_instance"] or 0) for row in rows])
    _, boxes, _ = nusc.get_sample_data(lidar["token"])
    require(len(boxes) == len(sample["anns"]) == len(classes), "number of boxes")
    for box in boxes:
        annotation = nusc.get("sample_annotation", box.token)
        own = truth == instance_of(annotation)
        require(box.name == classes[instance_of(annotation)], "class of a box")
        require(annotation["num_lidar_pts"] == own.sum(), "number of points")
        inside = points_in_box(box, cloud[:3], WIDER)
        require(inside[own].all(), f"points of a thing that are in its box: {inside[own].mean()}")
        compared += int(own.sum() > 0)
    # What the picture shows of a thing, put back into space, is in the thing's box.
    _, boxes, k = nusc.get_sample_data(camera["token"], box_vis_level=BoxVisibility.NONE)
    require(len(boxes) == len(classes), "number of boxes in the camera's frame")
    depth, ids = run.plane("depth", frame), run.plane("instance", frame)
    table = {int(row["object"]): row for row in run.table("CAM") if int(row["frame"]) == frame}
    for box in boxes:
        annotation = nusc.get("sample_annotation", box.token)
        instance = instance_of(annotation)
        v, u = np.nonzero(ids == instance)
        z = depth[v, u]
        at = np.stack([(u - k[0, 2]) * z / k[0, 0], (v - k[1, 2]) * z / k[1, 1], z])
        inside = points_in_box(box, at, WIDER)
        # Pixels at an edge may show the thing though their centre lies beside it.
        require(len(z) == 0 or inside.mean() > 0.9, f"pixels of a thing that are in its box: {inside.mean()}")
        compared += int(len(z) > 0)
        fraction = float(table[instance]["visible_fraction"]) if instance in table else 0
        levels.add(annotation["visibility_token"])
        require(int(annotation["visibility_token"]) == 1 + sum(fraction >= limit for limit in (0.4, 0.6, 0.8)),
                "visibility")
    if not sample["next"]:
        break
    sample = nusc.get("sample", sample["next"])
require(frames == len(optical) and compared > 10, f"compared {compared} in {frames}")
require(len(levels) > 1, "levels of visibility")
for instance in nusc.instance:
    token, count = instance["first_annotation_token"], 0
    while token:
        annotation = nusc.get("sample_annotation", token)
        count, last, token = count + 1, token, annotation["next"]
    require(count == instance["nbr_annotations"] and last == instance["last_annotation_token"], "chain of annotations")
