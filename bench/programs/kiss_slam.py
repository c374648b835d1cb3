"""KISS-SLAM: the same way from the same bag as KISS-ICP, with a graph of poses; no loop is closed.

packages: kiss-slam==0.0.2 kiss-icp==1.3.0 rosbags==0.9.23 pillow==13.0.0 matplotlib==3.11.2 numpy==2.2.6
authors: 0.84 to 1.65 % of the path when a user measured it, Ouster of HeLiPR (PRBonn/kiss-slam#50)
"""
import trial


def measure(folder):
    return trial.odometry_rows(folder, "kiss_slam_pipeline", "slam_output/latest/bag_poses.npy")


trial.main(measure)
