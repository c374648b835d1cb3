"""pycocotools: a dataset of an office is read, and its annotations are scored against themselves.

packages: pycocotools==2.0.11 numpy==2.4.6
"""
import contextlib
import sys
import time

from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

import trial

SCENE = f"""
  <include file="{trial.ROOT}/scenes/marvin/marvin.xml"/>
  <element type="label" name="CHAIRS" insert_at="ROOT" parts="CHAIR_*" class="chair" class_id="1"/>
  <element type="label" name="TABLES" insert_at="ROOT" parts="TABLE_*" class="table" class_id="2"/>
  <sensor type="camera" name="EYE" insert_at="LAB" pose_offset="-5.3 -4.1 2.5 0 19 40" width="640" height="480" hfov="76"
          outputs="color instance boxes"/>"""


def measure(folder):
    out = trial.simvis_run(SCENE, folder, "--sensor", "EYE", "--dataset", "coco", "--frames", 3)
    begin, scores = time.monotonic(), []
    with contextlib.redirect_stdout(sys.stderr):
        truth = COCO(str(out / "annotations/instances.json"))
        found = truth.loadRes([{**each, "score": 1.0} for each in truth.dataset["annotations"]])
        areas = [abs(truth.annToMask(each).sum() - each["area"]) for each in truth.dataset["annotations"]]
        for kind in ("bbox", "segm"):
            score = COCOeval(truth, found, kind)
            score.evaluate()
            score.accumulate()
            score.summarize()
            scores.append(score.stats[0])
    seconds = time.monotonic() - begin
    return [("annotations", len(areas), "", seconds), ("average precision of boxes", scores[0], "of 1", seconds),
            ("average precision of masks", scores[1], "of 1", seconds),
            ("difference of areas, largest", max(areas), "px", seconds)]


trial.main(measure)
