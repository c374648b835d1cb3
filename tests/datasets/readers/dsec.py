"""Reads a DSEC sequence as its document says (dsec.ifi.uzh.ch/data-format), and compares it with the files of a run."""
import pathlib
import sys

import cv2
import h5py
import numpy as np
import yaml

from run_files import Run, require

folder, run = pathlib.Path(sys.argv[1]), Run(sys.argv[2])
times = [int(round(float(row["time_s"]) * 1e9)) // 1000 for row in run.table("CAM_poses")]
calibration = yaml.safe_load((folder / "calibration" / "cam_to_cam.yaml").read_text())
optical = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)


def picture(path):
    """As it lies in the file: channels R G B, or one."""
    codes = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    require(codes is not None, f"{path}: no picture")
    return codes[..., ::-1] if codes.ndim == 3 else codes


def indices_within(file, begin_us, end_us):
    """The events of [begin, end), found by the index of milliseconds."""
    index, t = file["ms_to_idx"], file["events/t"]
    first, last = begin_us // 1000, -(-end_us // 1000)
    some = slice(int(index[first]), int(index[last]))
    return some.start + np.flatnonzero((t[some] >= begin_us) & (t[some] < end_us))


def check_events(side, sensor):
    expected = run.table(sensor)
    require(len(expected) > 500, "events")
    with h5py.File(folder / "events" / side / "events.h5", "r") as file:
        require({name: file[f"events/{name}"].dtype for name in "xytp"} ==
                {"x": np.uint16, "y": np.uint16, "t": np.uint32, "p": np.uint8}, "types of events")
        for name, own in (("t", "t_us"), ("x", "x"), ("y", "y"), ("p", "polarity")):
            require((file[f"events/{name}"][()] + int(file["t_offset"][()]) * (name == "t") ==
                     np.array([int(each[own]) for each in expected])).all(), f"column {name} of events")
        t, index = file["events/t"][()].astype(np.int64), file["ms_to_idx"][()]
        require(index.dtype == np.uint64 and len(index) == times[-1] // 1000 + 1, "milliseconds")
        require((index == np.searchsorted(t, 1000 * np.arange(len(index)), side="left")).all(), "index of milliseconds")
        begin, end = times[1] + 1234, times[2] - 567
        require((indices_within(file, begin, end) == np.flatnonzero((t >= begin) & (t < end))).all(), "a window")
    with h5py.File(folder / "events" / side / "rectify_map.h5", "r") as file:
        places = file["rectify_map"][()]
    require(places.dtype == np.float32 and places.shape == (72, 96, 2), "shape of rectify_map")
    require((places[..., 0] == np.arange(96)).all() and (places[..., 1] == np.arange(72)[:, None]).all(), "rectify_map")


def check_flow():
    text = (folder / "flow" / "forward_timestamps.txt").read_text().splitlines()
    require(text[0].startswith("#"), "heading of forward_timestamps.txt")
    require([[int(t) for t in line.split(",")] for line in text[1:]] == [list(each) for each in zip(times, times[1:])],
            "times of flow")
    names = sorted(each.name for each in (folder / "flow" / "forward").iterdir())
    require(names == [f"{i:06d}.png" for i in range(len(times) - 1)], "pictures of flow")
    for i, name in enumerate(names):
        codes = picture(folder / "flow" / "forward" / name)
        require(codes.dtype == np.uint16 and codes.shape == (72, 96, 3), "form of flow")
        flow, valid = (codes[..., :2].astype(float) - 2**15) / 128, codes[..., 2]
        expected = run.plane("flow_forward", i + 1).astype(float)
        require((valid == np.isfinite(expected).all(axis=2)).all(), "where flow is known")
        # Half a step of 1/128 of a pixel.
        require(np.abs(flow - expected)[valid == 1].max() <= 0.5 / 128 + 1e-6, f"flow of {name}")


def check_disparity(view, matrix, baseline_m):
    k = calibration["intrinsics"][matrix[0]]["camera_matrix"]
    q = np.array(calibration["disparity_to_depth"][matrix[1]])
    for i in range(len(times)):
        codes = picture(folder / "disparity" / view / f"{i:06d}.png")
        require(codes.dtype == np.uint16 and codes.shape == (72, 96), "form of disparity")
        depth = run.plane("depth", i).astype(float)
        expected = np.where(np.isfinite(depth), k[0] * baseline_m / depth, 0)
        require(np.abs(codes / 256 - expected).max() <= 0.5 / 256 + 1e-4, f"disparity of {view}")
        rows, columns = np.nonzero(codes)
        point = q @ [columns, rows, codes[rows, columns] / 256, np.ones(len(rows))]
        z = point[2] / point[3]
        # Half a step of 1/256 of a pixel.
        allowed = z * z / (k[0] * baseline_m) * (0.5 / 256) * 1.1
        require((np.abs(z - depth[rows, columns]) <= allowed).all(), f"matrix of {view}")
        require(np.abs(point[0] / point[3] - (columns - k[2]) / k[0] * z).max() < 1e-9, f"matrix of {view}")


def check_calibration():
    run_k = np.reshape(yaml.safe_load((run.folder / "CAM.yaml").read_text())["camera_matrix"]["data"], (3, 3))
    for name, camera in calibration["intrinsics"].items():
        require(np.abs(np.array(camera["camera_matrix"]) - run_k[[0, 1, 0, 1], [0, 1, 2, 2]]).max() <= 1e-6, name)
        require(camera["resolution"] == [96, 72] and camera["distortion_coeffs"] == [0, 0, 0, 0], f"picture of {name}")
    require(sorted(calibration["intrinsics"]) == sorted(f"cam{r}{i}" for r in ("", "Rect") for i in range(4)), "cameras")
    poses = [run.poses(each)[0] @ optical for each in ("EV_LEFT", "CAM", "CAN", "EV_RIGHT")]
    for a, b in ((0, 1), (1, 2), (2, 3)):
        expected = np.linalg.inv(poses[b]) @ poses[a]
        require(np.abs(np.array(calibration["extrinsics"][f"T_{b}{a}"]) - expected).max() <= 1e-7, f"T_{b}{a}")


def check_images():
    for side, sensor in (("left", "CAM"), ("right", "CAN")):
        for i in range(len(times)):
            own = picture(folder / "images" / side / "rectified" / f"{i:06d}.png")
            require((own == picture(run.folder / sensor / f"{i:06d}.png")).all(), f"image of {sensor}")
    for name in ("images", "disparity"):
        require(np.loadtxt(folder / name / "timestamps.txt", dtype=np.int64).tolist() == times, f"times of {name}")


check_calibration()
check_events("left", "EV_LEFT")
check_events("right", "EV_RIGHT")
check_images()
check_flow()
check_disparity("event", ("cam0", "cams_03"), 0.3)
check_disparity("image", ("cam1", "cams_12"), 0.2)
