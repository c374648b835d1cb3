// The effect `reflectivity`: adds a channel with the reflectivity in the unit of devices.
//
// Channel  "reflectivity": 100 times the reflectance of a matte surface that returns as much light from the same range
//          at a right angle, rounded to a whole number of at most 255. A white matte wall reads 100 at any range,
//          slanted surfaces less, and retro-reflectors from 101 to 255, as in the calibrated bytes of Velodyne and
//          Ouster sensors.
// Special  NaN, an empty cell, where there is no range: 0 and inf.
// Reference  Velodyne LiDAR, VLP-16 User Manual, 63-9243, section 6.1, calibrated reflectivity.
#pragma once

#include <algorithm>
#include <cmath>

namespace simvis {

/// For Echo::power of an echo, and its range above 0.
inline double calibrated_reflectivity(double power, double range_m) {
  return std::clamp(std::round(100 * power * range_m * range_m), 0.0, 255.0);
}

}  // namespace simvis
