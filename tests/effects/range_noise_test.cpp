// Noise and rounding of ranges: the distribution of the noise, its dependencies, the readings that it leaves unchanged,
// and steps.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <random>

#include <simvis/simulation.h>
#include "tests/support/infinity.h"
#include "tests/support/made_up_scan.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

// For a range of 1 m: far above the float32 grid there (1.2e-7 m), and far too small to reach 0.
constexpr double kNoise_m = 0.02;

// The noise that is added, in standard deviations.
std::vector<double> deviations(const std::string& attributes, float range_m, double sigma_m, std::uint64_t frame = 0) {
  const Scan scan = finished(effects_of(attributes), even_scan(range_m), frame);
  std::vector<double> z;
  for (const float reading_m : scan.range_m) z.push_back((static_cast<double>(reading_m) - range_m) / sigma_m);
  return z;
}

double mean_product(const std::vector<double>& a, const std::vector<double>& b, std::size_t shift) {
  double sum = 0;
  for (std::size_t i = 0; i + shift < a.size(); ++i) sum += a[i] * b[i + shift];
  return sum / static_cast<double>(a.size() - shift);
}

}  // namespace

TEST_CASE("the noise has mean 0 and the variance of both of its parts together") {
  struct Case {
    const char* attributes;
    double noise_m, noise_rel;
    float range_m;
  };
  for (const Case& c : {Case{R"(range_noise="0.02")", 0.02, 0, 1}, Case{R"(range_noise="0.02")", 0.02, 0, 30},
                        Case{R"(range_noise_rel="0.01")", 0, 0.01, 4},
                        Case{R"(range_noise="0.03" range_noise_rel="0.002")", 0.03, 0.002, 20}}) {
    CAPTURE(c.attributes);
    CAPTURE(c.range_m);
    const double relative_m = c.noise_rel * static_cast<double>(c.range_m);
    const std::vector<double> z =
        deviations(c.attributes, c.range_m, std::sqrt(c.noise_m * c.noise_m + relative_m * relative_m));
    double mean = 0, square = 0;
    for (const double each : z) mean += each / kSamples;
    for (const double each : z) square += each * each / kSamples;
    CHECK(std::abs(mean) <= kSigmas / std::sqrt(kSamples));
    CHECK(std::abs(square - 1) <= kSigmas * std::sqrt(2.0 / kSamples));
  }
}

TEST_CASE("a bias is one number of each channel within its bound, uniformly distributed, and stays") {
  constexpr double kBias_m = 0.03, kBiasRel = 0.01, kRange_m = 4, kBound_m = kBias_m + kBiasRel * kRange_m;
  constexpr std::uint32_t kChannels = 4000, kBeams = 3;
  const std::string attributes = R"(range_bias="0.03" range_bias_rel="0.01")";
  Scan scan(kChannels, kBeams);
  std::ranges::fill(scan.edit_ranges().range_m, static_cast<float>(kRange_m));
  const Scan first = finished(effects_of(attributes), scan, 0), later = finished(effects_of(attributes), scan, 9);
  CHECK(first.range_m == later.range_m);
  double sum = 0, squares = 0;
  for (std::uint32_t channel = 0; channel < kChannels; ++channel) {
    const double share = (static_cast<double>(first.range_m[channel * kBeams]) - kRange_m) / kBound_m;
    CHECK(std::abs(share) <= 1 + 1e-5);  // of the bound, rounded to float32
    CHECK(first.range_m[channel * kBeams] == first.range_m[channel * kBeams + kBeams - 1]);
    sum += share;
    squares += share * share;
  }
  // A uniform number in [-1, 1] has the variance 1 / 3, and its square the variance 4 / 45.
  CHECK(std::abs(sum / kChannels) <= kSigmas * std::sqrt(1.0 / 3 / kChannels));
  CHECK(std::abs(squares / kChannels - 1.0 / 3) <= kSigmas * std::sqrt(4.0 / 45 / kChannels));
  CHECK_FALSE(finished(effects_of(R"(range_bias="0.03" range_noise="0.01")"), scan, 0).range_m == first.range_m);
}

TEST_CASE("the noise is Gaussian: chi-square over a hundred equally probable bins") {
  constexpr std::size_t kBins = 100;
  // Edges by bisection of the distribution, independent of a library's inverse.
  std::array<double, kBins - 1> edges{};
  for (std::size_t i = 0; i < edges.size(); ++i) {
    double low = -4, high = 4;
    while (high - low > 1e-6) {
      const double middle = (low + high) / 2;
      (normal_below(middle) < static_cast<double>(i + 1) / kBins ? low : high) = middle;
    }
    edges[i] = low;
  }
  std::array<double, kBins> counts{};
  for (const double z : deviations(R"(range_noise="0.02")", 1, kNoise_m)) {
    ++counts[static_cast<std::size_t>(std::ranges::upper_bound(edges, z) - edges.begin())];
  }
  constexpr double kExpected = static_cast<double>(kSamples) / kBins;
  double chi_square = 0;
  for (const double count : counts) chi_square += (count - kExpected) * (count - kExpected) / kExpected;
  // One correct generator in a million exceeds this: the cube root is normal (Wilson and Hilferty, PNAS 17, 1931).
  constexpr double kFreedom = kBins - 1;
  const double critical =
      kFreedom * std::pow(1 - 2 / (9 * kFreedom) + kNormalQuantile * std::sqrt(2 / (9 * kFreedom)), 3);
  CHECK(critical > 175);
  CHECK(critical < 185);
  CHECK(chi_square < critical);
}

TEST_CASE("beams, frames, sensors, seeds and effects have different numbers") {
  const std::string attributes = R"(range_noise="0.02")";
  const std::vector<double> z = deviations(attributes, 1, kNoise_m);
  // A product of two independent standard normal numbers has the variance 1.
  const double bound = kSigmas / std::sqrt(kSamples - 1.0);
  CHECK(std::abs(mean_product(z, z, 1)) <= bound);
  CHECK(std::abs(mean_product(z, deviations(attributes, 1, kNoise_m, 1), 0)) <= bound);
  for (const auto& effects : {effects_of(attributes, 1), effects_of(attributes, 0, "SCAN_2")}) {
    const Scan other = finished(effects, even_scan(1));
    std::vector<double> others;
    for (const float reading_m : other.range_m) others.push_back((static_cast<double>(reading_m) - 1) / kNoise_m);
    CHECK(std::abs(mean_product(z, others, 0)) <= bound);
  }
  // Beams that another effect loses stay lost, and the others keep their noise.
  const Scan whole = finished(effects_of(attributes), even_scan(1, 1000));
  const Scan rest = finished(effects_of(attributes + R"( dropout="0.5")"), even_scan(1, 1000));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < 1000; ++i) {
    if (std::isinf(rest.range_m[i])) continue;
    ++kept;
    CHECK(rest.range_m[i] == whole.range_m[i]);
  }
  CHECK(std::abs(static_cast<double>(kept) - 500) <= binomial_bound(1000, 0.5));
}

TEST_CASE("0 and inf stay, no reading is below 0, bounds stay, and zero noise is no effect") {
  Scan scan = even_scan(1, 1000);
  std::fill_n(scan.edit_ranges().range_m.begin(), 20, 0.0f);
  scan.edit_ranges().range_m[25] = kInfinity;
  std::ranges::fill(scan.edit_ranges().error_bound_m, 0.25f);
  const Scan noisy = finished(effects_of(R"(range_noise="2")"), scan);
  CHECK(std::ranges::count(noisy.range_m.begin(), noisy.range_m.begin() + 20, 0.0f) == 20);
  CHECK(noisy.range_m[25] == kInfinity);
  CHECK(noisy.error_bound_m == scan.error_bound_m);
  CHECK(std::ranges::min(noisy.range_m) == 0);
  CHECK(std::ranges::count(noisy.range_m, 0.0f) > 20);
  CHECK(std::ranges::count(noisy.range_m, kInfinity) == 1);
  CHECK(finished(effects_of(R"(range_noise="0" range_noise_rel="0")"), scan).range_m == scan.range_m);
}

namespace {

const std::string kNoisyScanner =
    R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="31" min_angle="-60" max_angle="60" )"
    R"(range_noise="0.05" range_noise_rel="0.001"/>)";
const std::string kOthers =
    R"(<sensor type="laser_scanner" name="SCAN_2" insert_at="ROOT" method="planar" range_noise="0.01"/>
       <sensor type="camera" name="CAM" insert_at="ROOT" width="16" height="12"/>)";

constexpr int kFrames = 4;

// Ranges of the last of kFrames frames.
std::vector<float> ranges(const std::string& commands, bool only_last, std::uint64_t seed = 0) {
  const TemporaryFolder folder;
  write_text(folder / "wall.gltf", wall_gltf());
  SimulationDesc desc;
  desc.seed = seed;
  Simulation simulation = Simulation::from_string(std::string(kWallPart) + commands, desc, folder.path());
  for (int frame = 0; frame < kFrames; ++frame) {
    simulation.enable("SCAN", !only_last || frame == kFrames - 1);
    simulation.step();
  }
  return simulation.scan("SCAN").range_m;
}

}  // namespace

TEST_CASE("neither other sensors nor skipped frames change a bit") {
  const std::vector<float> alone = ranges(kNoisyScanner, false);
  CHECK(ranges(kNoisyScanner, true) == alone);
  CHECK(ranges(kOthers + kNoisyScanner, false) == alone);
  CHECK(ranges(kNoisyScanner + kOthers, true) == alone);
  CHECK(ranges(kNoisyScanner, false, 1) != alone);
}

TEST_CASE("ranges are the nearest multiples of the step, and their bounds still hold") {
  constexpr std::uint32_t kRanges = 100'000;
  // Steps that float64 represents exactly and steps that it does not. In both cases the multiple is computed in double
  // and rounded once.
  struct Resolution {
    const char* attributes;
    double step_m;
  };
  for (const Resolution& resolution : {Resolution{R"(range_resolution="0.25")", 0.25},
                                       {R"(range_resolution="0.01")", 0.01},
                                       {R"(range_resolution="3")", 3.0}}) {
    const double step_m = resolution.step_m;
    CAPTURE(step_m);
    std::mt19937 random(1);
    Scan scan = even_scan(0, kRanges);
    for (float& range_m : scan.edit_ranges().range_m) range_m = std::uniform_real_distribution<float>(0, 100)(random);
    const Scan rounded = finished(effects_of(resolution.attributes), scan);
    std::uint64_t wrong = 0, lost = 0;
    for (std::uint32_t i = 0; i < kRanges; ++i) {
      const double range_m = scan.range_m[i], reading_m = rounded.range_m[i];
      const auto steps = static_cast<double>(std::llround(range_m / step_m));
      wrong += rounded.range_m[i] != static_cast<float>(steps * step_m);
      // Half a step, and what float32 rounds of 100 m.
      wrong += std::abs(reading_m - range_m) > step_m / 2 + 100 * 0x1p-24;
      lost += std::abs(reading_m - range_m) > static_cast<double>(rounded.error_bound_m[i]);
      wrong += rounded.error_bound_m[i] > std::nextafter(static_cast<float>(step_m / 2 + 100 * 0x1p-24), kInfinity);
    }
    CHECK(wrong == 0);
    CHECK(lost == 0);
  }
}

TEST_CASE("halves are rounded up; 0, inf and exact multiples keep their bounds") {
  const Scan scan = scan_of_numbers(std::vector<double>(6), {0}, {0, kInfinity, 0.25f, 0.75f, 1.5f, 0.125f},
                                    std::vector<float>(6, 0.0625f));
  const Scan rounded = finished(effects_of(R"(range_resolution="0.5")"), scan);
  CHECK(rounded.range_m == std::vector<float>{0, kInfinity, 0.5f, 1, 1.5f, 0});
  CHECK(rounded.error_bound_m[0] == 0.0625f);
  CHECK(rounded.error_bound_m[1] == 0.0625f);
  CHECK(rounded.error_bound_m[4] == 0.0625f);
  CHECK(rounded.error_bound_m[2] >= 0.3125f);
}

TEST_CASE("noise comes before rounding") {
  const Scan scan = finished(effects_of(R"(range_noise="0.5" range_resolution="0.25")"), even_scan(8, 1000));
  CHECK(std::ranges::all_of(scan.range_m, [](float r) { return r == std::floor(4 * r) / 4; }));
  CHECK(std::ranges::count(scan.range_m, 8.0f) < 500);
}

}  // namespace simvis::test

TEST_SUITE_END();
