// What a receiver does to the range of a return: noise and rounding.
#pragma once

#include <algorithm>
#include <cmath>

namespace simvis {

/// The range with noise; `gaussian` is normally distributed with deviation 1. Both deviations are independent.
inline double noisy_range_m(double range_m, double sigma_m, double sigma_rel, double gaussian) {
  return std::max(range_m + std::hypot(sigma_m, sigma_rel * range_m) * gaussian, 0.0);
}

/// The nearest multiple of the step, halves up.
inline double rounded_range_m(double range_m, double step_m) { return std::floor(range_m / step_m + 0.5) * step_m; }

}  // namespace simvis
