// How likely a receiver with noise detects an echo.
//
// Law      An echo of the power P is an amplitude with Gaussian noise of the deviation s T against a threshold T: it is
//          lost with the probability erfc((P - T) / (s T sqrt(2))) / 2. Without noise it is lost below the threshold.
#pragma once

#include <cmath>
#include <numbers>

namespace simvis {

/// The probability that an echo is lost. Powers as Echo::power; `spread` is s, 0 or above.
inline double lost_share(double power, double threshold, double spread) {
  if (spread == 0) return power < threshold ? 1 : 0;
  return std::erfc((power - threshold) / (spread * threshold * std::numbers::sqrt2)) / 2;
}

/// The probability that it is detected, to full precision where it is small.
inline double kept_share(double power, double threshold, double spread) {
  if (spread == 0) return power < threshold ? 0 : 1;
  return std::erfc((threshold - power) / (spread * threshold * std::numbers::sqrt2)) / 2;
}

}  // namespace simvis
