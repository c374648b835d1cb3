// Rendered scans compared with a double-precision ray cast in random rooms and the marvin laboratory.
#include <doctest/doctest.h>

#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>
#include <random>
#include <sstream>

#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "engine/render/renderer.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"
#include "tests/support/scan_truth.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

// Relative: half of all beams of `planar` lie on one surface, where depth, plane and range are each rounded to float32
// once, by at most 2^-24 = 6e-8. The sum is 1.8e-7.
constexpr double kMedianError = 2e-7;

// The figures of a method in README, "Figures"; empty where none is published. Errors are relative, shares are of
// beams. A beam on a wrong surface has an error of more than 1e-3. If fewer than 1 % of the beams do, the 99th
// percentile is below that, and with fewer than 0.1 %, the 99.9th.
struct Published {
  std::optional<double> median_error, p99_error, p999_error;
  std::optional<double> uncertain_share;      ///< of beams with an infinite bound
  std::optional<double> wrong_surface_share;  ///< of beams that read another surface, or a hit for a miss
};
constexpr Published kPlanarRooms{5.8e-8, 3.5e-7, 1e-3, 0.009, 0.0005};
constexpr Published kNearestRooms{3.4e-5, 3.9e-4, {}, {}, {}};
constexpr Published kLidarRooms{7.3e-8, 1e-3, {}, 0.040, 0.008};
constexpr Published kPlanarMarvin{6.3e-8, 9e-5, {}, 0.034, 0.0018};

// Rooms, poses and beams are the same in each run, so only the rounding of the driver changes a figure. It moves a beam
// across a threshold only if the two are as close as rounding, which is rare.
constexpr double kOfPublished = 1.25;

// The reference is about twenty times slower under sanitizers, which do not look for rare beams.
const int kFewerRooms = sanitized() ? 8 : 1;

std::string text(const ScanComparison& comparison) {
  std::ostringstream out;
  out << comparison;
  return out.str();
}

void check_published(const ScanComparison& comparison, const Published& published) {
  if (sanitized()) return test::skip(test::kNotSanitized);  // an eighth of the beams has other tails
  const auto error = [&](double quantile) { return ScanComparison::quantile(comparison.relative_errors, quantile); };
  const auto share = [&](std::size_t beams) {
    return static_cast<double>(beams) / static_cast<double>(comparison.beams);
  };
  const auto check = [](double measured, const std::optional<double>& limit) {
    if (limit) CHECK(measured <= kOfPublished * *limit);
  };
  check(error(0.5), published.median_error);
  check(error(0.99), published.p99_error);
  check(error(0.999), published.p999_error);
  check(share(comparison.uncertain), published.uncertain_share);
  check(share(comparison.wrong_surface), published.wrong_surface_share);
}

void scan_once(Renderer& renderer, const DrawList& list, const glm::dmat4& world_from_sensor, LaserScanner& scanner) {
  FramePlan plan;
  scanner.plan(world_from_sensor, list, plan);
  scanner.collect({}, plan, renderer.render(list, plan));
}

glm::dmat4 somewhere(std::mt19937& random, bool level) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Pose pose;
  pose.position_m = {0.3 * unit(random), 0.3 * unit(random), 1 + 0.5 * unit(random)};
  pose.yaw_rad = kPi * unit(random);
  if (!level) {
    pose.roll_rad = 0.5 * unit(random);
    pose.pitch_rad = 0.5 * unit(random);
  }
  return to_matrix(pose);
}

void check_rooms(const LaserScannerDesc& desc, int rooms, const Published& published) {
  Device device;
  Renderer renderer(device);
  ScanComparison comparison;
  std::mt19937 random(11);
  for (int room = 0; room * kFewerRooms < rooms; ++room) {
    const DrawList list = random_room(static_cast<std::uint32_t>(room), 60, 24);
    const glm::dmat4 pose = somewhere(random, room % 2 == 0);
    LaserScanner scanner("S", desc);
    scan_once(renderer, list, pose, scanner);
    compare(*scanner.scan(), reference::RayCaster(list, rigid_inverse(pose)), desc.range_min_m, desc.range_max_m,
            2 / default_resolution_px(desc.pattern), comparison);
  }
  MESSAGE(text(comparison));
  CHECK(comparison.violations == 0);
  CHECK(comparison.narrow == 0);
  check_published(comparison, published);
  CHECK(comparison.relative_errors.size() > comparison.beams / 2);
  if (desc.method == ScanMethod::planar) CHECK(comparison.median_error() <= kMedianError);
}

}  // namespace

TEST_CASE("the hierarchy of the reference finds the same hits as brute force") {
  const DrawList list = random_room(5, 20, 12);
  const reference::RayCaster truth(list, glm::translate(glm::dmat4(1.0), {0, 0, -1}));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int ray = 0; ray < 2000; ++ray) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const reference::Hit fast = truth.cast(direction), slow = truth.cast_all(direction);
    REQUIRE(fast.range_m == slow.range_m);
    REQUIRE(std::isfinite(fast.range_m));
  }
}

TEST_CASE("planar scans of random rooms: 400,000 beams") {
  check_rooms({.pattern = {.beams = 10001, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = kPi / 2},
               .method = ScanMethod::planar},
              40, kPlanarRooms);
}

TEST_CASE("nearest scans of random rooms: the bound holds") {
  check_rooms({.pattern = {.beams = 10001, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = kPi / 2},
               .method = ScanMethod::nearest},
              20, kNearestRooms);
}

TEST_CASE("a lidar of 32 rings over a full turn in random rooms: 300,000 beams") {
  check_rooms({.pattern = {.beams = 1024,
                           .rings = 32,
                           .min_azimuth_rad = -kPi,
                           .max_azimuth_rad = kPi,
                           .min_elevation_rad = -0.35,
                           .max_elevation_rad = 0.35},
               .method = ScanMethod::planar},
              10, kLidarRooms);
}

TEST_CASE("planar scans of the marvin laboratory while the robot drives: 300,000 beams") {
  SimulationDesc desc;
  desc.overrides = {{"laser_scanner", "samples", "5001", "this test"},
                    {"laser_scanner", "method", "planar", "this test"}};
  Simulation simulation = Simulation::load(std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/marvin/marvin.xml", desc);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.type == "laser_scanner");
  ScanComparison comparison;
  for (int frame = 0; frame < 20; frame += kFewerRooms) {
    simulation.set("R_POSE", "yaw", 18.0 * frame);
    simulation.set("TILT", "value", -30 + 3.0 * frame);
    simulation.step();
    for (const char* name : {"FRONT_SCANNER", "REAR_SCANNER", "TILT_SCANNER"}) {
      glm::dmat4 world_from_sensor(1.0);
      REQUIRE(simulation.sensor_pose(name, world_from_sensor));
      compare(simulation.scan(name),
              reference::RayCaster(simulation.diagnostics().draw_list(), rigid_inverse(world_from_sensor)), 0.05, 80,
              2 / kPlanarResolution, comparison);
    }
  }
  MESSAGE(text(comparison));
  CHECK(comparison.violations == 0);
  CHECK(comparison.narrow == 0);
  check_published(comparison, kPlanarMarvin);
  CHECK(comparison.median_error() <= kMedianError);
}

TEST_SUITE_END();
