"""ouster-cli: SLAM indoors from the packets of two Ouster presets as they come, at the packets' own stamps.

packages: ouster-sdk==1.0.1 numpy==2.4.6
"""
import numpy as np
from ouster.sdk import open_source

import trial

PRESETS = ("ouster_os0_32", "ouster_os1_32")
FRAMES, PERIOD_S, CLOCK_S = 100, 0.1, 3600  # the clock of the packets at the simulation's time 0
COLUMNS = 64  # every so many columns of a turn are compared


def between(poses, time_s):
    """The pose at a time between two frames: the motion of a frame is a constant screw, here in small angles."""
    frame = np.clip(time_s / PERIOD_S, 0, len(poses) - 1)
    before, after = poses[int(frame)], poses[min(int(frame) + 1, len(poses) - 1)]
    share, turn = frame - int(frame), (np.linalg.inv(before) @ after)[:3, :3]
    yaw = share * np.arctan2(turn[1, 0], turn[0, 0])  # the robot drives on a level floor
    pose = before.copy()
    pose[:3, :3] = before[:3, :3] @ [[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]]
    pose[:3, 3] += share * (after[:3, 3] - before[:3, 3])
    return pose


def slam(folder, preset):
    _, poses = trial.drive_with_scanner(folder, "marvin", f'preset="{preset}" intensity="on"', "--record-pcap",
                                        f"SCANNER={folder}/{preset}.pcap", frames=FRAMES)
    seconds = trial.run_program("ouster-cli", "source", folder / f"{preset}.pcap", "slam", "save", folder / f"{preset}.osf")
    true, estimated = [], []
    for frame, *_ in open_source(str(folder / f"{preset}.osf")):
        for column in range(COLUMNS - 1, frame.w, COLUMNS):
            true.append(between(poses, frame.timestamp[column] / 1e9 - CLOCK_S))
            estimated.append(np.array(frame.body_to_world[column]))
    return np.array(true), np.array(estimated), seconds


def measure(folder):
    rows = []
    for preset in PRESETS:
        true, estimated, seconds = slam(folder, preset)
        place_m, turn_deg = trial.trajectory_error(true, estimated)
        rows += [(f"{preset}: place, RMS", place_m, "m", seconds), (f"{preset}: attitude, largest", turn_deg, "deg", seconds)]
        if preset == PRESETS[0]:
            trial.draw_paths(folder / "picture.svg", true[::16], estimated[::16])
    return rows


trial.main(measure)
