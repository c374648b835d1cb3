// What a laser scanner measures in one frame.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

/// One more number per beam, which an effect adds: the scan's CSV has a column of this name.
struct ScanChannel {
  std::string name;             ///< with its unit where it has one: "intensity", "time_s"
  std::string format = "%.9g";  ///< of printf, for one double
  std::vector<double> values;   ///< as Scan::range_m; NaN: none
};

/// Unit vector in the sensor frame: azimuth counter-clockwise from +x about +z, elevation positive upwards.
inline glm::dvec3 beam_direction(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::sin(elevation_rad)};
}

/// Ranges of one sweep.
///
/// Frames   S = sensor: x forward, y left, z up. Azimuth is counter-clockwise from +x about +z, elevation positive
///          upwards: see beam_direction().
/// Shape    range_m[ring * columns + beam]; rings by increasing elevation, beams by increasing azimuth as configured.
/// Units    metres along the ray (not the Z depth of the virtual camera that produced it).
/// Special  +infinity: nothing within range_max; 0: what the beam meets is nearer than range_min.
/// Bounds   the true range lies within range_m +- error_bound_m. Infinity: a silhouette passes so near the beam that
///          the method cannot tell which surface it meets. Of a rendered range it speaks of what is at least three
///          pixels of the method wide (see sensors/depth_range.h), of one that was cast of everything (see
///          engine/ray_caster.h). Noise comes on top: the bound speaks of the range before it.
/// Channels those of the effects that the scanner has, in their order; none without.
struct Scan {
  std::uint32_t rings = 0, columns = 0;
  std::vector<double> azimuth_rad;    ///< by beam
  std::vector<double> elevation_rad;  ///< by ring
  std::vector<float> range_m;
  std::vector<float> error_bound_m;
  std::vector<ScanChannel> channels{};

  /// Null where there is none of that name.
  const ScanChannel* channel(std::string_view name) const {
    const auto found = std::ranges::find(channels, name, &ScanChannel::name);
    return found == channels.end() ? nullptr : &*found;
  }
};

}  // namespace simvis
