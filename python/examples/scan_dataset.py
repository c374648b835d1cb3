"""A PyTorch data set of scans and poses, drawn at random in the laboratory. Each worker has a simulation of its own.

    python scan_dataset.py
"""
import random
import sys

import simvis
from simvis.data import Frames
from torch.utils.data import DataLoader


def place(draw: random.Random) -> dict[str, float]:
    return {"R_POSE.x": draw.uniform(-3, 3), "R_POSE.y": draw.uniform(-2, 2), "R_POSE.yaw": draw.uniform(-180, 180)}


if __name__ == "__main__":
    frames = Frames(simvis.scene("marvin"), 4 if "--short" in sys.argv else 64, place, ["FRONT_SCANNER.range_m"])
    loader = DataLoader(frames, batch_size=4, num_workers=2, multiprocessing_context="spawn")
    print(sum(len(batch["FRONT_SCANNER.range_m"]) for batch in loader), "scans")
