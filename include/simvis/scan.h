// The measurement of a laser scanner in one frame.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

/// One more number per beam, which an effect adds. The scan's CSV file has a column of this name.
struct ScanChannel {
  std::string name;             ///< with its unit, if it has one: "intensity", "time_s"
  std::string format = "%.9g";  ///< of printf, for one double
  std::vector<double> values;   ///< in the shape of Scan::range_m; NaN: no value
};

/// The direction of a beam as a unit vector in the sensor frame: azimuth counter-clockwise from +x about +z, elevation
/// positive upwards.
inline glm::dvec3 beam_direction(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::sin(elevation_rad)};
}

/// Ranges of one sweep.
///
/// Frames   S = sensor: x forward, y left, z up. Azimuth is counter-clockwise from +x about +z, elevation positive
///          upwards: see beam_direction().
/// Shape    range_m[ring * beams + beam]; rings by increasing elevation, beams by increasing azimuth as configured.
/// Units    range along the ray in metres (not the depth along Z of the virtual camera that produced it).
/// Special  +infinity: nothing within range_max; 0: the beam hits a surface nearer than range_min.
/// Bounds   the true range lies within range_m +- error_bound_m. Infinity: a silhouette is so close to the beam that
///          the method cannot decide which surface the beam hits. The bound of a rasterised range covers surfaces that
///          are at least three pixels of the method wide (see sensors/raster_depth/depth_range.h); the bound of a cast
///          range covers all surfaces (see <simvis/ray_caster.h>). Noise is not included: the bound applies to the
///          range before noise is added.
/// Channels those of the effects that the scanner has, in their order; empty without such effects.
struct Scan {
  std::uint32_t rings = 0,              ///< number of rings
      beams = 0;                        ///< number of beams per ring
  std::vector<double> azimuth_rad;      ///< by beam
  std::vector<double> elevation_rad;    ///< by ring
  std::vector<float> range_m;           ///< range along the ray; +infinity and 0 as above
  std::vector<float> error_bound_m;     ///< in the shape of range_m
  std::vector<ScanChannel> channels{};  ///< further numbers per beam

  /// The channel of this name, or null. The pointer is valid until `channels` changes.
  const ScanChannel* channel(std::string_view name) const {
    const auto found = std::ranges::find(channels, name, &ScanChannel::name);
    return found == channels.end() ? nullptr : &*found;
  }
};

}  // namespace simvis
