// Messages from the measurements of laser scanners and infrared distance sensors.
#pragma once

#include <optional>

#include <simvis/scan.h>
#include "exchange/messages/types/sensor_types.h"

namespace simvis::ros {

/// The ranges that a sensor reports, in metres. Unknown limits are 0 and infinity.
struct RangeLimits {
  double min_m = 0, max_m = 0;
};

/// A scan of one ring in the plane z = 0 whose azimuths are evenly spaced; empty for any other. As REP 117 says, a beam
/// without a return has +infinity and one whose surface is nearer than the limit has -infinity. Intensities are those
/// of the channel "intensity". A channel "time_s" makes header.stamp the time of the first beam, as in point_cloud(),
/// and gives time_increment if it grows evenly.
std::optional<LaserScan> laser_scan(const Scan& scan, const std::string& frame_id, const RangeLimits& limits,
                                    double scan_time_s);

/// All beams in rows by ring, with the fields x, y, z, error_bound_m (float32) and ring (uint16), "intensity" of the
/// channel of this name as float32, "time" in seconds behind header.stamp as float32 of the channel "time_s", and any
/// other channel under its own name as float64. A beam without a point has NaN as x, y and z. With a channel "time_s",
/// header.stamp is the time of the first beam, rounded down to a nanosecond, as that of laser_scan() and as drivers
/// have it; it is that of the scan if the first beam is before time 0.
PointCloud2 point_cloud(const Scan& scan, const std::string& frame_id);

}  // namespace simvis::ros
