"""Makes a YOLO dataset of a COCO dataset: python3 coco_to_yolo.py COCO YOLO.

COCO is a folder that `simvis-run --dataset coco` has written. YOLO gets, with links to the images:

    data.yaml                      path and names of the classes
    images/train/CAMERA_000000.png
    labels/train/CAMERA_000000.txt CLASS X Y WIDTH HEIGHT of each object: the middle of its box, as shares of the image

Classes of YOLO count from 0, in the order of COCO's ids. An image without objects has an empty file of labels.
"""
import json
import os
import pathlib
import sys


def label_of(annotation, image, classes):
    x, y, width, height = annotation["bbox"]
    shares = ((x + width / 2) / image["width"], (y + height / 2) / image["height"],
              width / image["width"], height / image["height"])
    return " ".join([str(classes[annotation["category_id"]])] + [f"{share:.6f}" for share in shares])


def convert(coco, yolo):
    dataset = json.loads((coco / "annotations" / "instances.json").read_text(encoding="utf-8"))
    categories = sorted(dataset["categories"], key=lambda each: each["id"])
    classes = {each["id"]: i for i, each in enumerate(categories)}
    lines = {image["id"]: [] for image in dataset["images"]}
    images = {image["id"]: image for image in dataset["images"]}
    for annotation in dataset["annotations"]:
        lines[annotation["image_id"]].append(label_of(annotation, images[annotation["image_id"]], classes))
    for folder in ("images/train", "labels/train"):
        (yolo / folder).mkdir(parents=True)
    for number, image in images.items():
        name = image["file_name"].replace("/", "_")
        os.symlink((coco / "images" / image["file_name"]).resolve(), yolo / "images" / "train" / name)
        text = "".join(line + "\n" for line in lines[number])
        (yolo / "labels" / "train" / name).with_suffix(".txt").write_text(text, encoding="utf-8")
    names = "".join(f"  {i}: {json.dumps(each['name'])}\n" for i, each in enumerate(categories))
    (yolo / "data.yaml").write_text(f"path: {json.dumps(str(yolo.resolve()))}\ntrain: images/train\nval: images/train\n"
                                    f"names:\n{names}", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    convert(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
