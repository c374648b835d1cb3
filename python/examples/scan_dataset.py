"""A PyTorch dataset of scans and poses, drawn at random in the laboratory. Each worker has a simulation of its own.

    python scan_dataset.py
"""
import random
import sys
from collections.abc import Iterator

import simvis
import torch
from torch.utils.data import DataLoader, IterableDataset, get_worker_info


class Scans(IterableDataset[tuple[torch.Tensor, torch.Tensor]]):
    """Yields (ranges in metres, (x, y, yaw) of the robot). The same seed and number of workers give the same data."""

    def __init__(self, count: int, seed: int = 0) -> None:
        self.count, self.seed = count, seed

    def __iter__(self) -> Iterator[tuple[torch.Tensor, torch.Tensor]]:
        worker = get_worker_info()
        number, workers = (worker.id, worker.num_workers) if worker else (0, 1)
        sim = simvis.Simulation.load(simvis.scene("marvin"), threads=1, seed=self.seed)
        sim.only("FRONT_SCANNER")
        for index in range(number, self.count, workers):
            place = random.Random(f"{self.seed} {index}")
            pose = [place.uniform(-3, 3), place.uniform(-2, 2), place.uniform(-180, 180)]
            sim.elements["R_POSE"].set(x=pose[0], y=pose[1], yaw=pose[2])
            sim.step()
            # A copy, because PyTorch has no read-only tensors.
            yield torch.tensor(sim.sensors["FRONT_SCANNER"].range_m), torch.tensor(pose)


if __name__ == "__main__":
    count = 4 if "--short" in sys.argv else 64
    loader = DataLoader(Scans(count), batch_size=4, num_workers=2, multiprocessing_context="spawn")
    print(sum(len(ranges) for ranges, _ in loader), "scans")
