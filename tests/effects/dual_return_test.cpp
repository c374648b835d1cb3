// The effect `dual_return`: which return is the second, and what a scanner reports of a fence.
#include "effects/scanner/dual_return.h"

#include <doctest/doctest.h>

#include <cmath>

#include <simvis/simulation.h>
#include "tests/support/temporary_folder.h"
#include "tests/support/traced_beams.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

Echo returned(double range_m, double power) { return {.range_m = range_m, .power = power}; }

// Beams of 2 degrees that graze the edge of a board 3 m away, with a wall 6 m away.
std::string board_scene(const std::string& attributes) {
  return R"(<simvis>
  <part shape="box" size="0.1 4 4" name="WALL" insert_at="ROOT" pose_offset="6.05 0 0 0 0 0"/>
  <part shape="box" size="0.1 2 4" name="BOARD" insert_at="ROOT" pose_offset="3.05 1 0 0 0 0"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="9" min_angle="-4" max_angle="4" divergence="2"
          divergence_samples="256" intensity="on" )" +
         attributes + "/>\n</simvis>\n";
}

Scan scan_of(const std::string& attributes, int frames = 1) {
  Simulation simulation = Simulation::from_string(board_scene(attributes));
  for (int i = 0; i < frames; ++i) simulation.step();
  return simulation.scan("SCAN");
}

}  // namespace

TEST_CASE("the second return is the last, or the second strongest if the strongest is the last") {
  CHECK(second_return({}) == nullptr);
  const std::vector<Echo> one = {returned(5, 1)};
  CHECK(second_return(one) == nullptr);
  const std::vector<Echo> near_is_strong = {returned(3, 4), returned(5, 1), returned(9, 2)};
  CHECK(second_return(near_is_strong)->range_m == 9);
  const std::vector<Echo> far_is_strong = {returned(3, 2), returned(5, 1), returned(9, 4)};
  CHECK(second_return(far_is_strong)->range_m == 3);
}

TEST_CASE("beams at the edge of a board have both surfaces, all others one") {
  const Scan dual = scan_of(R"(return="dual")"), strongest = scan_of(R"(return="strongest" pulse_length="0.75")");
  const Scan last = scan_of(R"(return="last")");
  const SharedNumbers<double> second = dual.channel("second_range_m"), light = dual.channel("second_intensity");
  REQUIRE(second.size() == dual.range_m.size());
  REQUIRE(light.size() == dual.range_m.size());
  int pairs = 0;
  for (std::size_t i = 0; i < dual.range_m.size(); ++i) {
    CAPTURE(i);
    CHECK(dual.range_m[i] == strongest.range_m[i]);
    const double count = dual.channel("return_count")[i];
    CHECK(std::isnan(second[i]) == (count == 1));
    CHECK(std::isnan(light[i]) == (count == 1));
    // With two returns, one of both is the last.
    const double farthest_m = count == 1 ? dual.range_m[i] : std::max<double>(dual.range_m[i], second[i]);
    CHECK(static_cast<float>(farthest_m) == last.range_m[i]);
    if (count == 1) continue;
    ++pairs;
    // The second return is the weaker one.
    CHECK(light[i] > 0);
    CHECK(light[i] <= dual.channel("intensity")[i]);
  }
  CHECK(pairs == 1);  // the middle beam alone is nearer than a degree to the edge, in the open interval
}

TEST_CASE("the second return has noise of its own, and the rounding of the first") {
  double mean_m = 0, square_m2 = 0, product_m2 = 0;
  Simulation simulation = Simulation::from_string(board_scene(R"(return="dual" range_noise="0.02")"));
  const Scan exact = scan_of(R"(return="dual")");
  constexpr int kFrames = 400;
  for (int i = 0; i < kFrames; ++i) {
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    const double error_m = scan.channel("second_range_m")[4] - exact.channel("second_range_m")[4];
    mean_m += error_m / kFrames;
    square_m2 += error_m * error_m / kFrames;
    product_m2 += error_m * (scan.range_m[4] - exact.range_m[4]) / kFrames;
  }
  constexpr double kSigma_m = 0.02;
  CHECK(std::abs(mean_m) < kSigmas * kSigma_m / std::sqrt(kFrames));
  CHECK(std::abs(square_m2 - kSigma_m * kSigma_m) < kSigmas * kSigma_m * kSigma_m * std::sqrt(2.0 / kFrames));
  CHECK(std::abs(product_m2) < kSigmas * kSigma_m * kSigma_m / std::sqrt(kFrames));
  const Scan rounded = scan_of(R"(return="dual" range_noise="0.02" range_resolution="0.25")");
  const double steps = rounded.channel("second_range_m")[4] / 0.25;
  CHECK(steps == std::round(steps));
}

}  // namespace simvis

TEST_SUITE_END();
