// Point clouds: PLY, PCD and KITTI's .bin, each with one point per beam that has one.
#pragma once

#include <string>

#include "program/output/table_frame.h"

namespace simvis {

/// Binary little-endian PLY: vertices with x, y and z in metres in the sensor's frame, and every other column under its
/// own name. Comments hold the time and the pose. The table has points (asserted, as below).
std::string encode_ply(const TableFrame& table);

/// Binary PCD 0.7 with the same fields. VIEWPOINT is the pose of the sensor in the world.
std::string encode_pcd(const TableFrame& table);

/// Four float32 per point: x, y, z and the column `intensity`, or 0 if the table has none.
std::string encode_kitti(const TableFrame& table);

}  // namespace simvis
