"""GenZ-ICP: the same way from the same bag as KISS-ICP.

packages: genz-icp==0.3.2 rosbags==0.9.23 numpy==2.4.6
"""
import trial


def measure(folder):
    return trial.odometry_rows(folder, "genz_icp_pipeline", "results/latest/bag_poses.npy")


trial.main(measure)
