"""KISS-ICP: the way of a robot outdoors from the clouds of an Ouster OS1-32, read from a bag of --record as it is.

packages: kiss-icp==1.3.0 rosbags==0.9.23 numpy==2.4.6
authors: 0.49 % of the path on KITTI in the paper; 0.6 % when a user measured it (PRBonn/kiss-icp#315)
"""
import numpy as np

import trial


def measure(folder, range_noise_m=0.01, firing="pattern"):
    _, true = trial.drive_with_scanner(folder, "ravon",
                                       f'preset="ouster_os1_32" range_noise="{range_noise_m}" firing="{firing}"',
                                       "--record", f"{folder}/bag/")
    seconds = trial.run_program("kiss_icp_pipeline", folder / "bag", "--topic", "/SCANNER/points", cwd=folder)
    estimated = np.load(folder / "results/latest/bag_poses.npy")
    trial.draw_paths(folder / "picture.svg", true, estimated)
    return trial.path_rows(true, estimated, seconds)


trial.main(measure, range_noise_m=(0, 0.01, 0.03, 0.1), firing=("together", "pattern"))
