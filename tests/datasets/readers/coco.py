"""Reads a COCO dataset by pycocotools and compares it with the files of a run."""
import pathlib
import sys

import numpy as np
from PIL import Image
from pycocotools import mask as masks
from pycocotools.coco import COCO

from run_files import Run, require

folder, run = pathlib.Path(sys.argv[1]), Run(sys.argv[2])
coco = COCO(str(folder / "annotations" / "instances.json"))
compared = 0
for image in coco.loadImgs(coco.getImgIds()):
    instance = run.plane("instance", image["frame"])
    picture = np.asarray(Image.open(folder / "images" / image["file_name"]))
    require(picture.shape == (image["height"], image["width"], 3), "size of a picture")
    of_run = np.asarray(Image.open(run.folder / "CAM" / f"{image['frame']:06d}.png"))
    require((picture == of_run).all(), "colours")
    seen = set()
    for annotation in coco.loadAnns(coco.getAnnIds(imgIds=image["id"])):
        mask = coco.annToMask(annotation)
        require((mask == (instance == annotation["instance_id"])).all(), "mask")
        require(masks.toBbox(coco.annToRLE(annotation)).tolist() == annotation["bbox"], "box of the mask")
        require(int(mask.sum()) == annotation["area"], "area")
        require(coco.loadCats(annotation["category_id"])[0]["name"] in ("table", "chair", "ball"), "name of the class")
        seen.add(annotation["instance_id"])
        compared += 1
    labelled = {int(row["instance"]) for row in run.table("instances") if row["class"]}
    require(seen == labelled & set(np.unique(instance).tolist()), "things that have annotations")
require(compared > 5, "number of annotations")
