// The effect `blooming` against the share of a sign in the cone of scattered light.
#include <doctest/doctest.h>

#include <cmath>

#include <simvis/simulation.h>
#include "tests/support/traced_beams.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

constexpr double kSignAt_m = 5, kHalfSign_m = 0.1, kGain = 1000, kBloom = 0.001, kConeHalf_deg = 1.5;
constexpr int kBloomRays = 4096;

// Five beams in steps of 2 degrees, the middle one on a sign of 20 x 20 cm.
Scan see_sign(const std::string& material, const std::string& attributes) {
  Simulation simulation = Simulation::from_string(R"(<simvis>
  <part shape="box" size="0.02 0.2 0.2" name="SIGN" insert_at="ROOT" pose_offset="5.01 0 0 0 0 0"/>
  <element type="material" name="PAINT" insert_at="ROOT" part="SIGN" )" +
                                                  material + R"(/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5" min_angle="-4" max_angle="4" intensity="on" )" +
                                                  attributes + "/>\n</simvis>\n");
  simulation.step();
  return simulation.scan("SCAN");
}

// The share of the cone around `azimuth_deg` that meets the sign, by a fine grid over the cone's disc.
double share_on_sign(double azimuth_deg) {
  const double radius = std::tan(kConeHalf_deg * std::numbers::pi / 180),
               azimuth = azimuth_deg * std::numbers::pi / 180;
  constexpr int kSteps = 1000;
  int inside = 0, met = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double u = radius * ((2 * i + 1.0) / kSteps - 1), v = radius * ((2 * j + 1.0) / kSteps - 1);
      if (u * u + v * v > radius * radius) continue;
      ++inside;
      const double x = std::cos(azimuth) - u * std::sin(azimuth), y = std::sin(azimuth) + u * std::cos(azimuth);
      met += std::abs(y / x * kSignAt_m) < kHalfSign_m && std::abs(v / x * kSignAt_m) < kHalfSign_m;
    }
  }
  return static_cast<double>(met) / inside;
}

}  // namespace

TEST_CASE("beams beside a retro-reflector read it, by its share of the halo, and others do not") {
  const std::string retro = R"(retro_reflectance="1000")";
  const std::string bloom = R"(bloom="0.001" bloom_angle="3" bloom_samples=")" + std::to_string(kBloomRays) + "\"";
  const Scan plain = see_sign(retro, ""), seen = see_sign(retro, bloom), matte = see_sign("", bloom);
  for (const std::size_t beam : {0, 1, 3, 4}) CHECK(std::isinf(plain.range_m[beam]));
  for (const std::size_t beam : {0, 4}) CHECK(std::isinf(seen.range_m[beam]));  // 4 degrees from the sign
  // The light that a matte sign returns from the halo is 16,000 times below that of the middle beam.
  for (const std::size_t beam : {0, 1, 3, 4}) CHECK(std::isinf(matte.range_m[beam]));
  const double share = share_on_sign(2);
  CHECK(share > 0.1);
  for (const std::size_t beam : {1, 3}) {
    const double range_m = seen.range_m[beam], power = seen.channel("intensity")[beam];
    CHECK(range_m >= kSignAt_m);
    CHECK(range_m < kSignAt_m / std::cos(2 * std::numbers::pi / 180));  // the far edge of the sign is nearer
    // As if rays were drawn by chance, which is farther off than an even pattern; the range varies by 1e-3.
    const double expected = kBloom * share * kGain / (kSignAt_m * kSignAt_m);
    const double chance = std::sqrt((1 - share) / (share * kBloomRays));
    CHECK(std::abs(power / expected - 1) < kSigmas * chance + 0.002);
  }
  // The beam on the sign keeps its light but for what its halo has around the sign.
  const double on_sign = seen.channel("intensity")[2] / plain.channel("intensity")[2];
  CHECK(on_sign <= 1);
  CHECK(on_sign > 1 - kBloom);
  // The halo of the matte sign is part of its pulse, up to 1.5 degrees off; ranges are float32.
  const double moved_m = kBloom * kSignAt_m * (1 / std::cos(kConeHalf_deg * std::numbers::pi / 180) - 1) + 1e-6;
  CHECK(std::abs(double{matte.range_m[2]} - plain.range_m[2]) <= moved_m);
}

}  // namespace simvis

TEST_SUITE_END();
