"""Open3D: the same pairs of clouds as small_gicp, by point-to-plane ICP after a coarse pass.

packages: open3d==0.20.0 numpy==2.2.6
"""
import time

import numpy as np
import open3d

import trial

APART, PASSES_M = 5, (1.0, 0.2)  # frames; largest distances of a correspondence


def align(target, source):
    step, icp = np.eye(4), open3d.pipelines.registration
    for distance_m in PASSES_M:
        step = icp.registration_icp(source, target, distance_m, step,
                                    icp.TransformationEstimationPointToPlane()).transformation
    return step


def prepared(points):
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points)).voxel_down_sample(0.1)
    cloud.estimate_normals(open3d.geometry.KDTreeSearchParamHybrid(radius=0.5, max_nn=30))
    return cloud


def measure(folder):
    out, poses = trial.drive_with_scanner(folder, "marvin", 'preset="ouster_os1_32" firing="together"', frames=61)
    poses, begin = poses[::APART], time.monotonic()
    clouds = [prepared(trial.cloud(file)) for file in sorted(out.glob("SCANNER/*.bin"))[::APART]]
    found = [align(target, source) for target, source in zip(clouds, clouds[1:])]
    seconds = time.monotonic() - begin
    places, turns = trial.step_errors(np.linalg.inv(poses[:-1]) @ poses[1:], found)
    return [("place, median of 12 pairs", np.median(places), "m", seconds), ("place, largest", places.max(), "m", seconds),
            ("attitude, largest", turns.max(), "deg", seconds)]


trial.main(measure)
