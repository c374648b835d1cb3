#include "simvis/time/clock.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include <simvis/error.h>
#include "engine/base/assert.h"

namespace simvis {

namespace {

__extension__ using Uint128 = unsigned __int128;

constexpr std::uint64_t kNsPerSecond = 1'000'000'000;

// Below this rate, only the first firing is within the clock's range of 292 years.
constexpr double kMinSensorRateHz = 1e-12;

Uint128 power_of_ten(int exponent) {
  Uint128 power = 1;
  for (int i = 0; i < exponent; ++i) power *= 10;
  return power;
}

std::string number_text(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// round(index * 10^9 / rate), or nothing if it exceeds 64 bits. The rate is at most kMaxRateHz.
std::optional<std::int64_t> time_of(std::uint64_t index, double rate_hz, const DecimalRate& rate) {
  // The limit is so far below 2^63 that the rounding of the quotient cannot hide an overflow. It also limits the
  // numerator: that is the time multiplied by the digits, below 2^63 * 10^17 < 2^120.
  if (static_cast<double>(index) * 1e9 / rate_hz > 9.2e18) return std::nullopt;
  const Uint128 numerator = static_cast<Uint128>(index) * kNsPerSecond * power_of_ten(-rate.exponent);
  const Uint128 denominator = rate.digits * power_of_ten(rate.exponent);
  return static_cast<std::int64_t>((2 * numerator + denominator) / (2 * denominator));
}

/// The number of firing times round(j * 10^9 / rate), j >= 0, that are at most `time_ns`. The rate lies between
/// kMinSensorRateHz and Clock::kMaxRateHz, so the exponent is at least -28 and both sides stay below 2^128.
std::uint64_t firings_until(std::int64_t time_ns, const DecimalRate& rate) {
  // round(x) <= t is equivalent to x < t + 1/2, so every j below (2 t + 1) * rate / (2 * 10^9) counts.
  const Uint128 numerator = (2 * static_cast<Uint128>(time_ns) + 1) * rate.digits * power_of_ten(rate.exponent);
  const Uint128 denominator = 2 * kNsPerSecond * power_of_ten(-rate.exponent);
  return static_cast<std::uint64_t>((numerator + denominator - 1) / denominator);
}

}  // namespace

DecimalRate decimal_rate(double rate_hz) {
  SIMVIS_ASSERT(std::isfinite(rate_hz) && rate_hz > 0);
  char text[32];  // D.DDDe-XX
  const char* const end = std::to_chars(text, text + sizeof text, rate_hz, std::chars_format::scientific).ptr;
  DecimalRate rate;
  const char* c = text;
  for (bool fraction = false; *c != 'e'; ++c) {
    if (*c == '.') {
      fraction = true;
      continue;
    }
    rate.digits = 10 * rate.digits + static_cast<std::uint64_t>(*c - '0');
    if (fraction) --rate.exponent;
  }
  ++c;
  if (*c == '+') ++c;
  int exponent = 0;
  std::from_chars(c, end, exponent);
  rate.exponent += exponent;
  return rate;
}

Clock::Clock(double rate_hz) : rate_hz_(rate_hz) {
  if (!std::isfinite(rate_hz) || rate_hz <= 0 || rate_hz > kMaxRateHz) {
    throw InputError("a rate of " + number_text(rate_hz) +
                     " frames per second is not possible, expected more than 0 and at most 1e9");
  }
  rate_ = decimal_rate(rate_hz);
  const std::optional<std::int64_t> period = time_of(1, rate_hz_, rate_);
  if (!period) {
    throw InputError("a rate of " + number_text(rate_hz) +
                     " frames per second is too low: one frame would last longer than the clock's 292 years");
  }
  period_ns_ = *period;
}

FrameTime Clock::frame(std::uint64_t index) const {
  const std::optional<std::int64_t> time = time_of(index, rate_hz_, rate_);
  if (!time) {
    throw InputError("frame " + std::to_string(index) + " at " + number_text(rate_hz_) +
                     " frames per second lies beyond the clock's 292 years");
  }
  return {.index = index, .time_ns = *time, .period_ns = period_ns_};
}

bool fires_between(double sensor_rate_hz, std::int64_t before_ns, std::int64_t now_ns) {
  if (sensor_rate_hz == 0) return true;
  if (sensor_rate_hz >= Clock::kMaxRateHz) return now_ns > before_ns;  // every nanosecond has a firing
  if (sensor_rate_hz < kMinSensorRateHz) return false;
  const DecimalRate rate = decimal_rate(sensor_rate_hz);
  return firings_until(now_ns, rate) > firings_until(before_ns, rate);
}

std::optional<std::int64_t> next_firing(double sensor_rate_hz, std::int64_t after_ns) {
  if (sensor_rate_hz >= Clock::kMaxRateHz) return after_ns + 1;
  if (sensor_rate_hz < kMinSensorRateHz) return std::nullopt;
  const DecimalRate rate = decimal_rate(sensor_rate_hz);
  return time_of(firings_until(after_ns, rate), sensor_rate_hz, rate);
}

}  // namespace simvis
