// How many of many rare things happen: electrons that light sets free, for one.
#pragma once

#include <cstdint>

#include <simvis/philox.h>

namespace simvis {

/// Up to this mean poisson() is exact.
inline constexpr double kMaxExactMean = 64;

/// A whole number from Poisson's distribution of this mean (0 to 1e15), named as SensorRandom's numbers are. Up to
/// kMaxExactMean its distribution function is inverted, exact to the 2^-53 of uniform(). Beyond, a Gaussian of the
/// same mean, variance and skewness is rounded: mean + sqrt(mean) z + (z^2 - 1) / 6 (E. A. Cornish and R. A. Fisher,
/// Revue de l'Institut International de Statistique 5, 1938), whose distribution function is off by less than 0.1 /
/// mean.
double poisson(const SensorRandom& random, double mean, std::uint64_t frame, std::uint32_t element, std::uint32_t draw);

}  // namespace simvis
