// A million beams in random scenes by the methods that cast, compared with a second ray cast in double.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include <simvis/device.h>
#include <simvis/pose.h>
#include "sensors/laser_scanner/laser_scanner.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"
#include "tests/support/reference_raycast.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("engine/raycast");

using namespace simvis;

namespace {

constexpr double kMaxError = 1e-6;          // relative: sixteen times the rounding of a range to float32
constexpr double kPublishedMaximum = 6e-8;  // README, "Figures": rays give the same bytes on every device
constexpr double kBesideEdge = 1e-6;        // rad: beams closer to an edge are not checked

const std::size_t kBeams = sanitized() ? 20'000 : 1'000'000;

LaserScannerDesc random_scanner(std::mt19937& random, ScanMethod method) {
  std::uniform_real_distribution<double> unit(0, 1);
  LaserScannerDesc desc;
  desc.method = method;
  desc.range_min_m = 0;
  desc.range_max_m = 1e6;
  desc.pattern = {.beams = 5003, .min_azimuth_rad = -kPi * unit(random), .max_azimuth_rad = kPi * unit(random)};
  if (random() % 2 == 0) return desc;
  desc.pattern.beams = 313;
  desc.pattern.rings = 16;
  desc.pattern.min_elevation_rad = -kPi / 2 * unit(random);
  desc.pattern.max_elevation_rad = kPi / 2 * unit(random);
  return desc;
}

glm::dmat4 random_place(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Pose pose;
  pose.position_m = {0.3 * unit(random), 0.3 * unit(random), 1 + 0.5 * unit(random)};
  pose.roll_rad = kPi * unit(random);
  pose.pitch_rad = kPi / 2 * unit(random);
  pose.yaw_rad = kPi * unit(random);
  return to_matrix(pose);
}

bool agrees(double range_m, double truth_m) {
  return range_m == truth_m || std::abs(range_m - truth_m) <= kMaxError * truth_m;
}

bool agrees_beside(const reference::RayCaster& truth, double azimuth, double elevation, double range_m) {
  for (int way = 0; way < 8; ++way) {
    const double a = azimuth + kBesideEdge * std::cos(way * kPi / 4) / std::max(std::cos(elevation), 1e-3);
    const double e = elevation + kBesideEdge * std::sin(way * kPi / 4);
    if (agrees(range_m, truth.cast(reference::beam_direction(a, e)).range_m)) {
      return true;
    }
  }
  return false;
}

}  // namespace

TEST_CASE("a million beams, raycast and hybrid: no error above 1e-6, no wrong hit or miss") {
  Device device;
  std::mt19937 random(17);
  std::size_t beams = 0, beside_edges = 0, beyond_bound = 0;
  double worst = 0;
  for (std::uint32_t room = 0; beams < kBeams; ++room) {
    const DrawList list = random_room(200 + room, 60, 24);
    const std::unique_ptr<RayCaster> caster = make_ray_caster(device);
    caster->set_world(list);
    const glm::dmat4 pose = random_place(random);
    const reference::RayCaster truth(list, rigid_inverse(pose));
    for (const ScanMethod method : {ScanMethod::raycast, ScanMethod::hybrid}) {
      LaserScanner scanner("S", random_scanner(random, method));
      FramePlan plan;
      scanner.plan(pose, list, plan);
      REQUIRE(plan.passes.empty());  // no rendered range has a bound of 1e-6
      scanner.collect({}, plan, {});
      scanner.cast(*caster);
      const Scan& scan = *scanner.scan();
      for (std::size_t i = 0; i < scan.range_m.size(); ++i, ++beams) {
        const double a = scan.azimuth_rad[i % scan.beams], e = scan.elevation_rad[i / scan.beams];
        const double expected = truth.cast(reference::beam_direction(a, e)).range_m;
        const double range = scan.range_m[i];
        if (!agrees(range, expected)) {
          INFO("room " << room << ", beam " << i << ": " << range << " m for " << expected << " m");
          REQUIRE(agrees_beside(truth, a, e, range));
          ++beside_edges;
          continue;
        }
        if (range == expected) continue;
        worst = std::max(worst, std::abs(range - expected) / expected);
        beyond_bound += std::abs(range - expected) > scan.error_bound_m[i];
      }
    }
  }
  MESSAGE(beams << " beams: error at most " << worst << ", " << beside_edges << " beside edges");
  CHECK(beyond_bound == 0);
  CHECK(worst > 0);
  CHECK(worst <= kPublishedMaximum);
}

TEST_SUITE_END();
