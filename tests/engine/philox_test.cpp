// Random numbers: the published vectors, their dependencies, and their normal distribution.
#include <simvis/philox.h>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

using Block = std::array<std::uint32_t, 4>;

// Tolerance of a statistic, in its own standard deviations: 6e-7 of all seeds would fail, and the seed is fixed.
constexpr double kSigmas = 5;
constexpr std::size_t kSamples = 1'000'000;

std::vector<double> samples() {
  const SensorRandom random(42, "SCANNER");
  std::vector<double> values;
  for (std::uint32_t i = 0; i < kSamples; ++i) values.push_back(random.gaussian(i / 1000, i % 1000, 0));
  return values;
}

}  // namespace

TEST_CASE("Philox 4x32-10 gives the known answers of Random123") {
  CHECK(philox4x32_10({0, 0, 0, 0}, {0, 0}) == Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  CHECK(philox4x32_10({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}) ==
        Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  CHECK(philox4x32_10({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
        Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("key and counter are those of the header") {
  // The 64-bit FNV-1a hash of "a" is 0xaf63dc4c8601ec8c.
  const std::uint64_t seed = 0x0123456789abcdef, frame = 0x1122334455667788;
  const std::uint64_t key = 0xaf63dc4c8601ec8c ^ seed;
  const Block bits = philox4x32_10({0x55667788, 0x11223344, 7, 3},
                                   {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)});
  const auto unit = [](std::uint32_t upper, std::uint32_t lower) {
    const std::uint64_t joined = std::uint64_t{upper} << 32 | lower;
    // The well-known recipe of the Mersenne twister drops 6 bits of the lower word and 5 of the upper one.
    return static_cast<double>(((joined >> 37) << 26 | (joined & 0xffffffff) >> 6)) / 0x1p53;
  };
  const double expected =
      std::sqrt(-2 * std::log(1 - unit(bits[0], bits[1]))) * std::cos(2 * std::numbers::pi * unit(bits[2], bits[3]));
  CHECK(SensorRandom(seed, "a").gaussian(frame, 7, 3) == expected);
}

TEST_CASE("four numbers of a draw are the words of its block") {
  const std::uint64_t key = 0xaf63dc4c8601ec8c;
  const Block bits =
      philox4x32_10({5, 0, 7, 3}, {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)});
  const std::array<double, 4> numbers = SensorRandom(0, "a").uniforms(5, 7, 3);
  for (std::size_t i = 0; i < 4; ++i) CHECK(numbers[i] * 0x1p32 == bits[i]);
}

TEST_CASE("a number depends on its names only") {
  const SensorRandom random(1, "A");
  const double value = random.gaussian(5, 6, 7);
  CHECK(SensorRandom(1, "A").gaussian(5, 6, 7) == value);
  CHECK(random.gaussian(5, 6, 7) == value);
  CHECK(random.gaussian(6, 6, 7) != value);
  CHECK(random.gaussian(5 + (std::uint64_t{1} << 32), 6, 7) != value);
  CHECK(random.gaussian(5, 7, 7) != value);
  CHECK(random.gaussian(5, 6, 8) != value);
  CHECK(SensorRandom(2, "A").gaussian(5, 6, 7) != value);
  CHECK(SensorRandom(1 + (std::uint64_t{1} << 32), "A").gaussian(5, 6, 7) != value);
  CHECK(SensorRandom(1, "B").gaussian(5, 6, 7) != value);
}

TEST_CASE("moments of a million numbers are those of the normal distribution") {
  double moment[5] = {}, neighbours = 0, before = 0, largest = 0;
  for (const double x : samples()) {
    for (int k = 1; k <= 4; ++k) moment[k] += std::pow(x, k) / kSamples;
    neighbours += x * before / kSamples;
    before = x;
    largest = std::max(largest, std::abs(x));
  }
  // The variance of the mean of x^k is (E x^2k - (E x^k)^2) / n, with E x^2 = 1, E x^4 = 3, E x^6 = 15, E x^8 = 105.
  const double n = kSamples;
  CHECK(std::abs(moment[1]) <= kSigmas * std::sqrt(1 / n));
  CHECK(std::abs(moment[2] - 1) <= kSigmas * std::sqrt(2 / n));
  CHECK(std::abs(moment[3]) <= kSigmas * std::sqrt(15 / n));
  CHECK(std::abs(moment[4] - 3) <= kSigmas * std::sqrt(96 / n));
  // Products of independent neighbours have variance 1.
  CHECK(std::abs(neighbours) <= kSigmas * std::sqrt(1 / n));
  CHECK(largest <= 8.6);
  CHECK(largest >= 4);  // P(|x| > 4) = 6.3e-5: 63 are expected, none in e^-63 of all cases
}

TEST_CASE("a million numbers fill equally probable bins equally (chi-square)") {
  constexpr std::size_t kBins = 100;
  std::vector<double> count(kBins);
  for (const double x : samples()) {
    const double probability = std::erfc(-x / std::numbers::sqrt2) / 2;
    ++count[std::min(static_cast<std::size_t>(probability * kBins), kBins - 1)];
  }
  const double expected = static_cast<double>(kSamples) / kBins;
  double chi_square = 0;
  for (const double c : count) chi_square += (c - expected) * (c - expected) / expected;
  // Mean kBins - 1, variance 2 (kBins - 1). Bins that are filled too evenly are also wrong.
  CHECK(std::abs(chi_square - (kBins - 1)) <= kSigmas * std::sqrt(2.0 * (kBins - 1)));
}

TEST_SUITE_END();
