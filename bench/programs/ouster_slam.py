"""ouster-cli: SLAM indoors from the packets of two Ouster presets as they come, at the packets' own stamps.

packages: ouster-sdk==1.0.1 small-gicp==1.0.1 numpy==2.4.6
"""
import numpy as np
import small_gicp
from ouster.sdk import core, open_source

import trial

PRESETS = ("ouster_os0_32", "ouster_os1_32")
FRAMES, PERIOD_S, CLOCK_S = 100, 0.1, 3600  # the clock of the packets at the simulation's time 0
COLUMNS = 64  # every so many columns of a turn are compared
CHECKED, CELL_M = 30, 0.15  # turns whose clouds are laid on the first one, and their sampling


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
    """The frames that ouster-cli writes, the true poses of the scanner, and the seconds that it took."""
    _, poses = trial.drive_with_scanner(folder, "marvin", f'preset="{preset}" intensity="on"', "--record-pcap",
                                        f"SCANNER={folder}/{preset}.pcap", frames=FRAMES)
    seconds = trial.run_program("ouster-cli", "source", folder / f"{preset}.pcap", "slam", "save", folder / f"{preset}.osf")
    return [frame for frame, *_ in open_source(str(folder / f"{preset}.osf"))], poses, seconds


def pose_of_column(frame, column, poses):
    return between(poses, frame.timestamp[column] / 1e9 - CLOCK_S)


def cloud_at_true_poses(frame, poses):
    """The points of the packets in the world, with the true pose at the stamp of each column."""
    world_from_column = np.array([pose_of_column(frame, column, poses) for column in range(frame.w)])
    points = core.XYZLut(frame.sensor_info)(frame)
    world = np.einsum("cij,rcj->rci", world_from_column[:, :3, :3], points) + world_from_column[:, :3, 3]
    return world[frame.field(core.ChanField.RANGE) > 0]


def turn_between(first, other):
    """The angle in degrees by which GICP turns a cloud that lies on the first one already."""
    found = small_gicp.align(first, other, downsampling_resolution=CELL_M, max_correspondence_distance=2 * CELL_M)
    return trial.step_errors([np.eye(4)], [found.T_target_source])[1][0]


def measure(folder):
    rows = []
    for preset in PRESETS:
        frames, poses, seconds = slam(folder, preset)
        columns = [(frame, column) for frame in frames for column in range(COLUMNS - 1, frame.w, COLUMNS)]
        true = np.array([pose_of_column(*each, poses) for each in columns])
        estimated = np.array([np.array(frame.body_to_world[column]) for frame, column in columns])
        place_m, turn_deg = trial.trajectory_error(true, estimated)
        first, *others = [cloud_at_true_poses(frame, poses) for frame in frames[:CHECKED]]
        rows += [(f"{preset}: place, RMS", place_m, "m", seconds), (f"{preset}: attitude, largest", turn_deg, "deg", seconds),
                 (f"{preset}: attitude of clouds at true poses by GICP, largest",
                  max(turn_between(first, other) for other in others), "deg", seconds)]
        if preset == PRESETS[0]:
            trial.draw_paths(folder / "picture.svg", true[::16], estimated[::16])
    return rows


trial.main(measure)
