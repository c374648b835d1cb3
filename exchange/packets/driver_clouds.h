// Clouds as the drivers of real scanners publish them, for programs that read these and nothing else.
//
//   velodyne  x y z intensity: float32; ring: uint16; time: float32, seconds behind the stamp. 22 bytes, without gaps.
//             Source: velodyne_pointcloud, pointcloudXYZIRT.cpp. Points that have a return, in one row.
//   ouster    x y z, intensity at 16: float32; t at 20: uint32, nanoseconds behind the stamp; reflectivity at 24, ring
//             at 26, ambient at 28: uint16; range at 32: uint32, millimetres. 48 bytes. Source: ouster-ros, os_point.h.
//             All points, one row for each ring.
//   livox     x y z intensity: float32; tag, line: uint8; timestamp: float64, nanoseconds. 26 bytes, without gaps.
//             Source: livox_ros_driver2, lddc.cpp and comm.h. Points that have a return, in one row.
//
// Units    intensity of velodyne and livox, and reflectivity, are the calibrated reflectivity from 0 to 255, of the
//          channel "reflectivity" or "intensity"; intensity of ouster is the signal in photons (kSignalUnit). Without
//          such a channel they are 0. ambient is 0.
// Stamp    the time of the first beam, so that no time behind it is negative: velodyne_driver with
//          timestamp_first_packet.
#pragma once

#include <string>
#include <string_view>

#include <simvis/scan.h>
#include "exchange/messages/types/livox_types.h"
#include "exchange/messages/types/sensor_types.h"

namespace simvis::ros {

/// The cloud in the layout of a driver. `driver` is "velodyne", "ouster" or "livox" (asserted); `dense` leaves out the
/// points of "ouster" without a return.
PointCloud2 driver_cloud(std::string_view driver, const Scan& scan, const std::string& frame_id, bool dense);

/// The points that have a return, as livox_ros_driver2 publishes them for FAST-LIO and others.
CustomMsg livox_message(const Scan& scan, const std::string& frame_id);

}  // namespace simvis::ros
