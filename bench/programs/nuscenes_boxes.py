"""nuscenes-devkit: a drive past cars and pedestrians is read; its boxes hold the points counted for them, and are drawn.

packages: nuscenes-devkit==1.2.0 numpy==1.26.4
"""
import os
import time

os.environ["MPLBACKEND"] = "Agg"  # before the devkit imports matplotlib
from nuscenes.nuscenes import NuScenes
from nuscenes.utils.data_classes import LidarPointCloud
from nuscenes.utils.geometry_utils import BoxVisibility, points_in_box

import trial

WIDER = 1.01  # ranges are whole steps of 2 mm, so points lie up to 1 mm off the faces of boxes


CLASSES = ("vehicle.car", "vehicle.truck", "human.pedestrian.adult", "human.pedestrian.child")


def shape(name, label, place, size):
    return f"""
  <part name="{name}" insert_at="ROOT" shape="box" size="{size}" pose_offset="{place}"/>
  <element type="label" name="{name}_LABEL" insert_at="ROOT" part="{name}" class="{label}"
           class_id="{1 + CLASSES.index(label)}"/>"""


# All shapes are clear of the ground, whose points are in no box.
SCENE = f"""
  <element type="sky" name="SKY" insert_at="ROOT"/>
  <element type="light" name="SUN" insert_at="ROOT"/>
  <part name="GROUND" insert_at="ROOT" shape="box" size="80 80 0.1" pose_offset="0 0 -0.15 0 0 0"/>
  {shape("CAR_1", "vehicle.car", "9 2.5 0.85 0 0 10", "4.2 1.8 1.5")}
  {shape("CAR_2", "vehicle.car", "14 -3 0.85 0 0 175", "4.4 1.8 1.5")}
  {shape("VAN", "vehicle.truck", "19 3.2 1.4 0 0 0", "6 2.2 2.6")}
  {shape("WALKER_1", "human.pedestrian.adult", "7 -2 0.95 0 0 0", "0.5 0.6 1.7")}
  {shape("WALKER_2", "human.pedestrian.child", "11 0.4 0.7 0 0 40", "0.4 0.5 1.2")}
  <part name="EGO" insert_at="ROOT"/>
  <element type="pose" name="DRIVE" insert_at="EGO"/>
  <part name="ROOF" insert_at="EGO" pose_offset="0 0 1.8 0 0 0"/>
  <sensor type="laser_scanner" name="LIDAR_TOP" insert_at="ROOF" preset="velodyne_hdl32e" firing="together"
          truth="instance" rate="2"/>
  <sensor type="camera" name="CAM_FRONT" insert_at="ROOF" pose_offset="0.5 0 -0.2 0 4 0" width="800" height="450" hfov="70"
          outputs="color instance boxes" rate="2" supersampling="4"/>"""


def measure(folder):
    (folder / "drive.csv").write_text("time_s,DRIVE.x,DRIVE.yaw\n0,0,0\n2,5,4\n")
    out = trial.simvis_run(SCENE, folder, "--trajectory", folder / "drive.csv", "--rate", 2, "--dataset", "nuscenes",
                           "--strict")
    begin = time.monotonic()
    nusc = NuScenes(version="v1.0-simvis", dataroot=str(out), verbose=False)
    counted, wrong, drawn = 0, 0, 0
    for sample in nusc.sample:
        path, boxes, _ = nusc.get_sample_data(sample["data"]["LIDAR_TOP"])
        points = LidarPointCloud.from_file(path).points[:3]
        for box in boxes:
            expected = nusc.get("sample_annotation", box.token)["num_lidar_pts"]
            counted += expected
            wrong += abs(points_in_box(box, points, WIDER).sum() - expected)
        drawn += len(nusc.get_sample_data(sample["data"]["CAM_FRONT"], box_vis_level=BoxVisibility.ANY)[1])
    nusc.render_sample_data(nusc.sample[0]["data"]["CAM_FRONT"], out_path=str(folder / "picture.png"), verbose=False)
    seconds = time.monotonic() - begin
    return [("annotations", len(nusc.sample_annotation), "", seconds), ("boxes in pictures", drawn, "", seconds),
            ("points counted in boxes", counted, "", seconds), ("of these, outside or of another object", wrong, "", seconds)]


trial.main(measure)
