"""GenZ-ICP: the same way from the same bag as KISS-ICP.

packages: genz-icp==0.3.2 rosbags==0.9.23 numpy==2.4.6
"""
import numpy as np

import trial


def measure(folder):
    _, true = trial.drive_with_scanner(folder, "ravon", 'preset="ouster_os1_32"', "--record", f"{folder}/bag/")
    seconds = trial.run_program("genz_icp_pipeline", folder / "bag", "--topic", "/SCANNER/points", cwd=folder)
    estimated = np.load(folder / "results/latest/bag_poses.npy")
    trial.draw_paths(folder / "picture.svg", true, estimated)
    return trial.path_rows(true, estimated, seconds)


trial.main(measure)
