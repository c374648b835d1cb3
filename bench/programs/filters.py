"""filterpy: an extended Kalman filter and a particle filter of GNSS and of odometry with noise added here, indoors.

packages: filterpy==2.0.0 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
"""
import csv
import time

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter
from filterpy.monte_carlo import systematic_resample

import trial

GNSS_M, NOISE, STEP_S, PARTICLES = 0.5, np.array([0.05, 0.02]), 0.1, 2000  # noise of speed in m/s and of turning in rad/s
METRES_PER_DEGREE = np.radians(6378137) * np.array([1, 1 - 0.00669437999014])  # at latitude 0: east, north
SCENE = f"""
  <include file="{trial.ROOT}/scenes/marvin/marvin.xml"/>
  <sensor type="gnss" name="GNSS" insert_at="ROBOT" horizontal_stddev="{GNSS_M}"/>
  <sensor type="odometry" name="ODOM" insert_at="ROBOT"/>"""


def column(file, *names):
    with open(file, newline="") as table:
        return np.array([[float(row[name]) for name in names] for row in csv.DictReader(table)])


def moved(state, motion):
    """x, y and yaw after a step: a body frame's speed and turning are those of the middle of the step."""
    yaw = state[2] + STEP_S * motion[1] / 2
    return np.array([state[0] + STEP_S * motion[0] * np.cos(yaw), state[1] + STEP_S * motion[0] * np.sin(yaw),
                     state[2] + STEP_S * motion[1]])


def kalman(start, fixes, motions):
    ekf, places, nis = ExtendedKalmanFilter(3, 2), [], []
    ekf.x, ekf.P, ekf.R = start.copy(), np.diag([1e-4] * 3), np.eye(2) * GNSS_M ** 2
    for fix, motion in zip(fixes, motions):
        c, s = np.cos(ekf.x[2]), np.sin(ekf.x[2])
        push = STEP_S * np.array([[c, 0], [s, 0], [0, 1]])
        f = np.array([[1, 0, -STEP_S * motion[0] * s], [0, 1, STEP_S * motion[0] * c], [0, 0, 1]])
        ekf.P, ekf.x = f @ ekf.P @ f.T + push @ np.diag(NOISE ** 2) @ push.T, moved(ekf.x, motion)
        ekf.update(fix, lambda x: np.eye(2, 3), lambda x: x[:2])
        nis.append(ekf.y @ ekf.SI @ ekf.y)
        places.append(ekf.x[:2].copy())
    return np.array(places), np.mean(nis)


def particles(start, fixes, motions):
    random, places, cloud = np.random.default_rng(1), [], np.tile(start[:, None], PARTICLES)
    for fix, motion in zip(fixes, motions):
        cloud = moved(cloud, motion[:, None] + random.normal(0, NOISE[:, None], (2, PARTICLES)))
        weights = np.exp(-0.5 * ((cloud[:2] - fix[:, None]) ** 2).sum(0) / GNSS_M ** 2) + 1e-300
        weights /= weights.sum()
        places.append(cloud[:2] @ weights)
        cloud = cloud[:, systematic_resample(weights)]
    return np.array(places)


def measure(folder):
    out = trial.simvis_run(SCENE, folder, "--sensor", "GNSS", "--sensor", "ODOM", "--trajectory",
                           trial.ROOT / "scenes/marvin/drive.csv", "--rate", 10, "--poses", "ROBOT")
    true = trial.rigid(out / "ROBOT_poses.tum")
    fixes = column(out / "GNSS.csv", "longitude_deg", "latitude_deg") * METRES_PER_DEGREE
    motions = column(out / "ODOM.csv", "velocity_x_m_s", "angular_velocity_z_rad_s")
    motions += np.random.default_rng(0).normal(0, NOISE, motions.shape)
    start = np.array([*true[0, :2, 3], np.arctan2(true[0, 1, 0], true[0, 0, 0])])
    begin = time.monotonic()
    (filtered, nis), cloud = kalman(start, fixes[1:], motions[1:]), particles(start, fixes[1:], motions[1:])
    seconds = time.monotonic() - begin
    rms = [np.sqrt(np.mean(((places - true[1:, :2, 3]) ** 2).sum(1))) for places in (fixes[1:], filtered, cloud)]
    return [("GNSS alone, RMS", rms[0], "m", seconds), ("Kalman filter, RMS", rms[1], "m", seconds),
            ("its normalised innovation squared, 2 expected", nis, "", seconds), ("particle filter, RMS", rms[2], "m", seconds)]


trial.main(measure)
