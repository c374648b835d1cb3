// The radiance of black bodies from 8 to 14 um by Simpson's rule over the wavelength, for tests.
#pragma once

#include <cmath>

namespace simvis::test {

/// Relative error of the integrals from 100 to 3000 K. Simpson's rule with steps h errs by h^4 / 180 f''''; where f
/// changes fastest, exp(-c / (lambda T)) at 8 um and 100 K, that is (h 14388 um K / (64 um^2 100 K))^4 / 180 = 8e-13.
/// The sum of 4001 terms rounds by less than 4001 x 2^-53 = 5e-13. What is compared with it may err by 5e-13 too.
inline constexpr double kPlanckError = 2e-12;

/// The integral of B(lambda, T), or with `slope` of dB/dT; W / (m^2 sr), or W / (m^2 sr K).
inline double planck_integral(double temperature_k, bool slope = false) {
  constexpr double kPlanck = 6.62607015e-34, kLight = 299792458, kBoltzmann = 1.380649e-23;
  constexpr int kSteps = 4000;
  const double first = 8e-6, h = (14e-6 - first) / kSteps;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double wavelength = first + i * h, x = kPlanck * kLight / (wavelength * kBoltzmann * temperature_k);
    const double radiance = 2 * kPlanck * kLight * kLight / std::pow(wavelength, 5) / std::expm1(x);
    const double value = slope ? radiance * x / temperature_k / -std::expm1(-x) : radiance;
    sum += value * (i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2);
  }
  return sum * h / 3;
}

}  // namespace simvis::test
