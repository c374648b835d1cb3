#include "sensors/event_camera/brownian_bridge.h"

#include <cmath>

namespace simvis {

double chance_of(const BrownianBridge& bridge) {
  return bridge.end <= 0 ? 1 : std::exp(-2 * bridge.begin * bridge.end / bridge.variance);
}

double first_time(const BrownianBridge& bridge, double normal, double uniform) {
  const double square = normal * normal, drift = std::abs(bridge.end);
  if (drift == 0) {  // without a mean: Levy's distribution
    const double shape = bridge.begin * bridge.begin / bridge.variance;
    return shape / (shape + square);
  }
  const double mean = bridge.begin / drift;
  // The two roots of a quadratic equation in units of the mean, whose product is 1.
  const double half = square * bridge.variance / (2 * drift * bridge.begin);
  const double larger = 1 + half + std::sqrt(half * (2 + half));
  const double time = uniform * (1 + 1 / larger) <= 1 ? mean / larger : mean * larger;
  return time / (1 + time);
}

}  // namespace simvis
