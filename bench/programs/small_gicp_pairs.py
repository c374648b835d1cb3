"""small_gicp: pairs of clouds indoors, half a second of a robot's way apart, laid together without a first guess.

packages: small-gicp==1.0.1 numpy==2.4.6
"""
import time

import numpy as np
import small_gicp

import trial

APART = 5  # frames


def measure(folder):
    out, poses = trial.drive_with_scanner(folder, "marvin", 'preset="ouster_os1_32" firing="together"', frames=61)
    clouds = [trial.cloud(file) for file in sorted(out.glob("SCANNER/*.bin"))[::APART]]
    poses, begin = poses[::APART], time.monotonic()
    found = [small_gicp.align(target, source, downsampling_resolution=0.1).T_target_source
             for target, source in zip(clouds, clouds[1:])]
    seconds = time.monotonic() - begin
    places, turns = trial.step_errors(np.linalg.inv(poses[:-1]) @ poses[1:], found)
    return [("place, median of 12 pairs", np.median(places), "m", seconds), ("place, largest", places.max(), "m", seconds),
            ("attitude, largest", turns.max(), "deg", seconds)]


trial.main(measure)
