"""Scans of many simulations with other seeds, in processes of their own, as one NumPy file.

    python make_dataset.py
"""
import sys

import numpy as np
import simvis


def front_ranges(sim: simvis.Simulation) -> np.ndarray:
    sim.only("FRONT_SCANNER")
    sim.step()
    return sim.sensors["FRONT_SCANNER"].range_m.copy()


if __name__ == "__main__":
    short = "--short" in sys.argv
    poses = [{"R_POSE.yaw": float(yaw)} for yaw in range(0, 360, 180 if short else 10)]
    scans = np.stack(list(simvis.map(front_ranges, simvis.scene("marvin"), parameters=poses, workers=2)))
    np.save("scans.npy", scans)
    print(scans.shape, "in scans.npy")
