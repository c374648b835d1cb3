// The effect `angular_noise`: moments of the angles, and what they do to ranges.
#include "effects/scanner/angular_noise.h"

#include <doctest/doctest.h>

#include "tests/support/reference_directions.h"
#include "tests/support/traced_beams.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

constexpr double kDeviation_rad = 0.01;

std::shared_ptr<const AngularNoise> noise(std::uint64_t seed = 0, const std::string& sensor = "S") {
  return std::make_shared<AngularNoise>(kDeviation_rad, SensorRandom(seed, sensor + "/angular_noise"));
}

std::vector<glm::dvec3> noisy(std::size_t beams, const ScanEffect& effect, std::uint64_t frame = 0) {
  std::vector<BeamRay> rays(beams);
  for (std::uint32_t beam = 0; beam < beams; ++beam)
    rays[beam] = {.beam = beam, .direction = reference::beam_direction(0.5, 0.7)};
  ScanContext moment = moment_of(beams);
  moment.time.index = frame;
  effect.aim(moment, rays);
  std::vector<glm::dvec3> directions;
  for (const BeamRay& ray : rays) directions.push_back(ray.direction);
  return directions;
}

TEST_CASE("azimuth and elevation: mean, deviation, tails and correlation of the normal distribution") {
  const std::size_t beams = 1000000 / kFewer;
  Moments azimuth, elevation, product, fourth;
  for (const glm::dvec3& d : noisy(beams, *noise())) {
    CHECK_MESSAGE(std::abs(glm::length(d) - 1) < 4 * 0x1p-53, "unit length");
    const double a = (std::atan2(d.y, d.x) - 0.5) / kDeviation_rad, e = (std::asin(d.z) - 0.7) / kDeviation_rad;
    azimuth.add(a);
    elevation.add(e);
    product.add(a * e);
    fourth.add(a * a * a * a);
  }
  const double n = static_cast<double>(beams);
  for (const Moments* each : {&azimuth, &elevation}) {
    CHECK(std::abs(each->mean()) <= kSigmas / std::sqrt(n));
    CHECK(std::abs(each->variance() - 1) <= kSigmas * std::sqrt(2 / n));
  }
  CHECK(std::abs(product.mean()) <= kSigmas / std::sqrt(n));
  CHECK(std::abs(fourth.mean() - 3) <= kSigmas * std::sqrt(96 / n));  // E x^8 - 9 = 96
}

TEST_CASE("frames, seeds and sensors have different numbers, and equal ones have the same") {
  const std::vector<glm::dvec3> here = noisy(4, *noise(), 3);
  CHECK(noisy(4, *noise(), 3) == here);
  CHECK(noisy(4, *noise(), 4) != here);
  CHECK(noisy(4, *noise(1), 3) != here);
  CHECK(noisy(4, *noise(0, "T"), 3) != here);
  const std::vector<glm::dvec3> fewer = noisy(2, *noise(), 3);
  CHECK(std::equal(fewer.begin(), fewer.end(), here.begin()));
}

// At a wall across x, the range at azimuth a is h / cos a. Its deviation is h tan(a) / cos(a) times that of a. The
// second order moves the mean by half the second derivative times the variance.
TEST_CASE("ranges at a slanted wall scatter by its slope") {
  constexpr double kWall_m = 5;
  constexpr double kAzimuth = 0.9;
  const std::size_t beams = 200000 / kFewer;
  DrawList list;
  add_item(list, plate_mesh(kWall_m, {-30, -30}, {30, 30}), glm::dmat4(1));
  Moments ranges;
  for (const Echo& echo : trace(list, std::vector(beams, reference::beam_direction(kAzimuth, 0)), {noise()}))
    ranges.add(echo.range_m);
  const double t = std::tan(kAzimuth), range_m = kWall_m / std::cos(kAzimuth), v = kDeviation_rad * kDeviation_rad;
  // Azimuth: r' = r t, r'' = r (1 + 2 t^2); elevation: r'' = r, r' = 0.
  const double mean_m = range_m * (1 + v / 2 * (1 + 2 * t * t) + v / 2), deviation_m = range_m * t * kDeviation_rad;
  // Neglected: the fourth order in the mean and the second order in the deviation. (t s)^2 is above the share of both
  // factors.
  const double second = 10 * (1 + t * t) * v;
  CHECK(std::abs(ranges.mean() - mean_m) <= kSigmas * ranges.standard_error() + range_m * second * second);
  const double n = static_cast<double>(beams);
  CHECK(std::abs(std::sqrt(ranges.variance()) - deviation_m) <= deviation_m * (kSigmas / std::sqrt(2 * n) + second));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
