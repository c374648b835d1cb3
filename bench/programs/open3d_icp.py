"""Open3D: the same pairs of clouds as small_gicp, by point-to-plane ICP after a coarse pass.

packages: open3d==0.20.0 numpy==2.2.6
"""
import numpy as np
import open3d

import trial

PASSES_M = (1.0, 0.2)  # largest distances of a correspondence


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


def align_all(clouds):
    clouds = [prepared(points) for points in clouds]
    return [align(target, source) for target, source in zip(clouds, clouds[1:])]


def measure(folder):
    return trial.pair_rows(folder, align_all)


trial.main(measure)
