// Lost beams: how many are lost by chance and by power, and that the others stay unchanged.
#include <doctest/doctest.h>

#include <algorithm>
#include <span>

#include <simvis/simulation.h>
#include "tests/support/infinity.h"
#include "tests/support/made_up_scan.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

double lost_in(std::span<const float> ranges_m) { return static_cast<double>(std::ranges::count(ranges_m, kInfinity)); }

// The number of lost echoes of this power, each the only echo of its beam.
double lost_of(const std::vector<ChosenScanEffect>& effects, double power, std::uint32_t beams) {
  double lost = 0;
  for (std::uint32_t beam = 0; beam < beams; ++beam) {
    std::vector<Echo> echoes{{.range_m = 1, .power = power}};
    for (const ChosenScanEffect& each : effects) each.effect->receive({}, beam, echoes);
    lost += echoes.empty();
  }
  return lost;
}

}  // namespace

TEST_CASE("loss by chance: the share is the given one; blocked beams stay blocked, and lost beams read as misses") {
  for (const auto& [attributes, share] : {std::pair{R"(dropout="0.1")", 0.1}, {R"(dropout="0.003")", 0.003}}) {
    const Scan scan = finished(effects_of(attributes), even_scan(5));
    CHECK(std::abs(lost_in(scan.range_m) - share * kSamples) <= binomial_bound(kSamples, share));
    CHECK(std::ranges::count(scan.range_m, 5.0f) + lost_in(scan.range_m) == kSamples);
  }
  Scan scan = even_scan(5, 4);
  scan.edit_ranges().range_m[1] = 0;
  std::ranges::fill(scan.edit_ranges().error_bound_m, 0.5f);
  const Scan all = finished(effects_of(R"(dropout="1")"), scan);
  CHECK(all.range_m == std::vector<float>{kInfinity, 0, kInfinity, kInfinity});
  CHECK(all.error_bound_m == std::vector<float>{0, 0.5f, 0, 0});
  CHECK(finished(effects_of(R"(dropout="0")"), scan).range_m == scan.range_m);
}

TEST_CASE("loss by power: an amplitude with Gaussian noise is compared with a threshold") {
  constexpr std::uint32_t kBeams = 200'000;
  constexpr double kThreshold = 0.004, kNoise = 0.25;
  const auto effects = effects_of(R"(dropout_power="0.004" dropout_noise="0.25")");
  for (const double sigmas : {-3.0, -1.0, -0.3, 0.0, 0.5, 1.0, 2.5}) {
    CAPTURE(sigmas);
    const double seen = normal_below(sigmas);
    CHECK(std::abs(lost_of(effects, kThreshold * (1 + kNoise * sigmas), kBeams) - kBeams * (1 - seen)) <=
          binomial_bound(kBeams, seen));
  }
  const auto sharp = effects_of(R"(dropout_power="0.004" dropout_noise="0")");
  CHECK(lost_of(sharp, 0.00399, 1000) == 1000);
  CHECK(lost_of(sharp, 0.004, 1000) == 0);
}

TEST_CASE("echoes of one beam are lost independently") {
  constexpr std::uint32_t kBeams = 100'000;
  const auto effects = effects_of(R"(dropout_power="1" dropout_noise="0.5")");
  double both = 0, first = 0;
  for (std::uint32_t beam = 0; beam < kBeams; ++beam) {
    std::vector<Echo> echoes{{.range_m = 1, .power = 1}, {.range_m = 2, .power = 1}};
    for (const ChosenScanEffect& each : effects) each.effect->receive({}, beam, echoes);
    both += echoes.empty();
    first += echoes.empty() || echoes[0].range_m == 2;
  }
  CHECK(std::abs(first - kBeams / 2.0) <= binomial_bound(kBeams, 0.5));
  CHECK(std::abs(both - kBeams / 4.0) <= binomial_bound(kBeams, 0.25));
}

TEST_CASE("dark, slanted and distant surfaces are lost first") {
  // All beams of the scanner have one direction, towards the wall at 4 m. The power by its definition is reflectance x
  // cosine / range^2, with the reflectance of the wall (1, 0.5, 0.25) or of the element material.
  constexpr int kBeams = 5000;
  constexpr double kColor = 1.75 / 3, kNoise = 0.3;
  struct Case {
    const char* pose;
    const char* commands;
    double reflectance, cosine, range_m;
  };
  const char* const dark = R"(<element type="material" name="DARK" insert_at="ROOT" part="WALL" reflectance="0.4"/>)";
  for (const Case& c :
       {Case{"0 0 0 0 0 0", "", kColor, 1, 4}, Case{"0.5 0 0 0 0 0", "", kColor, 1, 3.5},
        Case{"0.5 0 0 0 0 30", "", kColor, std::cos(glm::radians(30.0)), 3.5 / std::cos(glm::radians(30.0))},
        Case{"0.5 0 0 0 0 0", dark, 0.4, 1, 3.5}}) {
    CAPTURE(c.pose);
    CAPTURE(c.reflectance);
    const TemporaryFolder folder;
    write_text(folder / "wall.gltf", wall_gltf());
    const std::string scanner =
        R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5000" min_angle="0" max_angle="0" )"
        R"(dropout_power="0.036" dropout_noise="0.3" pose_offset=")" +
        std::string(c.pose) + R"("/>)";
    Simulation simulation = Simulation::from_string(std::string(kWallPart) + c.commands + scanner, {}, folder.path());
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    const double power = c.reflectance * c.cosine / (c.range_m * c.range_m);
    const double seen = normal_below((power - 0.036) / (kNoise * 0.036));
    CHECK(seen > 0.02);
    CHECK(seen < 0.98);
    CHECK(std::abs(lost_in(scan.range_m) - kBeams * (1 - seen)) <= binomial_bound(kBeams, seen));
    for (std::size_t beam = 0; beam < kBeams; ++beam) {
      if (std::isinf(scan.range_m[beam])) continue;
      REQUIRE(std::abs(scan.range_m[beam] - c.range_m) <= static_cast<double>(scan.error_bound_m[beam]));
    }
  }
}

}  // namespace simvis::test

TEST_SUITE_END();
