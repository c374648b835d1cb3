"""Reads a BOP dataset as docs/bop_datasets_format.md of bop_toolkit describes it, and compares it with the files of a
run. No code of the toolkit is used."""
import json
import pathlib
import sys

import numpy as np
from PIL import Image

from run_files import Run, require


def read_ply(file):
    data = file.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    vertices = int(data.split(b"element vertex ")[1].split(b"\n")[0])
    return np.frombuffer(data, np.float32, vertices * 6, end).reshape(-1, 6)[:, :3].astype(float)


def picture(file):
    return np.asarray(Image.open(file))


def box_of(mask):
    rows, columns = np.nonzero(mask)
    return [int(columns.min()), int(rows.min()), int(np.ptp(columns)), int(np.ptp(rows))]


folder, run = pathlib.Path(sys.argv[1]), Run(sys.argv[2])
scene = folder / "train" / "000000"
cameras, gts, infos = (json.loads((scene / f"scene_{name}.json").read_text()) for name in ("camera", "gt", "gt_info"))
models = json.loads((folder / "models" / "models_info.json").read_text())
optical, compared, truncated = run.optical_poses(), 0, 0
for model, info in models.items():
    vertices = read_ply(folder / "models" / f"obj_{int(model):06d}.ply")
    low, size = ([info[f"{name}_{axis}"] for axis in "xyz"] for name in ("min", "size"))
    require(np.abs(vertices.min(0) - low).max() < 1e-3 and np.abs(np.ptp(vertices, 0) - size).max() < 1e-3, "model")
    far = max(np.linalg.norm(vertices - vertex, axis=1).max() for vertex in vertices)
    require(abs(info["diameter"] - far) < 1e-3, "diameter")
whole = json.loads((folder / "camera.json").read_text())
for image, camera in cameras.items():
    frame, k = int(image), np.reshape(camera["cam_K"], (3, 3))
    require(whole["fx"] == k[0, 0] and whole["cy"] == k[1, 2], "camera.json")
    instance, depth = run.plane("instance", frame), run.plane("depth", frame)
    # The principal point is the middle of the picture, where pixels are counted from their centres.
    require(k[0, 2] == depth.shape[1] / 2 - 0.5 and k[1, 2] == depth.shape[0] / 2 - 0.5, "principal point")
    codes = picture(scene / "depth" / f"{frame:06d}.png") * camera["depth_scale"]
    seen = np.isfinite(depth)
    require(np.abs(codes[seen] - 1000 * depth[seen]).max() <= 0.5 * camera["depth_scale"] + 1e-3, "depth")
    require((picture(scene / "rgb" / f"{frame:06d}.png") == picture(run.folder / "CAM" / f"{frame:06d}.png")).all(),
            "colours")
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = np.reshape(camera["cam_R_w2c"], (3, 3)), np.array(camera["cam_t_w2c"]) / 1000
    require(np.abs(pose - np.linalg.inv(optical[frame])).max() <= 1e-7, "pose of the camera")
    for number, (gt, info) in enumerate(zip(gts[image], infos[image], strict=True)):
        full = picture(scene / "mask" / f"{frame:06d}_{number:06d}.png") > 0
        visible = picture(scene / "mask_visib" / f"{frame:06d}_{number:06d}.png") > 0
        require((visible == (instance == gt["instance_id"])).all(), "visible mask")
        require((full | ~visible).all(), "the mask contains the visible one")
        require(info["px_count_visib"] == visible.sum(), "visible pixels")
        require(info["px_count_all"] >= full.sum(), "pixels of the silhouette")
        require(info["px_count_valid"] == (full & (codes > 0)).sum(), "pixels with depth")
        require(abs(info["visib_fract"] - visible.sum() / info["px_count_all"]) < 1e-12, "visible fraction")
        require(info["bbox_visib"] == (box_of(visible) if visible.any() else [-1, -1, -1, -1]), "visible box")
        # Corners of the model, projected, enclose the silhouette to a pixel.
        vertices = read_ply(folder / "models" / f"obj_{gt['obj_id']:06d}.ply")
        at = vertices @ np.reshape(gt["cam_R_m2c"], (3, 3)).T + gt["cam_t_m2c"]
        pixels = at @ k.T
        pixels = pixels[:, :2] / pixels[:, 2:]
        low, high = pixels.min(0), pixels.max(0)
        x, y, w, h = info["bbox_obj"]
        corners = np.array([x, y, x + w, y + h])
        require(np.abs(corners - [*low, *high]).max() <= 1.5, f"box of the silhouette {corners} {low} {high}")
        inside = low.min() > 0 and high[0] < depth.shape[1] - 1 and high[1] < depth.shape[0] - 1
        if inside:
            require(info["bbox_obj"] == box_of(full) and info["px_count_all"] == full.sum(), "silhouette in the picture")
        truncated += not inside
        # Pixels that show the thing are within its model along the axis.
        if visible.any():
            near, far = at[:, 2].min(), at[:, 2].max()
            require(codes[visible].min() >= near - 2 and codes[visible].max() <= far + 2, "depth of the thing")
        compared += 1
require(compared > 5 and truncated > 0, f"number of things: {compared}, {truncated} truncated")
