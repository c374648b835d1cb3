// Which rates of frames keep which rates of sensors, exactly as the rates are written.
#pragma once

#include <optional>
#include <span>

namespace simvis {

/// Whether `rate_hz` is a whole multiple of `of_hz`. Both are finite and above 0.
bool is_multiple(double rate_hz, double of_hz);

/// The smallest rate that is a whole multiple of each of `rates_hz`, which are finite and above 0. Empty if there are
/// none, or if it is above kMaxUsefulRateHz.
std::optional<double> common_multiple(std::span<const double> rates_hz);

/// Frames that come more often are better taken when a sensor is due.
inline constexpr double kMaxUsefulRateHz = 1000;

}  // namespace simvis
