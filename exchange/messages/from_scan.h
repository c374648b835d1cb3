// Messages from the measurements of laser scanners and infrared distance sensors.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

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

/// The channel of the speed along the beam, which clouds have as the float32 field "radial_speed".
inline constexpr std::string_view kTrueRadialSpeed = "true_radial_speed_mps";

/// Returns the time at which the first beam was sent; the time of the scan if it has no channel "time_s". Negative if
/// that was before time 0. Rounded down to a nanosecond, so that no beam was sent before it.
std::int64_t first_beam_ns(const Scan& scan);

/// The stamp of messages: that of the first beam. No stamp is before time 0, so a scan that began earlier has stamp 0;
/// the times of its beams count from the first one as always.
std::int64_t stamp_ns(const Scan& scan);

/// Scan::points() with NaN for a range of 0.
std::vector<glm::dvec3> returned_points(const Scan& scan);

/// All beams in rows by ring, with the fields x, y, z, error_bound_m (float32) and ring (uint16), "intensity" of the
/// channel of this name as float32, "time" in seconds behind header.stamp as float32 of the channel "time_s",
/// "radial_speed" in m/s as float32, and any other channel under its own name as float64. A beam without a point has
/// NaN as x, y and z; with `dense` it is left out, and the cloud has one row. With a channel "time_s", header.stamp is
/// the time of the first beam, rounded down to a nanosecond, as that of laser_scan() and as drivers have it; it is that
/// of the scan if the first beam is before time 0.
PointCloud2 point_cloud(const Scan& scan, const std::string& frame_id, bool dense = false);

}  // namespace simvis::ros
