"""evo: the error of a robot's wheel odometry indoors, beside that of our own formula.

packages: evo==1.38.1 numpy==2.4.6
"""
import csv
import time

from evo.core import metrics, sync
from evo.tools import file_interface

import trial

SCENE = f"""
  <include file="{trial.ROOT}/scenes/marvin/marvin.xml"/>
  <sensor type="odometry" name="ODOM" insert_at="ROBOT" kind="wheel" left_scale_error="0.01" slip_stddev="0.005"/>"""


def measure(folder):
    out = trial.simvis_run(SCENE, folder, "--sensor", "ODOM", "--trajectory", trial.ROOT / "scenes/marvin/drive.csv", "--rate",
                           10, "--poses", "ROBOT")
    with open(out / "ODOM.csv", newline="") as file:
        lines = [" ".join(row[name] for name in ("time_s", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"))
                 for row in csv.DictReader(file)]
    (folder / "odom.tum").write_text("\n".join(lines) + "\n")
    begin = time.monotonic()
    pair = sync.associate_trajectories(*(file_interface.read_tum_trajectory_file(str(file))
                                         for file in (out / "ROBOT_poses.tum", folder / "odom.tum")))
    pair[1].align_origin(pair[0])
    error = metrics.APE(metrics.PoseRelation.translation_part)
    error.process_data(pair)
    found, seconds = error.get_statistic(metrics.StatisticsType.rmse), time.monotonic() - begin
    true, estimated = trial.rigid(out / "ROBOT_poses.tum"), trial.rigid(folder / "odom.tum")
    trial.draw_paths(folder / "picture.svg", true, estimated)
    return [("place of the odometry, RMS", found, "m", seconds),
            ("difference to our formula", abs(found - trial.trajectory_error(true, estimated)[0]), "m", seconds)]


trial.main(measure)
