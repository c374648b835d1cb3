#include "engine/base/poisson.h"

#include <algorithm>
#include <cmath>

namespace simvis {

double poisson(const SensorRandom& random, double mean, std::uint64_t frame, std::uint32_t element,
               std::uint32_t draw) {
  if (!(mean > 0)) return 0;
  if (mean > kMaxExactMean) {
    const double z = random.gaussian(frame, element, draw);
    return std::max(0.0, std::round(mean + std::sqrt(mean) * z + (z * z - 1) / 6));
  }
  const double u = random.uniform(frame, element, draw);
  double probability = std::exp(-mean), sum = probability;
  double count = 0;
  while (u >= sum && probability > 0) {
    count += 1;
    probability *= mean / count;
    sum += probability;
  }
  return count;
}

}  // namespace simvis
