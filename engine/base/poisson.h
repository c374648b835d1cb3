// Poisson-distributed random counts, such as the number of electrons that light releases.
#pragma once

#include <cstdint>

#include <simvis/philox.h>

namespace simvis {

/// The largest mean for which poisson() is exact.
inline constexpr double kMaxExactMean = 64;

/// A whole number from the Poisson distribution of this mean (0 to 1e15). `frame`, `element` and `draw` identify it as
/// in SensorRandom. Up to kMaxExactMean the distribution function is inverted, exact to the 2^-53 of uniform(). Above
/// it, a Gaussian number with the same mean, variance and skewness is rounded: mean + sqrt(mean) z + (z^2 - 1) / 6 (E.
/// A. Cornish and R. A. Fisher, Revue de l'Institut International de Statistique 5, 1938), whose distribution function
/// is off by less than 0.1 / mean.
double poisson(const SensorRandom& random, double mean, std::uint64_t frame, std::uint32_t element, std::uint32_t draw);

}  // namespace simvis
