"""Reads a COLMAP model by pycolmap and compares it with the files of a run."""
import pathlib
import sys

import numpy as np
import pycolmap
import yaml
from PIL import Image

from run_files import Run, require

folder, run = pathlib.Path(sys.argv[1]), Run(sys.argv[2])
model = pycolmap.Reconstruction(folder / "sparse" / "0")
expected = run.optical_poses()
require(len(model.images) == len(expected) > 0, "number of images")

(camera,) = model.cameras.values()
calibration = yaml.safe_load((run.folder / "CAM.yaml").read_text())
k = np.reshape(calibration["camera_matrix"]["data"], (3, 3))
own, lens = calibration["distortion_model"], calibration["distortion_coefficients"]["data"]
models = {"plumb_bob": "FULL_OPENCV" if lens[-1] else "OPENCV" if any(lens) else "PINHOLE",
          "rational_polynomial": "FULL_OPENCV", "equidistant": "OPENCV_FISHEYE"}
require(camera.model.name == models[own] and (camera.width, camera.height) == (96, 72), "camera")
# COLMAP counts from the corner of the first pixel, ROS from its centre; the file of the run has about nine digits.
params = np.array(camera.params)
require(np.abs(params[:4] - k[[0, 1, 0, 1], [0, 1, 2, 2]] - [0, 0, 0.5, 0.5]).max() <= 1e-6, "intrinsics")
count = min(len(params) - 4, len(lens))
require(np.abs(params[4 : 4 + count] - lens[:count]).max(initial=0) <= 1e-9, "lens")
require(not any(params[4 + count :]) and not any(lens[count:]), "coefficients that only one of both has")

for image in model.images.values():
    frame = int(image.name.removeprefix("CAM_").removesuffix(".png"))
    colors = np.asarray(Image.open(folder / "images" / image.name))
    require((colors == np.asarray(Image.open(run.folder / "CAM" / f"{frame:06d}.png"))).all(), "colours")
    # The run's table has 16 digits: what is left is the rounding of a quaternion and of an inverse.
    pose = np.linalg.inv(np.vstack([image.cam_from_world().matrix(), [0, 0, 0, 1]]))
    require(np.abs(pose - expected[frame]).max() <= 1e-9, "pose")
    depth, seen = run.plane("depth", frame).squeeze(), 0
    for pixel in image.points2D:
        point = model.points3D[pixel.point3D_id]
        column, row = (int(number) for number in pixel.xy)
        in_camera = image.cam_from_world() * point.xyz
        require(np.abs(camera.img_from_cam(in_camera) - pixel.xy).max() <= 1e-6, "place of a point in the picture")
        require(abs(in_camera[2] - depth[row, column]) <= 1e-6 * depth[row, column], "depth of a point")
        require((point.color == colors[row, column]).all(), "colour of a point")
        seen += 1
    require(seen >= 500, f"{seen} points")
    if camera.model.name == "OPENCV_FISHEYE":
        continue  # EXIF knows pinholes alone
    for picture in (folder / "images" / image.name, run.folder / "CAM" / f"{frame:06d}.png"):
        found_px = pycolmap.infer_camera_from_image(picture).mean_focal_length()
        require(abs(found_px - k[0, 0]) <= 1e-4, "focal length in the picture")  # a millionth of a millimetre is 3e-6 px
