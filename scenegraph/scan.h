// What a laser scanner measures in one frame.
#pragma once

#include <cstdint>
#include <vector>

namespace simvis {

/// Ranges of one sweep.
///
/// Frames   S = sensor: x forward, y left, z up. Azimuth is counter-clockwise from +x about +z, elevation positive
///          upwards: the beam's direction is (cos e cos a, cos e sin a, sin e).
/// Shape    range_m[ring * columns + beam]; rings by increasing elevation, beams by increasing azimuth as configured.
/// Units    metres along the ray (not the Z depth of the virtual camera that produced it).
/// Special  +infinity: nothing within range_max; 0: what the beam meets is nearer than range_min.
/// Bounds   the true range lies within range_m +- error_bound_m. Infinity: a silhouette passes so near the beam that
///          the method cannot tell which surface it meets. Of a rendered range it speaks of what is at least three
///          pixels of the method wide (see sensors/depth_range.h), of one that was cast of everything (see
///          engine/ray_caster.h).
struct Scan {
  std::uint32_t rings = 0, columns = 0;
  std::vector<double> azimuth_rad;    ///< by beam
  std::vector<double> elevation_rad;  ///< by ring
  std::vector<float> range_m;
  std::vector<float> error_bound_m;
};

}  // namespace simvis
