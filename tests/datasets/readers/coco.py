"""Reads a COCO dataset by pycocotools and compares it with the files of a run."""
import contextlib
import io
import json
import pathlib
import sys

import numpy as np
from PIL import Image
from pycocotools import mask as masks
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

from run_files import Run, require

folder, run = pathlib.Path(sys.argv[1]), Run(sys.argv[2])


def run_points():
    """Rows of the run's keypoints by frame and name."""
    sensor = json.loads((run.folder / "run.json").read_text())["sensors"]["KEYS"]
    names = {int(key.removeprefix("point ")): name for key, name in sensor.items() if key.startswith("point ")}
    return {(int(row["frame"]), names[int(row["point"])]): row for row in run.table("KEYS")}


def check_points(annotation, frame, part, points):
    """Keypoints of an annotation: x, y from the centre of the first pixel, and 0 not labelled, 1 hidden, 2 visible."""
    names = coco.loadCats(annotation["category_id"])[0].get("keypoints", [])
    if not names:
        require("keypoints" not in annotation, "keypoints of a class without them")
        return 0
    triples = np.reshape(annotation["keypoints"], (-1, 3))
    require(len(triples) == len(names), "number of keypoints")
    for name, (x, y, v) in zip(names, triples):
        row = points.get((frame, f"{part}/{name}"))
        if row is None or row["in_picture"] == "0":
            require((x, y, v) == (0, 0, 0), f"keypoint that is not in the picture: {x} {y} {v}")
            continue
        require(v == 1 + int(row["visible"]), "visibility of a keypoint")
        require(abs(x + 0.5 - float(row["x_px"])) < 1e-9 and abs(y + 0.5 - float(row["y_px"])) < 1e-9, "keypoint")
    require(annotation["num_keypoints"] == (triples[:, 2] > 0).sum(), "number of labelled keypoints")
    return int((triples[:, 2] > 0).sum())


points = run_points()
parts = {int(row["instance"]): row["object"].split("/")[-1] for row in run.table("objects")}
labelled_points = 0
coco = COCO(str(folder / "annotations" / "instances.json"))
compared = 0
for image in coco.loadImgs(coco.getImgIds()):
    instance = run.plane("instance", image["frame"])
    picture = np.asarray(Image.open(folder / "images" / image["file_name"]))
    require(picture.shape == (image["height"], image["width"], 3), "size of a picture")
    of_run = np.asarray(Image.open(run.folder / "CAM" / f"{image['frame']:06d}.png"))
    require((picture == of_run).all(), "colours")
    codes = np.asarray(Image.open(folder / "depth" / image["file_name"])).astype(float)
    depth = run.plane("depth", image["frame"]).astype(float)
    require((codes == np.rint(np.where(np.isfinite(depth), depth, 0) / image["depth_unit_m"])).all(), "depth")
    seen = set()
    for annotation in coco.loadAnns(coco.getAnnIds(imgIds=image["id"])):
        mask = coco.annToMask(annotation)
        require((mask == (instance == annotation["instance_id"])).all(), "mask")
        require(masks.toBbox(coco.annToRLE(annotation)).tolist() == annotation["bbox"], "box of the mask")
        require(int(mask.sum()) == annotation["area"], "area")
        require(coco.loadCats(annotation["category_id"])[0]["name"] in ("table", "chair", "ball", "stool"), "name of the class")
        labelled_points += check_points(annotation, image["frame"], parts[annotation["instance_id"]], points)
        seen.add(annotation["instance_id"])
        compared += 1
    labelled = {int(row["instance"]) for row in run.table("objects") if row["class"]}
    require(seen == labelled & set(np.unique(instance).tolist()), "things that have annotations")
require(compared > 5, "number of annotations")
require(sum(row["class"] == "stool" for row in run.table("objects")) == 2, "objects of several meshes")
require(sum(row["class"] == "stool" for row in run.table("shapes")) == 8, "meshes of these objects")
require(labelled_points > 5, f"number of keypoints: {labelled_points}")
require({row["visible"] for row in points.values() if row["in_picture"] == "1"} == {"0", "1"},
        "keypoints that are hidden and others")

# COCO's own evaluation, with the keypoints themselves as results: a perfect score.
with_points = [a for a in coco.dataset["annotations"] if a.get("num_keypoints")]
with contextlib.redirect_stdout(io.StringIO()):
    results = coco.loadRes([{"image_id": a["image_id"], "category_id": a["category_id"], "keypoints": a["keypoints"],
                             "score": 1.0} for a in with_points])
    evaluation = COCOeval(coco, results, "keypoints")
    evaluation.params.kpt_oks_sigmas = np.full(len(with_points[0]["keypoints"]) // 3, 0.05)
    evaluation.params.catIds = sorted({a["category_id"] for a in with_points})
    evaluation.evaluate()
    evaluation.accumulate()
precision = evaluation.eval["precision"]
require(precision[precision > -1].min() == 1, "COCO's own evaluation of keypoints")
