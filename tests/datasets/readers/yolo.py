"""Reads what python/examples/coco_to_yolo.py has made, and compares it with the images of instances of a run."""
import pathlib
import sys

import numpy as np
import yaml
from PIL import Image

from run_files import Run, require

folder, run = pathlib.Path(sys.argv[1]), Run(sys.argv[2])
data = yaml.safe_load((folder / "data.yaml").read_text())
names = data["names"]
require(sorted(names.values()) == ["ball", "chair", "stool", "table"], f"names of classes: {names}")
objects = {int(row["instance"]): row["class"] for row in run.table("objects") if row["class"]}
labels = sorted((folder / "labels" / "train").iterdir())
require(len(labels) == 4, f"number of files of labels: {len(labels)}")
compared = 0
ROUNDING = 0.5e-6 * (1 + 1)  # of numbers with six decimals: a middle and half a width, as shares
for file in labels:
    frame = int(file.stem.split("_")[-1])
    picture = Image.open(folder / data["train"] / (file.stem + ".png"))
    instance = run.plane("instance", frame)
    require(picture.size == instance.shape[::-1], "size of a picture")
    boxes = []
    for number, name in objects.items():
        rows, columns = np.nonzero(instance == number)
        if len(rows) > 0:
            boxes.append((name, columns.min(), rows.min(), columns.max() + 1, rows.max() + 1))
    read = []
    for line in file.read_text().splitlines():
        kind, x, y, w, h = line.split()
        x, y, w, h = (float(text) for text in (x, y, w, h))
        read.append((names[int(kind)], x - w / 2, y - h / 2, x + w / 2, y + h / 2))
    require(len(read) == len(boxes), "number of objects")
    scale = np.array([picture.size[0], picture.size[1]] * 2)
    for box in boxes:
        near = [each for each in read if each[0] == box[0] and
                np.abs(np.array(each[1:]) - np.array(box[1:]) / scale).max() <= ROUNDING]
        require(len(near) == 1, f"box of a {box[0]} in frame {frame}")
        compared += 1
require(compared > 5, "number of boxes")
