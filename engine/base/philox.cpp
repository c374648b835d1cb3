#include <simvis/philox.h>

#include <cmath>
#include <numbers>

#include "engine/base/fnv1a.h"

namespace simvis {

namespace {

std::array<std::uint32_t, 2> halves(std::uint64_t value) {
  return {static_cast<std::uint32_t>(value), static_cast<std::uint32_t>(value >> 32)};
}

/// A number in [0, 1), a multiple of 2^-53, from the upper 27 bits of `upper` and the upper 26 bits of `lower`.
double unit_interval(std::uint32_t upper, std::uint32_t lower) {
  return (static_cast<double>(upper >> 5) * 0x1p26 + static_cast<double>(lower >> 6)) * 0x1p-53;
}

}  // namespace

std::array<std::uint32_t, 4> philox4x32_10(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t kMultiplier0 = 0xD2511F53u, kMultiplier1 = 0xCD9E8D57u;
  constexpr std::uint32_t kWeyl0 = 0x9E3779B9u, kWeyl1 = 0xBB67AE85u;
  for (int round = 0; round < 10; ++round) {
    const auto [low0, high0] = halves(kMultiplier0 * counter[0]);
    const auto [low1, high1] = halves(kMultiplier1 * counter[2]);
    counter = {high1 ^ counter[1] ^ key[0], low1, high0 ^ counter[3] ^ key[1], low0};
    key = {key[0] + kWeyl0, key[1] + kWeyl1};
  }
  return counter;
}

SensorRandom::SensorRandom(std::uint64_t seed, std::string_view sensor) : key_(halves(seed ^ fnv1a(sensor))) {}

std::array<std::uint32_t, 4> SensorRandom::bits(std::uint64_t frame, std::uint32_t element, std::uint32_t draw) const {
  const auto [frame_low, frame_high] = halves(frame);
  return philox4x32_10({frame_low, frame_high, element, draw}, key_);
}

double SensorRandom::uniform(std::uint64_t frame, std::uint32_t element, std::uint32_t draw) const {
  const std::array<std::uint32_t, 4> bits = this->bits(frame, element, draw);
  return unit_interval(bits[0], bits[1]);
}

std::array<double, 4> SensorRandom::uniforms(std::uint64_t frame, std::uint32_t element, std::uint32_t draw) const {
  const std::array<std::uint32_t, 4> bits = this->bits(frame, element, draw);
  return {bits[0] * 0x1p-32, bits[1] * 0x1p-32, bits[2] * 0x1p-32, bits[3] * 0x1p-32};
}

double SensorRandom::gaussian(std::uint64_t frame, std::uint32_t element, std::uint32_t draw) const {
  const std::array<std::uint32_t, 4> bits = this->bits(frame, element, draw);
  // Box-Muller transform; 1 - u lies in (0, 1].
  const double radius = std::sqrt(-2 * std::log(1 - unit_interval(bits[0], bits[1])));
  return radius * std::cos(2 * std::numbers::pi * unit_interval(bits[2], bits[3]));
}

}  // namespace simvis
