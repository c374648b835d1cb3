// Means of random samples whose number follows from their spread: no bias, and the error that is wanted.
#include "sensors/camera/pixel_estimate.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <simvis/philox.h>
#include "tests/light/path_stage.h"

TEST_SUITE_BEGIN("engine/light");

namespace simvis::test {
namespace {

constexpr std::uint32_t kTile_px = PixelEstimate::kTileSize_px,
                        kPilots = PixelEstimate::kParts * PixelEstimate::kPilotSamples;

// A number that is 1 / chance with this chance, else 0: its mean is 1 and its variance 1 / chance - 1.
double rare(double uniform, double chance) { return uniform < chance ? 1 / chance : 0; }

// Takes all samples of an image. `value` gives that of a sample and a pixel.
template <typename Value>
void fill(PixelEstimate& estimate, std::uint32_t pixels, const Value& value) {
  estimate.begin();
  for (std::uint32_t sample = 0; estimate.wants(sample); ++sample) {
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
      if (estimate.takes(sample, pixel)) estimate.add(sample, pixel, glm::dvec3(value(sample, pixel)));
    }
  }
}

TEST_CASE("the pixels that take a sample are visited once, in any rows") {
  constexpr std::uint32_t kWidth = 3 * kTile_px - 5, kHeight = 2 * kTile_px + 3;
  PixelEstimate estimate(kWidth, kHeight, 1, 0.1);
  const SensorRandom random(3, "pixels");
  // The tile in the middle of the first row is noisy.
  const auto is_noisy = [&](std::uint32_t pixel) {
    return pixel / kWidth < kTile_px && pixel % kWidth / kTile_px == 1;
  };
  fill(estimate, kWidth * kHeight, [&](std::uint32_t sample, std::uint32_t pixel) {
    return is_noisy(pixel) ? random.gaussian(0, pixel, sample) : 0;
  });
  for (const std::uint32_t sample : {0u, kPilots + 1}) {
    for (const std::array<std::uint32_t, 2> of : {std::array{0u, kHeight}, std::array{3u, 20u}, std::array{17u, 1u}}) {
      const std::uint32_t first = of[0], rows = of[1];
      std::vector<std::uint32_t> visited, expected;
      estimate.for_pixels(sample, first, rows, [&](std::uint32_t pixel) { visited.push_back(pixel); });
      for (std::uint32_t pixel = first * kWidth; pixel < (first + rows) * kWidth; ++pixel) {
        if (sample < kPilots || is_noisy(pixel)) expected.push_back(pixel);
      }
      std::ranges::sort(visited);
      CHECK(visited == expected);
      CHECK(estimate.takes_some(sample, first, rows) == !expected.empty());
    }
  }
}

// One pixel decides for itself here, where a number of samples that follows from its own values biases most: if each
// part decides for itself, the mean is 0.53. If two halves decide for each other, variances are too small.
TEST_CASE("means are unbiased, and so are their variances, although spread decides the number of samples") {
  constexpr double kChance = 0.1, kVariance = 1 / kChance - 1;
  constexpr std::uint32_t kTrials = 20000;
  const SensorRandom random(7, "trials");
  PixelEstimate estimate(1, 1, 0, std::sqrt(kVariance / 60));  // about 60 samples
  double sum = 0, squares = 0, variances = 0, fourth = 0;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    fill(estimate, 1,
         [&](std::uint32_t sample, std::uint32_t) { return rare(random.uniform(trial, sample, 0), kChance); });
    const double mean = estimate.mean(0).x, off = (mean - 1) * (mean - 1) - estimate.variance(0).x;
    sum += mean;
    squares += (mean - 1) * (mean - 1);
    variances += off;
    fourth += off * off;
  }
  CHECK(agree(sum / kTrials, 1, std::sqrt(squares) / kTrials));
  CHECK(agree(variances / kTrials, 0, std::sqrt(fourth) / kTrials));
}

TEST_CASE("each tile takes as many samples as its error needs, at least the pilot") {
  constexpr double kNoise = 0.1;
  // Four tiles, the last ones of one column and one row: their samples have the variances 0, 1, 4 and 16.
  constexpr std::uint32_t kWidth_px = kTile_px + 1, kHeight_px = 2 * kTile_px;
  const SensorRandom random(3, "tiles");
  const auto deviation = [](std::uint32_t pixel) {
    const std::uint32_t right = pixel % kWidth_px / kTile_px, lower = pixel / kWidth_px / kTile_px;
    return 2 * lower + right == 0 ? 0.0 : std::pow(2.0, 2 * lower + right - 1);
  };
  PixelEstimate estimate(kWidth_px, kHeight_px, 0, kNoise);
  std::vector<std::uint32_t> taken(std::size_t{kWidth_px} * kHeight_px, 0);
  fill(estimate, kWidth_px * kHeight_px, [&](std::uint32_t sample, std::uint32_t pixel) {
    ++taken[pixel];
    return 1 + deviation(pixel) * random.gaussian(0, pixel, sample);
  });
  for (std::uint32_t pixel = 0; pixel < taken.size(); ++pixel) {
    const double wanted = std::pow(deviation(pixel) / kNoise, 2);
    // Tiles of one column have 16 pixels, whose three variances from six samples have 15 degrees of freedom together:
    // 5 sqrt(2 / (15 x 16)) is 0.46.
    CHECK(taken[pixel] >= std::max<double>(kPilots, 0.54 * wanted));
    CHECK(taken[pixel] <= std::max<double>(kPilots, 1.46 * wanted) + PixelEstimate::kParts);
  }
  const ReachedNoise reached = estimate.reached();
  CHECK(reached.tiles == 4);
  CHECK(reached.max_error < 1.8 * kNoise);
  CHECK(reached.max_samples == *std::ranges::max_element(taken));
  CHECK(reached.samples > kPilots);
}

TEST_CASE("a noise whose square is 0 needs the pilot where samples are equal, and the most where they are not") {
  constexpr double kNoise = 1e-200;
  static_assert(kNoise * kNoise == 0);
  PixelEstimate estimate(kTile_px + 1, 1, 0, kNoise);  // two tiles
  std::vector<std::uint32_t> taken(kTile_px + 1, 0);
  fill(estimate, kTile_px + 1, [&](std::uint32_t sample, std::uint32_t pixel) {
    ++taken[pixel];
    return pixel == kTile_px ? sample % 2 : 1.0;
  });
  for (std::uint32_t pixel = 0; pixel < kTile_px; ++pixel) {
    CHECK(taken[pixel] == kPilots);
    CHECK(estimate.mean(pixel).x == 1);
    CHECK(estimate.variance(pixel).x == 0);
  }
  constexpr std::uint32_t kMost = PixelEstimate::kMaxSamples / PixelEstimate::kParts * PixelEstimate::kParts;
  CHECK(taken[kTile_px] == kMost);
  const ReachedNoise reached = estimate.reached();
  CHECK(reached.max_samples == kMost);
  CHECK(reached.tiles_above == 1);
  CHECK(std::isfinite(reached.error));
}

TEST_CASE("without noise each pixel takes the number that is given, and has the mean and the variance of all") {
  PixelEstimate estimate(2, 1, 5, {});
  fill(estimate, 2, [](std::uint32_t sample, std::uint32_t pixel) { return pixel == 0 ? sample : 1.0; });
  CHECK(estimate.mean(0).x == 2);
  CHECK(estimate.variance(0).x == 0.5);  // of 0 to 4 it is 2.5
  CHECK(estimate.mean(1).x == 1);
  CHECK(estimate.variance(1).x == 0);
}

}  // namespace
}  // namespace simvis::test
