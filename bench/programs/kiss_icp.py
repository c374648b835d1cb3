"""KISS-ICP: the way of a robot outdoors from the clouds of an Ouster OS1-32, read from a bag of --record as it is.

packages: kiss-icp==1.3.0 rosbags==0.9.23 numpy==2.4.6
authors: 0.49 % of the path on KITTI in the paper; 0.6 % when a user measured it (PRBonn/kiss-icp#315)
"""
import trial


def measure(folder, range_noise_m=0.01, firing="pattern"):
    return trial.odometry_rows(folder, "kiss_icp_pipeline", "results/latest/bag_poses.npy",
                               scanner=f'range_noise="{range_noise_m}" firing="{firing}"')


trial.main(measure, range_noise_m=(0, 0.01, 0.03, 0.1), firing=("together", "pattern"))
