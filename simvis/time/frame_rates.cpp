#include "simvis/time/frame_rates.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "simvis/time/clock.h"

namespace simvis {

bool is_multiple(double rate_hz, double of_hz) {
  __extension__ using Wide = unsigned __int128;
  const DecimalRate rate = decimal_rate(rate_hz), of = decimal_rate(of_hz);
  // rate = a 10^p, of = b 10^q. If p >= q: b must divide a 10^(p - q); otherwise b 10^(q - p) must divide a.
  Wide remainder = rate.digits % of.digits, divisor = of.digits;
  for (int exponent = of.exponent; exponent < rate.exponent; ++exponent) remainder = remainder * 10 % divisor;
  for (int exponent = rate.exponent; exponent < of.exponent && divisor <= rate.digits; ++exponent) divisor *= 10;
  if (rate.exponent < of.exponent) remainder = rate.digits % divisor;
  return remainder == 0;
}

std::optional<double> common_multiple(std::span<const double> rates_hz) {
  // Rates are counted in units of 1e-6 Hz; others have no useful multiple.
  constexpr double kUnits = 1e6;
  std::uint64_t multiple = 1;
  for (const double rate : rates_hz) {
    const double units = std::round(rate * kUnits);
    if (rate > kMaxUsefulRateHz || !is_multiple(rate, 1 / kUnits)) return std::nullopt;
    multiple = std::lcm(multiple, static_cast<std::uint64_t>(units));
    if (static_cast<double>(multiple) > kMaxUsefulRateHz * kUnits) return std::nullopt;
  }
  if (rates_hz.empty()) return std::nullopt;
  return static_cast<double>(multiple) / kUnits;
}

}  // namespace simvis
