// The fits of a fidelity report against closed forms.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "exchange/fidelity/least_squares.h"
#include "exchange/fidelity/light_fit.h"

TEST_SUITE_BEGIN("fidelity");

namespace simvis {

TEST_CASE("a mean of rows has the standard deviation of its clusters, whatever is within them") {
  // 100 clusters of four equal numbers: the mean is known as well as that of 100 numbers, not of 400.
  std::mt19937 random(2);
  std::normal_distribution<double> normal(3, 0.5);
  std::vector<double> values;
  for (int cluster = 0; cluster < 100; ++cluster) values.push_back(normal(random));
  double mean = 0, squares = 0;
  for (const double value : values) mean += value / 100;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double prior[] = {1e6};
  const LeastSquaresFit fit = least_squares(400, prior, [&](std::size_t i) {
    LeastSquaresRow row{.cluster = i / 4, .value = values[i / 4], .weight = 7};
    row.add(0, 1);
    return row;
  });
  // Rounding of sums of 400 numbers, and the prior, which moves the mean by 3 / (400 * 7 * 10^12).
  constexpr double kRounding = 1e-12;
  CHECK(std::abs(fit.value[0] - mean) < kRounding);
  // Each cluster against the mean of the others, which is farther off by 100 / 99.
  const double expected = std::sqrt(squares) / 100 * (100.0 / 99);
  CHECK(std::abs(fit.deviation[0] - expected) < kRounding);
  CHECK(fit.determined[0]);
}

TEST_CASE("a straight line is fitted exactly, and an unknown without rows is not determined") {
  const double prior[] = {10, 10, 10};
  const LeastSquaresFit fit = least_squares(50, prior, [](std::size_t i) {
    const double x = static_cast<double>(i);
    LeastSquaresRow row{.cluster = i, .value = 2 - 0.25 * x, .weight = 1e6};
    row.add(0, 1);
    row.add(1, x);
    return row;
  });
  constexpr double kPrior = 1e-8;  // the prior's share: 2 / (10^2 * 10^6 * 50), and more for a line
  CHECK(std::abs(fit.value[0] - 2) < kPrior);
  CHECK(std::abs(fit.value[1] + 0.25) < kPrior);
  CHECK(fit.value[2] == 0);
  CHECK(fit.determined[0]);
  CHECK(fit.determined[1]);
  CHECK_FALSE(fit.determined[2]);
}

TEST_CASE("the interval of a share is that of Wilson") {
  // 10 of 100: R. G. Newcombe, Statistics in Medicine 17, 1998, gives the formula; worked out with 1.959964.
  const FittedNumber tenth = wilson_interval(10, 100);
  constexpr double kDigits = 1e-6;
  CHECK(std::abs(tenth.value - 0.1) < kDigits);
  CHECK(std::abs(tenth.low - 0.0552291) < kDigits);
  CHECK(std::abs(tenth.high - 0.1743657) < kDigits);
  CHECK(wilson_interval(0, 50).low == 0);
  CHECK(wilson_interval(0, 50).high > 0.05);
  CHECK(wilson_interval(50, 50).high == 1);
  CHECK_FALSE(wilson_interval(0, 0).determined);
}

TEST_CASE("a threshold and its noise are found from lost beams, and are not determined where no beam is weak") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  constexpr double kChance = 0.03, kPower = 0.01, kNoise = 0.2;
  for (const double weakest : {0.004, 0.03}) {
    CAPTURE(weakest);
    // There is no scene: each beam has its power by its own range.
    BeamRecording recording{.source = "test"};
    for (int i = 0; i < 40'000; ++i) {
      const double power = weakest * std::pow(10, uniform(random));
      const double kept = std::erfc(-(power / kPower - 1) / kNoise / std::sqrt(2.0)) / 2;
      RecordedBeam beam{.azimuth_rad = std::sqrt(1 / power)};
      if (uniform(random) < (1 - kChance) * kept) beam.range_m = beam.azimuth_rad;
      recording.beams.push_back(beam);
    }
    const auto scene_beam = [&](std::size_t i) {
      return SceneBeam{
          .range_m = recording.beams[i].azimuth_rad, .cosine = 1, .reflectance = 1, .use = BeamUse::fitted};
    };
    const LossFit fit = fit_losses(recording, scene_beam, {}, std::vector<bool>(recording.beams.size(), true));
    REQUIRE(fit.chance.determined);
    CHECK(fit.power.determined == (weakest < kPower));
    // Three times the half width of the interval: none of these numbers is that far off but once in 10^8 times.
    const auto within = [](const FittedNumber& number, double truth) {
      return std::abs(number.value - truth) <= 3 * std::max(number.high - number.value, number.value - number.low);
    };
    CHECK(within(fit.chance, kChance));
    CHECK(fit.chance.high - fit.chance.low < 0.01);
    if (!fit.power.determined) continue;
    CHECK(within(fit.power, kPower));
    CHECK(within(fit.noise, kNoise));
    CHECK(fit.power.high - fit.power.low < 0.05 * kPower);
    CHECK(fit.noise.high - fit.noise.low < 0.2 * kNoise);
  }
}

}  // namespace simvis

TEST_SUITE_END();
