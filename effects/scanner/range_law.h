// The receiver of a scanner adds noise to the range of each return and rounds it. Ranges and deviations are in metres.
#pragma once

#include <cmath>

#include "effects/reported_range.h"

namespace simvis {

/// The range with two independent errors, whose deviations are `sigma_m` and `sigma_rel` times the range; at least 0.
/// `gaussian` is a sample of the normal distribution with mean 0 and deviation 1.
inline double noisy_range_m(double range_m, double sigma_m, double sigma_rel, double gaussian) {
  return reported_range_m(range_m + std::hypot(sigma_m, sigma_rel * range_m) * gaussian);
}

/// The multiple of the step that is nearest to the range; of two that are equally near, the larger one.
inline double rounded_range_m(double range_m, double step_m) { return std::floor(range_m / step_m + 0.5) * step_m; }

}  // namespace simvis
