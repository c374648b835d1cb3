#include "effects/scanner/air_echo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace simvis {
namespace {

struct RuleNode {
  double at, weight;
};
// Gauss and Legendre's rule with 16 points on [-1, 1], for both signs.
constexpr RuleNode kRule[] = {
    {0.095012509837637441, 0.18945061045506847}, {0.28160355077925892, 0.18260341504492361},
    {0.45801677765722737, 0.16915651939500256},  {0.61787624440264377, 0.14959598881657682},
    {0.755404408355003, 0.12462897125553395},    {0.86563120238783176, 0.095158511682492897},
    {0.9445750230732326, 0.062253523938647776},  {0.98940093499164994, 0.027152459411754058},
};

// Light from the range r, without the factor pi backscatter.
double returned(const Medium& medium, double r) {
  const double overlap = std::clamp((r - kAirFrom_m) / (kAirWhole_m - kAirFrom_m), 0.0, 1.0);
  return overlap * std::exp(-2 * medium.laser_extinction_per_m * r) / (r * r);
}

// The integral of weight(x) returned(R + x) over the pulse around R.
template <typename Weight>
double over_pulse(const Medium& medium, double end_m, double range_m, const Weight& weight) {
  const double first = std::max(kAirFrom_m, range_m - kPulse_m), last = std::min(end_m, range_m + kPulse_m);
  const double between = std::clamp(kAirWhole_m, first, std::max(first, last));
  double sum = 0;
  for (const auto& [from, to] : {std::pair(first, between), std::pair(between, last)}) {
    if (!(from < to)) continue;
    const double middle = (from + to) / 2, half = (to - from) / 2;
    for (const RuleNode& node : kRule) {
      for (const double r : {middle - half * node.at, middle + half * node.at}) {
        sum += half * node.weight * weight(r - range_m) * returned(medium, r);
      }
    }
  }
  return sum;
}

constexpr double kWave = std::numbers::pi / (2 * kPulse_m);

}  // namespace

double air_power(const Medium& medium, double end_m, double range_m) {
  const auto pulse = [](double x) { return std::cos(kWave * x) * std::cos(kWave * x); };
  return std::numbers::pi * medium.backscatter_per_m_sr * over_pulse(medium, end_m, range_m, pulse);
}

// The derivative of P falls from above 0, where all light comes from beyond R, to below 0, where the stronger part
// comes from before it. Its zero is found by halving and by the secant in turns. P is flat there: an error of 1e-9 m
// changes it by less than 1e-17 of itself.
AirEcho air_echo(const Medium& medium, double end_m) {
  if (!(end_m > kAirFrom_m) || medium.backscatter_per_m_sr == 0) return {};
  constexpr double kPlace_m = 1e-9;
  const auto slope = [&](double range_m) {
    return over_pulse(medium, end_m, range_m, [](double x) { return std::sin(2 * kWave * x); });
  };
  double low = kAirFrom_m - kPulse_m, high = std::min(end_m, kAirWhole_m) + kPulse_m;
  double at_low = 1, at_high = -1;
  for (bool halve = true; high - low > kPlace_m; halve = !halve) {
    const double secant = low + (high - low) * at_low / (at_low - at_high);
    const double margin = kPlace_m / 4;
    const double middle = halve ? (low + high) / 2 : std::clamp(secant, low + margin, high - margin);
    const double value = slope(middle);
    (value > 0 ? low : high) = middle;
    (value > 0 ? at_low : at_high) = value;
  }
  const double range_m = (low + high) / 2;
  return {range_m, air_power(medium, end_m, range_m)};
}

}  // namespace simvis
