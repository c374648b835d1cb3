"""KISS-ICP: the way of a robot outdoors from the clouds of an Ouster OS1-32, read from a bag of --record as it is.

packages: kiss-icp==1.3.0 rosbags==0.9.23 numpy==2.4.6
"""
import numpy as np

import trial

SCENE = f"""
  <include file="{trial.ROOT}/scenes/ravon/ravon.xml"/>
  <part name="MAST" insert_at="ROBOT" pose_offset="0 0 2.3 0 0 0"/>
  <sensor type="laser_scanner" name="OS" insert_at="MAST" preset="ouster_os1_32"/>"""
FRAMES = 100


def measure(folder):
    out = trial.simvis_run(SCENE, folder, "--sensor", "OS", "--trajectory", trial.ROOT / "scenes/ravon/drive.csv",
                            "--rate", 10, "--frames", FRAMES, "--record", f"{folder}/bag/", "--poses", "MAST")
    seconds = trial.run_program("kiss_icp_pipeline", folder / "bag", "--topic", "/OS/points", cwd=folder)
    estimated = np.load(folder / "results/latest/bag_poses.npy")
    true = trial.rigid(out / "MAST_poses.tum")
    place_m, turn_deg = trial.trajectory_error(true, estimated)
    length_m = trial.path_length(true)
    return [("place, RMS", place_m, "m", seconds), ("place, RMS over the path", 100 * place_m / length_m, "%", seconds),
            ("attitude, largest", turn_deg, "deg", seconds)]


trial.main(measure)
