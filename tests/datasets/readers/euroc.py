"""Reads an EuRoC dataset, its trajectory by evo, and compares it with the files of a run."""
import csv
import pathlib
import sys

import numpy as np
import yaml
from evo.tools import file_interface
from PIL import Image
from scipy.spatial.transform import Rotation

from run_files import Run, require

folder, run = pathlib.Path(sys.argv[1]) / "mav0", Run(sys.argv[2])


def rows_of(sensor):
    with open(folder / sensor / "data.csv", newline="") as file:
        return [row for row in csv.reader(file) if not row[0].startswith("#")]


def body_from(sensor, document):
    matrix = document["T_BS"]
    require(matrix["rows"] == 4 and matrix["cols"] == 4, "shape of T_BS")
    return np.reshape(matrix["data"], (4, 4))


def luminance(picture):
    linear = picture / 255
    linear = np.where(linear <= 0.04045, linear / 12.92, ((linear + 0.055) / 1.055) ** 2.4)
    grey = linear @ [0.2126, 0.7152, 0.0722]
    return 255 * np.where(grey <= 0.0031308, 12.92 * grey, 1.055 * grey ** (1 / 2.4) - 0.055)


body, optical = run.poses("IMU"), run.optical_poses()
times = [int(round(float(row["time_s"]) * 1e9)) for row in run.table("IMU_poses")]

trajectory = file_interface.read_euroc_csv_trajectory(str(folder / "state_groundtruth_estimate0" / "data.csv"))
require(len(trajectory.poses_se3) == len(body), "number of states")
for i, pose in enumerate(trajectory.poses_se3):
    require(abs(trajectory.timestamps[i] - times[i] / 1e9) <= 1e-9, "time of a state")
    require(np.abs(pose - body[i]).max() <= 1e-8, "pose of the body")  # nine digits in the run's table
states = np.array(rows_of("state_groundtruth_estimate0"), float)
for i in range(1, len(states)):
    velocity = (body[i][:3, 3] - body[i - 1][:3, 3]) / ((times[i] - times[i - 1]) / 1e9)
    require(np.abs(states[i, 8:11] - velocity).max() <= 1e-6, "velocity")  # of positions of nine digits

camera = yaml.safe_load((folder / "cam0" / "sensor.yaml").read_text())
require(camera["sensor_type"] == "camera" and camera["camera_model"] == "pinhole", "kind of camera")
require(camera["distortion_model"] == "radial-tangential", "model of the lens")
require(np.allclose(camera["distortion_coefficients"], [-0.1, 0.02, 0.001, 0]), "lens")
require(np.abs(body_from("cam0", camera) - np.linalg.inv(body[0]) @ optical[0]).max() <= 1e-7, "place of the camera")
fu, fv, cu, cv = camera["intrinsics"]
calibration = yaml.safe_load((run.folder / "CAM.yaml").read_text())
k = np.reshape(calibration["camera_matrix"]["data"], (3, 3))
require(np.abs(np.array([fu, fv, cu, cv]) - k[[0, 1, 0, 1], [0, 1, 2, 2]]).max() <= 1e-6, "intrinsics")
pictures = rows_of("cam0")
require(abs(camera["rate_hz"] - (len(pictures) - 1) * 1e9 / (times[-1] - times[0])) < 1e-6, "rate of the camera")
for i, (time, name) in enumerate(pictures):
    require(int(time) == times[i] and name == f"{time}.png", "name of a picture")
    picture = np.asarray(Image.open(folder / "cam0" / "data" / name))
    require(list(picture.shape[::-1]) == camera["resolution"], "grey picture")
    # Both are rounded to codes; the luminance of rounded colours is off by half a code at most.
    off = np.abs(picture - luminance(np.asarray(Image.open(run.folder / "CAM" / f"{i:06d}.png")).astype(float)))
    require(off.max() <= 1.01, f"grey: {off.max()}")

left, right, fish = (yaml.safe_load((folder / f"cam{i}" / "sensor.yaml").read_text()) for i in (1, 2, 3))
for view, document, offset_m in (("EYES", left, 0), ("EYES", right, 0.2), ("FISH", fish, 0)):
    expected = np.linalg.inv(body[0]) @ Run(sys.argv[2], view).optical_poses()[0]
    expected[:3, 3] += offset_m * expected[:3, 0]  # to the right
    require(np.abs(body_from(view, document) - expected).max() <= 1e-7, f"place of {view}")
require(left["distortion_coefficients"] == [0, 0, 0, 0] and left["resolution"] == [32, 24], "view without a lens")
require(fish["distortion_model"] == "equidistant" and fish["distortion_coefficients"] == [0.03, 0, 0, 0], "fisheye")
require(len(rows_of("cam3")) == len(times), "pictures of the fisheye")

imu = yaml.safe_load((folder / "imu0" / "sensor.yaml").read_text())
require((body_from("imu0", imu) == np.eye(4)).all(), "the imu's frame is that of the body")
require(abs(imu["accelerometer_noise_density"] - 2e-3) < 1e-12 and abs(imu["gyroscope_random_walk"] - 1e-3) < 1e-12,
        "noise of the imu")
require(imu["gyroscope_noise_density"] == 0 and imu["accelerometer_random_walk"] == 0, "noise of the imu")
measured = np.array(rows_of("imu0"), float)
names = [f"{q}_{axis}_{unit}" for q, unit in (("angular_velocity", "rad_s"), ("specific_force", "m_s2"))
         for axis in "xyz"]
expected = np.array([[float(row[name]) for name in names] for row in run.table("IMU")])
require(measured.shape == (len(times), 7) and (measured[:, 0] == times).all(), "times of the imu")
require(np.abs(measured[:, 1:] - expected).max() <= 1e-9, "measurements of the imu")
for i in range(1, len(times)):
    # The gyroscopes have a bias and no white noise: what they measure less it is the rotation from frame to frame.
    turn = Rotation.from_matrix(body[i - 1][:3, :3].T @ body[i][:3, :3]).as_rotvec() / ((times[i] - times[i - 1]) / 1e9)
    require(np.abs(measured[i, 1:4] - states[i, 11:14] - turn).max() <= 1e-6, "bias of the gyroscopes")
require(np.abs(states[:, 11:14]).min() > 1e-3 and (states[:, 14:] == 0).all(), "biases")
