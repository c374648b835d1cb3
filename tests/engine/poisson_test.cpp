// Whether counts follow Poisson's distribution.
#include "engine/base/poisson.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

constexpr std::uint32_t kCounts = 1'000'000;
// Tolerance of a statistic, in its own standard deviations; the seed is fixed.
constexpr double kCountSigmas = 5;

std::vector<double> counts(double mean) {
  const SensorRandom random(7, "P");
  std::vector<double> values;
  for (std::uint32_t i = 0; i < kCounts; ++i) values.push_back(poisson(random, mean, i / 1000, i % 1000, 0));
  return values;
}

struct Moments {
  double mean = 0, variance = 0, skewness = 0;
};

Moments moments(const std::vector<double>& values) {
  Moments m;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) m.mean += v / n;
  for (const double v : values) m.variance += (v - m.mean) * (v - m.mean) / n;
  for (const double v : values) m.skewness += std::pow((v - m.mean) / std::sqrt(m.variance), 3) / n;
  return m;
}

// Chi-square of the counts against Poisson's probabilities, over the counts with at least ten expected ones, and the
// number of those minus one.
struct ChiSquare {
  double value = 0, freedom = 0;
};

ChiSquare chi_square(const std::vector<double>& values, double mean) {
  std::vector<double> seen(static_cast<std::size_t>(mean + 12 * std::sqrt(mean) + 20));
  for (const double v : values) ++seen.at(static_cast<std::size_t>(v));
  ChiSquare chi{0, -1};
  double rest_seen = kCounts, rest_expected = kCounts;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const auto n = static_cast<double>(k);
    const double expected = kCounts * std::exp(n * std::log(mean) - mean - std::lgamma(n + 1));
    if (expected < 10) continue;
    chi.value += (seen[k] - expected) * (seen[k] - expected) / expected;
    chi.freedom += 1;
    rest_seen -= seen[k];
    rest_expected -= expected;
  }
  if (rest_expected < 1) return chi;
  chi.value += (rest_seen - rest_expected) * (rest_seen - rest_expected) / rest_expected;
  chi.freedom += 1;
  return chi;
}

}  // namespace

TEST_CASE("small means are exact: chi-square over a million counts") {
  for (const double mean : {0.3, 4.0, 30.0, kMaxExactMean}) {
    CAPTURE(mean);
    const ChiSquare chi = chi_square(counts(mean), mean);
    // Chi-square of n degrees of freedom has the mean n and the variance 2 n.
    CHECK(std::abs(chi.value - chi.freedom) <= kCountSigmas * std::sqrt(2 * chi.freedom));
  }
}

TEST_CASE("mean, variance and skewness are Poisson's, small and large") {
  for (const double mean : {0.3, 4.0, 64.0, 65.0, 300.0, 10'000.0}) {
    CAPTURE(mean);
    const Moments m = moments(counts(mean));
    // Standard errors of n samples: of the mean sqrt(s / n), of the variance sqrt((m4 - s^2) / n) with Poisson's fourth
    // moment m4 = 3 s^2 + s; of the skewness, for distributions near a Gaussian, sqrt(6 / n). Rounding adds 1 / 12 of
    // variance beyond the exact means, and the term (z^2 - 1) / 6 adds 2 / 36.
    const double n = kCounts, added = mean > kMaxExactMean ? 1.0 / 12 + 2.0 / 36 : 0;
    CHECK(std::abs(m.mean - mean) <= kCountSigmas * std::sqrt(mean / n));
    CHECK(std::abs(m.variance - mean - added) <= kCountSigmas * std::sqrt((2 * mean * mean + mean) / n));
    // A small mean's skewness is far from a Gaussian's, and so is its error.
    if (mean >= 30) CHECK(std::abs(m.skewness - 1 / std::sqrt(mean)) <= kCountSigmas * std::sqrt(6 / n) + added / mean);
  }
}

TEST_CASE("beyond the exact means the error of the distribution function is below 0.1 / mean") {
  const double mean = kMaxExactMean + 1;
  std::vector<double> seen(300);
  for (const double v : counts(mean)) ++seen.at(static_cast<std::size_t>(v));
  double have = 0, expected = 0, worst = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const auto n = static_cast<double>(k);
    have += seen[k] / kCounts;
    expected += std::exp(n * std::log(mean) - mean - std::lgamma(n + 1));
    worst = std::max(worst, std::abs(have - expected));
  }
  // The next terms of the same expansion, (z - z^3) / (72 mean), and those of rounding, z / (24 mean), times the
  // Gaussian density: below 0.02 / mean. The remainder is of the order of 1 / mean^1.5. The empirical function itself
  // has a standard deviation of at most 0.5 / sqrt(n).
  CHECK(worst <= 0.1 / mean + kCountSigmas * 0.5 / std::sqrt(kCounts));
  MESSAGE("distribution function off by " << worst);
}

TEST_CASE("a mean of zero or less gives no electron") {
  const SensorRandom random(7, "P");
  CHECK(poisson(random, 0, 1, 2, 3) == 0);
  CHECK(poisson(random, -1, 1, 2, 3) == 0);
  CHECK(poisson(random, 5, 1, 2, 3) == poisson(random, 5, 1, 2, 3));
}

TEST_SUITE_END();
