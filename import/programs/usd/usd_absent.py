"""What of a stage is not there, or lies outside the folders of the part."""

import os
import re

from pxr import UsdShade

ASSET = re.compile(r"(?:Could not open asset|Could not load sublayer) @([^@]*)@.*? (?:introduced by|of layer) @([^@]*)@")
MAX_PATHS = 1000


def is_of_material(stage, error):
    """Whether an error of composition stands at a prim that is a material."""
    path = str(getattr(error, "rootSite", "")).rpartition("<")[2].rstrip(">")  # of LAYERS<PATH>
    prim = stage.GetPrimAtPath(path) if path.startswith("/") else None
    return bool(prim) and prim.IsA(UsdShade.Material)


class Absent:
    def __init__(self, folders):
        self.folders = [os.path.realpath(folder) for folder in folders]
        self.pictures, self.layers = set(), set()  # outside
        self.errors = []  # of composition, but for layers outside
        self.missing = 0  # arcs that would have brought shapes

    def is_outside(self, file):
        """Of a path without links."""
        return not any(file == folder or file.startswith(folder.rstrip("/") + "/") for folder in self.folders)

    def find_layers(self, stage):
        """References, payloads and layers that lead nowhere."""
        for each in stage.GetCompositionErrors():
            error = " ".join(str(each).split())
            named = ASSET.search(error)
            file = os.path.realpath(os.path.join(os.path.dirname(named[2]), named[1])) if named else ""
            if named and self.is_outside(file) and os.path.isfile(file):
                self.layers.add(file)
                continue
            self.errors.append(error[:300])
            if not (named and named[1].endswith(".mtlx")) and not is_of_material(stage, each):
                self.missing += 1

    def warnings(self):
        """The first references and other arcs that lead nowhere, and how many more there are."""
        shown = self.errors[:3]
        if len(self.errors) > len(shown):
            shown.append(f"the stage has {len(self.errors) - len(shown)} more such errors")
        return shown

    def description(self, shown):
        """For import/usd/usd_answer.cpp: `shown` prims have shapes."""
        return {
            "shown": shown,
            "missing": self.missing,
            "reason": self.errors[0] if self.errors else "",
            "layers_outside": sorted(self.layers)[:MAX_PATHS],
            "pictures_outside": sorted(self.pictures)[:MAX_PATHS],
        }
