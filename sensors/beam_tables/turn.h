// Angles of a turn.
#pragma once

#include <cmath>

namespace simvis {

/// The same direction from -180, included, to 180 degrees.
inline double wrapped_deg(double angle_deg) {
  const double wrapped = angle_deg - 360 * std::floor((angle_deg + 180) / 360);
  return wrapped >= 180 ? wrapped - 360 : wrapped;
}

}  // namespace simvis
