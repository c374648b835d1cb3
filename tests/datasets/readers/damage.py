"""Plants a writer's mistake in a dataset: what a reader's comparison must find."""
import json
import pathlib
import sys

import numpy as np
from PIL import Image

name, folder = sys.argv[1], pathlib.Path(sys.argv[2])


def edit_json(file, edit):
    content = json.loads(file.read_text())
    edit(content)
    file.write_text(json.dumps(content))


def edit_lines(file, edit):
    lines = file.read_text().splitlines()
    file.write_text("\n".join(line if line.startswith("#") else edit(line.split()) for line in lines) + "\n")


def ray_depth(pictures, fx, fy, cx, cy):
    for file in pictures:
        codes = np.asarray(Image.open(file)).astype(float)
        rows, columns = np.indices(codes.shape)
        far = codes * np.sqrt(1 + ((columns - cx) / fx) ** 2 + ((rows - cy) / fy) ** 2)
        Image.fromarray(np.rint(far).clip(0, 65535).astype(np.uint16)).save(file)


def wider_coco_boxes(content):
    for annotation in content["annotations"]:
        annotation["bbox"][2] += 1


def row_major_masks(content):
    from pycocotools import mask as masks
    for annotation in content["annotations"]:
        mask = masks.decode(annotation["segmentation"])
        wrong = masks.encode(np.asfortranarray(mask.reshape(-1).reshape(mask.shape, order="F")))
        annotation["segmentation"]["counts"] = wrong["counts"].decode()


def shifted_points(content):
    for annotation in content["annotations"]:
        points = annotation.get("keypoints", [])
        for i in range(0, len(points), 3):
            points[i] += 0.5 if points[i + 2] else 0


def wider_bop_boxes(content):
    for things in content.values():
        for thing in things:
            thing["bbox_visib"][2] += 1


def column_major_rotations(content):
    for things in content.values():
        for thing in things:
            thing["cam_R_m2c"] = np.reshape(thing["cam_R_m2c"], (3, 3)).T.reshape(-1).tolist()


def transposed_pose(words):
    pose = np.reshape(np.array(words, float), (3, 4))
    pose[:, :3] = pose[:, :3].T
    return " ".join(repr(float(number)) for number in pose.reshape(-1))


def mirrored_points(files):
    for file in files:
        points = np.fromfile(file, np.float32).reshape(-1, 4)
        points[:, 1] *= -1
        points.tofile(file)


def inverse_extrinsics(file):
    import yaml
    content = yaml.safe_load(file.read_text())
    content["T_BS"]["data"] = np.linalg.inv(np.reshape(content["T_BS"]["data"], (4, 4))).reshape(-1).tolist()
    file.write_text(yaml.safe_dump(content))


def w_last(annotations):
    for each in annotations:
        each["rotation"] = each["rotation"][1:] + each["rotation"][:1]


def length_first(annotations):
    for each in annotations:
        each["size"] = [each["size"][1], each["size"][0], each["size"][2]]


def swapped_labels(files):
    for file in files:
        labels = np.fromfile(file, np.uint32)
        (labels << 16 | labels >> 16).astype(np.uint32).tofile(file)


def late_milliseconds(file):
    import h5py
    with h5py.File(file, "r+") as content:
        index = content["ms_to_idx"][()]
        content["ms_to_idx"][...] = np.append(index[1:], index[-1])


def swapped_places(file):
    import h5py
    with h5py.File(file, "r+") as content:
        x, y = content["events/x"][()], content["events/y"][()]
        content["events/x"][...], content["events/y"][...] = y, x


def edit_codes(pictures, edit):
    import cv2
    for file in pictures:
        cv2.imwrite(str(file), edit(cv2.imread(str(file), cv2.IMREAD_UNCHANGED)))


scene, sequence = folder / "train" / "000000", folder / "sequences" / "00"
if name == "coco_box":
    edit_json(folder / "annotations" / "instances.json", wider_coco_boxes)
elif name == "coco_rle":
    edit_json(folder / "annotations" / "instances.json", row_major_masks)
elif name == "coco_keypoints":
    edit_json(folder / "annotations" / "instances.json", shifted_points)
elif name == "colmap_quaternion":  # lines of images end with a name
    edit_lines(folder / "sparse/0/images.txt", lambda w: " ".join(
        w[:1] + w[2:5] + w[1:2] + w[5:] if w and w[-1].endswith(".png") else w))
elif name == "colmap_pixels":  # the lines between have x, y and the number of each point
    edit_lines(folder / "sparse/0/images.txt", lambda w: " ".join(
        w if w and w[-1].endswith(".png") else [repr(float(n) + 0.5) if i % 3 < 2 else n for i, n in enumerate(w)]))
elif name == "euroc_quaternion":
    edit_lines(folder / "mav0" / "state_groundtruth_estimate0" / "data.csv",
               lambda w: ",".join((n := w[0].split(","))[:4] + n[5:8] + n[4:5] + n[8:]))
elif name == "euroc_extrinsics":
    inverse_extrinsics(folder / "mav0" / "cam0" / "sensor.yaml")
elif name == "nuscenes_quaternion":
    edit_json(folder / "v1.0-simvis" / "sample_annotation.json", w_last)
elif name == "nuscenes_size":
    edit_json(folder / "v1.0-simvis" / "sample_annotation.json", length_first)
elif name == "bop_box":
    edit_json(scene / "scene_gt_info.json", wider_bop_boxes)
elif name == "bop_rotation":
    edit_json(scene / "scene_gt.json", column_major_rotations)
elif name == "bop_depth":
    camera = json.loads((folder / "camera.json").read_text())
    ray_depth((scene / "depth").iterdir(), camera["fx"], camera["fy"], camera["cx"], camera["cy"])
elif name == "tum_quaternion":
    edit_lines(folder / "groundtruth.txt", lambda w: " ".join(w[:4] + [w[7]] + w[4:7]))
elif name == "tum_depth":
    ray_depth((folder / "depth").iterdir(), float(sys.argv[3]), float(sys.argv[3]), 47.5, 35.5)
elif name == "kitti_pose":
    edit_lines(folder / "poses" / "00.txt", transposed_pose)
elif name == "kitti_calibration":
    edit_lines(sequence / "calib.txt", lambda w: w[0] + " " + transposed_pose(w[1:]) if w[0] == "Tr:" else " ".join(w))
elif name == "kitti_points":
    mirrored_points((sequence / "velodyne").iterdir())
elif name == "kitti_sizes":  # length and width
    for file in (sequence / "label_2").iterdir():
        edit_lines(file, lambda w: " ".join(w[:9] + [w[10], w[9]] + w[11:]))
elif name == "kitti_middles":  # the middle of the box in place of that of its lower side
    for file in (sequence / "label_2").iterdir():
        edit_lines(file, lambda w: " ".join(w[:12] + [repr(float(w[12]) - float(w[8]) / 2)] + w[13:]))
elif name == "kitti_labels":
    swapped_labels((sequence / "labels").iterdir())
elif name == "dsec_index":
    late_milliseconds(folder / "events" / "left" / "events.h5")
elif name == "dsec_places":
    swapped_places(folder / "events" / "right" / "events.h5")
elif name == "dsec_flow":
    edit_codes((folder / "flow" / "forward").iterdir(), lambda codes: codes[..., [0, 2, 1]])  # B G R: x for y
elif name == "dsec_disparity":
    edit_codes((folder / "disparity" / "event").iterdir(), lambda codes: codes // 2)
else:
    raise SystemExit(f"no mistake of the name {name}")
