// The noise model: white noise and drift by chi-square and Allan variance, with fixed seeds; the same bytes in any
// order.
#include "sensors/noise_model.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

constexpr std::int64_t kNoisePeriod_ns = 10'000'000;  // 100 Hz
constexpr double kNoisePeriod_s = 0.01;

// The relative standard deviation of an estimated variance of n independent normal values is sqrt(2 / n) (chi-square).
// Five of them are exceeded once in a million seeds; the seeds here are fixed.
double variance_tolerance(double n) { return 5 * std::sqrt(2 / n); }

NoiseModel model_of(const NoiseDesc& desc, std::uint64_t seed = 7) { return {desc, SensorRandom(seed, "IMU/gyro")}; }

FrameTime noise_frame(std::uint64_t index) {
  return {index, static_cast<std::int64_t>(index) * kNoisePeriod_ns, kNoisePeriod_ns};
}

double mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return sum / static_cast<double>(values.size());
}

TEST_CASE("white noise has the variance of its density and of its standard deviation") {
  constexpr int kSamples = 20000;
  const NoiseModel model = model_of({.stddev = 0.3, .noise_density = 0.02});
  const double expected = 0.3 * 0.3 + 0.02 * 0.02 / kNoisePeriod_s;
  std::vector<double> errors, products;
  for (int i = 0; i < kSamples; ++i) {
    errors.push_back(model.apply(5, 0, noise_frame(static_cast<std::uint64_t>(i)), kNoisePeriod_s) - 5);
    if (i > 0) products.push_back(errors[errors.size() - 2] * errors.back());
  }
  CHECK(std::abs(mean_square(errors) / expected - 1) <= variance_tolerance(kSamples));
  double correlation = 0;
  for (const double product : products) correlation += product / expected / kSamples;
  CHECK(std::abs(correlation) <= 5 / std::sqrt(kSamples));
  CHECK(model.desc().white_variance(kNoisePeriod_s) == doctest::Approx(expected).epsilon(1e-12));
}

// The Allan variance of white noise of density N is N^2 / tau, that of a random walk of density K is K^2 tau / 3
// (IEEE Std 952-1997, annex C). Means of clusters of n samples at 100 Hz; differences of 2,000 clusters, neighbours of
// which are correlated, count as 1,000 independent ones.
TEST_CASE("Allan variances of white noise and of a random walk follow their laws") {
  constexpr int kClusters = 2000;
  const auto allan_variance = [](const NoiseModel& model, int n) {
    double previous = 0, sum = 0;
    for (int cluster = 0; cluster <= kClusters; ++cluster) {
      double mean = 0;
      for (int i = 0; i < n; ++i) {
        const auto index =
            static_cast<std::uint64_t>(cluster) * static_cast<std::uint64_t>(n) + static_cast<std::uint64_t>(i) + 1;
        mean += model.apply(0, 1, noise_frame(index), kNoisePeriod_s) / n;
      }
      if (cluster > 0) sum += (mean - previous) * (mean - previous);
      previous = mean;
    }
    return sum / 2 / kClusters;
  };
  const NoiseModel white = model_of({.noise_density = 0.05}), walk = model_of({.random_walk = 0.4});
  for (const int n : {1, 8}) {
    const double tau = n * kNoisePeriod_s;
    CHECK(std::abs(allan_variance(white, n) / (0.05 * 0.05 / tau) - 1) <= variance_tolerance(kClusters / 2.0));
    // Means of n samples instead of integrals: the factor is (2 n^2 + 1) / (2 n^2).
    const double sampled = (2.0 * n * n + 1) / (2.0 * n * n);
    CHECK(std::abs(allan_variance(walk, n) / (0.4 * 0.4 * tau / 3 * sampled) - 1) <=
          variance_tolerance(kClusters / 2.0));
  }
}

TEST_CASE("a Gauss-Markov drift has its variance and its correlation in time, over many seeds") {
  constexpr int kSeeds = 3000;
  constexpr double kDrive = 0.2, kTau_s = 4;
  const auto variance = [](double t) { return kDrive * kDrive * kTau_s / 2 * (1 - std::exp(-2 * t / kTau_s)); };
  for (const double t : {0.5, 4.0, 1000.0}) {
    CAPTURE(t);
    std::vector<double> at_t;
    double covariance = 0;
    const double later = t + 3;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const NoiseModel model = model_of({.dynamic_bias_stddev = kDrive, .dynamic_bias_correlation_time_s = kTau_s},
                                        static_cast<std::uint64_t>(seed));
      at_t.push_back(model.drift(0, static_cast<std::int64_t>(t * 1e9)));
      covariance += at_t.back() * model.drift(0, static_cast<std::int64_t>(later * 1e9)) / kSeeds;
    }
    CHECK(std::abs(mean_square(at_t) / variance(t) - 1) <= variance_tolerance(kSeeds));
    // The mean of products of two normal values of variances a and b and covariance c has the variance (a b + c^2) / n.
    const double expected = variance(t) * std::exp(-3 / kTau_s);
    const double deviation = std::sqrt((variance(t) * variance(later) + expected * expected) / kSeeds);
    CHECK(std::abs(covariance - expected) <= 5 * deviation);
  }
}

TEST_CASE("drift is a function of time alone, continuous, and different for each axis and quantity") {
  const NoiseModel model = model_of({.random_walk = 0.5});
  CHECK(model.drift(0, 0) == 0);
  std::vector<double> forward, backward;
  for (int i = 0; i < 100; ++i) forward.push_back(model.drift(0, i * kNoisePeriod_ns));
  for (int i = 99; i >= 0; --i) backward.push_back(model.drift(0, i * kNoisePeriod_ns));
  for (std::size_t i = 0; i < forward.size(); ++i) CHECK(forward[i] == backward[99 - i]);
  CHECK(model.drift(0, 500'000'000) != model.drift(1, 500'000'000));
  CHECK(model.drift(0, 500'000'000) != model_of({.random_walk = 0.5}, 8).drift(0, 500'000'000));
  // A nanosecond changes a random walk by 0.5 sqrt(1e-9 s) times a normal value of at most 8.6; rounding adds up to 63
  // times 2^-53 of the drift after 292 years.
  const double rounding = 63 * 0x1p-53 * 0.5 * std::sqrt(9.3e9) * 8.6;
  const double step = std::abs(model.drift(0, 500'000'001) - model.drift(0, 500'000'000));
  CHECK(step <= 0.5 * std::sqrt(1e-9) * 8.6 + rounding);
  CHECK(step > 0);
  CHECK(std::isfinite(model.drift(0, std::numeric_limits<std::int64_t>::max())));
}

TEST_CASE("turn-on bias is drawn once, and values are rounded last") {
  const NoiseModel bias = model_of({.bias_mean = 2, .bias_stddev = 0.5});
  const double first = bias.apply(1, 0, noise_frame(0), 1);
  CHECK(first != 3);
  CHECK(std::abs(first - 3) <= 0.5 * 8.6);
  CHECK(bias.apply(1, 0, noise_frame(77), 1) == first);
  CHECK(bias.apply(1, 1, noise_frame(0), 1) != first);
  const NoiseModel steps = model_of({.stddev = 0.3, .precision = 0.25});
  std::set<double> seen;
  for (std::uint64_t i = 0; i < 50; ++i) seen.insert(steps.apply(1.1, 0, noise_frame(i), 1));
  CHECK(seen.size() > 2);
  for (const double value : seen) CHECK(value * 4 == std::round(value * 4));
  CHECK(model_of({}).apply(0.1, 0, noise_frame(3), 1) == 0.1);
}

TEST_CASE("half of a Gauss-Markov drift is refused") {
  const auto refused = [](const std::string& attributes) {
    return error_of(
        [&] { Simulation::from_string("<sensor type=\"imu\" name=\"I\" insert_at=\"ROOT\" " + attributes + "/>"); });
  };
  CHECK(refused("gyroscope_dynamic_bias_stddev=\"1\"") ==
        "<string>:1:46: error: attribute \"gyroscope_dynamic_bias_stddev\" is not allowed without "
        "\"gyroscope_dynamic_bias_correlation_time\", expected both above 0 or none");
  CHECK(refused("accelerometer_noise_density=\"-1\"").find("accelerometer_noise_density") != std::string::npos);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
