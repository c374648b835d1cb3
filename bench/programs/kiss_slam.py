"""KISS-SLAM: the same way from the same bag as KISS-ICP, with a graph of poses.

packages: kiss-slam==0.0.2 kiss-icp==1.3.0 rosbags==0.9.23 pillow==13.0.0 matplotlib==3.11.2 numpy==2.2.6
"""
import numpy as np

import trial


def measure(folder):
    _, true = trial.drive_with_scanner(folder, "ravon", 'preset="ouster_os1_32"', "--record", f"{folder}/bag/")
    seconds = trial.run_program("kiss_slam_pipeline", folder / "bag", "--topic", "/SCANNER/points", cwd=folder)
    estimated = np.load(folder / "slam_output/latest/bag_poses.npy")
    trial.draw_paths(folder / "picture.svg", true, estimated)
    return trial.path_rows(true, estimated, seconds)


trial.main(measure)
