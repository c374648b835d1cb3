// Rendered scans of worlds whose ranges follow from geometry.
#include "sensors/laser_scanner/laser_scanner.h"

#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <string>

#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "engine/render/renderer.h"
#include "tests/support/error_of.h"
#include "tests/support/infinity.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

// float32 from vertex to range, relative to the largest coordinate of the hit surface: vertex rounding, plane setup and
// storing are about sixteen half-ulps of it, see depth_range.h. A test multiplies it by that coordinate over the range,
// and by the slant.
constexpr double kRounding = 16 * 0x1p-24;

glm::dmat4 scanner_at(double x, double y, double z) { return glm::translate(glm::dmat4(1.0), {x, y, z}); }

struct ScannerStage {
  Device device;
  Renderer renderer{device};
  DrawList list;
  double snap_tan = 0;  // of the last scan: how far a corner that gives depth may be displaced, as a tangent

  const Scan& scan(LaserScanner& scanner, const glm::dmat4& world_from_sensor = glm::dmat4(1.0)) {
    FramePlan plan;
    scanner.plan(world_from_sensor, list, plan);
    const auto results = renderer.render(list, plan);
    snap_tan = 0;
    for (std::size_t pass = 0; pass < plan.passes.size(); ++pass) {
      for (const View& view : plan.passes[pass].views) {
        snap_tan = std::max(snap_tan, results[pass].depth_snap_px / std::min(view.pinhole.fx_px, view.pinhole.fy_px));
      }
    }
    scanner.collect({}, plan, results);
    return *scanner.scan();
  }

  /// The relative error of a range where the device takes depth from snapped corners. In a view in which a plane has
  /// the normal n and a pixel the ray r = (u, v, 1), 1 / z is n . r over the plane's distance. Its gradient along each
  /// axis is |n.x| or |n.y| over that distance, together at most sqrt(2); and n . r is at least the cosine between the
  /// beam and the normal.
  double snapping(double cosine) const { return std::numbers::sqrt2 * snap_tan / cosine; }
};

LaserScannerDesc fan(std::uint32_t samples, double min_deg, double max_deg) {
  return {
      .pattern = {.beams = samples, .min_azimuth_rad = glm::radians(min_deg), .max_azimuth_rad = glm::radians(max_deg)},
      .method = ScanMethod::planar};
}

}  // namespace

TEST_CASE("a wall ahead: range = distance / cos(azimuth), for nearest within half a pixel, for planar to rounding") {
  ScannerStage stage;
  add_item(stage.list, half_box_mesh({0.5, 40, 3}), scanner_at(4.5, 0, 0));
  for (const ScanMethod method : {ScanMethod::planar, ScanMethod::nearest}) {
    LaserScannerDesc desc = fan(161, -80, 80);
    desc.method = method;
    LaserScanner scanner("S", desc);
    const Scan& scan = stage.scan(scanner);
    REQUIRE(scan.range_m.size() == 161);
    for (std::size_t beam = 0; beam < 161; ++beam) {
      const double a = scan.azimuth_rad[beam], expected = 4 / std::cos(a);
      // A pixel spans at most 2 / 4096 of tangent. Half of it becomes that times the slant tan(a), to first order.
      const double half_pixel =
          method == ScanMethod::nearest ? 1.01 * expected * (1 + std::abs(std::tan(a))) / 4096 : 0;
      // The corners of the wall are 40 m away, and its plane has the slant 1 / cos(a) to the beam.
      const double snapping_m = expected * stage.snapping(std::cos(a));
      CHECK(std::abs(scan.range_m[beam] - expected) <= kRounding * 40 / std::cos(a) + half_pixel + snapping_m);
      CHECK(std::abs(scan.range_m[beam] - expected) <= scan.error_bound_m[beam]);
    }
  }
}

TEST_CASE("range_min and range_max are limits along the ray, not clip planes") {
  ScannerStage stage;
  add_item(stage.list, half_box_mesh({0.01, 0.05, 1}),
           scanner_at(0.2, 0, 0));  // a plate close to the scanner, across azimuth 0
  add_item(stage.list, half_box_mesh({0.5, 40, 3}), scanner_at(10.5, 0, 0));  // the wall that it hides
  LaserScannerDesc desc = fan(3, -60, 60);
  desc.range_min_m = 1;
  desc.range_max_m = 15;
  LaserScanner scanner("S", desc);
  const Scan& scan = stage.scan(scanner);
  CHECK(scan.range_m[0] == kInfinity);  // 10 / cos 60 = 20 m
  CHECK(scan.error_bound_m[0] == 0);
  CHECK(scan.range_m[1] == 0);  // the plate blocks the beam
  CHECK(scan.error_bound_m[1] == 0);
  CHECK(scan.range_m[2] == kInfinity);
}

TEST_CASE("a surface a millimetre away still blocks the beam") {
  ScannerStage stage;
  add_item(stage.list, half_box_mesh({0.0005, 1, 1}), scanner_at(0.0015, 0, 0));
  LaserScanner scanner("S", fan(1, 0, 0));
  CHECK(stage.scan(scanner).range_m[0] == 0);
}

TEST_CASE("a full turn: the first and last beams agree within their bounds, and so do all at the borders of faces") {
  ScannerStage stage;
  add_item(stage.list, half_box_mesh({3, 2, 1.5}), scanner_at(0.4, -0.3, 0.2));
  LaserScanner scanner("S", fan(721, -180, 180));
  const Scan& scan = stage.scan(scanner, to_matrix({{0, 0, 0}, 0.1, -0.05, 0.3}));
  CHECK(std::abs(scan.range_m.front() - scan.range_m.back()) <= scan.error_bound_m.front() + scan.error_bound_m.back());
  if (stage.snap_tan == 0) CHECK(scan.error_bound_m.front() < 2e-4);  // rounding, no step
  // The same beams from scanners with other face positions.
  LaserScanner half("H", fan(361, -90, 90));
  const Scan& other = stage.scan(half, to_matrix({{0, 0, 0}, 0.1, -0.05, 0.3}));
  for (std::size_t beam = 0; beam < 361; ++beam) {
    CHECK(std::abs(scan.range_m[beam + 180] - other.range_m[beam]) <=
          scan.error_bound_m[beam + 180] + other.error_bound_m[beam]);
  }
}

TEST_CASE("a lidar inside a box, from straight down to straight up") {
  ScannerStage stage;
  const glm::dvec3 half(3, 2, 1.5);
  add_item(stage.list, half_box_mesh(half), glm::dmat4(1.0));
  LaserScannerDesc desc = fan(73, -180, 180);
  desc.pattern.rings = 37;
  desc.pattern.min_elevation_rad = -kPi / 2;
  desc.pattern.max_elevation_rad = kPi / 2;
  LaserScanner scanner("S", desc);
  const Scan& scan = stage.scan(scanner);
  int certain = 0;
  for (std::uint32_t ring = 0; ring < scan.rings; ++ring) {
    for (std::uint32_t beam = 0; beam < scan.beams; ++beam) {
      const double e = scan.elevation_rad[ring], a = scan.azimuth_rad[beam];
      const glm::dvec3 d = glm::abs(reference::beam_direction(a, e));
      const double expected = std::min({half.x / d.x, half.y / d.y, half.z / d.z});
      const std::size_t index = ring * scan.beams + beam;
      CHECK(std::abs(scan.range_m[index] - expected) <= scan.error_bound_m[index]);
      if (scan.error_bound_m[index] == kInfinity) continue;
      ++certain;
      // The corners of the box are 3.9 m away, its nearest walls 1.5 m: less than four times the range.
      const double cosine = std::max(
          {half.x / d.x <= expected ? d.x : 0, half.y / d.y <= expected ? d.y : 0, half.z / d.z <= expected ? d.z : 0});
      CHECK(std::abs(scan.range_m[index] - expected) <= (4 * kRounding + stage.snapping(cosine)) * expected);
    }
  }
  CHECK(certain > 0.95 * 73 * 37);
}

TEST_CASE("a tilted scanner over flat ground: a straight line, and no point below the ground") {
  ScannerStage stage;
  add_item(stage.list, half_box_mesh({200, 200, 0.5}), scanner_at(0, 0, -0.5));
  const glm::dmat4 pose = to_matrix({{0, 0, 1}, 0, glm::radians(20.0), 0});
  // The corners of the ground, 283 m away, are rounded to their half-ulp about four times. This displaces the plane
  // through them, which relative to the sensor's height of 1 m is the relative error of every range.
  constexpr double kGround_m = 4 * 283 * 0x1p-24;
  LaserScanner scanner("S", fan(121, -60, 60));
  const Scan& scan = stage.scan(scanner, pose);
  for (std::size_t beam = 0; beam < 121; ++beam) {
    const double a = scan.azimuth_rad[beam];
    const glm::dvec3 direction = glm::dmat3(pose) * glm::dvec3(std::cos(a), std::sin(a), 0);
    const double expected = -1 / direction.z;
    CHECK(std::abs(scan.range_m[beam] - expected) <= scan.error_bound_m[beam]);
    const double relative = kGround_m + stage.snapping(-direction.z);
    CHECK(std::abs(scan.range_m[beam] - expected) <= relative * expected);
    CHECK(scan.range_m[beam] * direction.z >= -1 - relative);
  }
}

TEST_CASE("a laser hits a single-sided surface from behind and passes mostly transparent surfaces") {
  ScannerStage stage;
  Mesh pane;
  pane.positions = {{2, -1, -1}, {2, 1, -1}, {2, 0, 1}};
  pane.indices = {0, 1, 2};
  for (const bool flipped : {false, true}) {
    stage.list = DrawList();
    if (flipped) std::swap(pane.indices[1], pane.indices[2]);
    add_item(stage.list, pane, glm::dmat4(1.0));
    LaserScanner scanner("S", fan(1, 0, 0));
    CHECK(stage.scan(scanner).range_m[0] == doctest::Approx(2).epsilon(1e-6));
  }
  auto glass = std::make_shared<Material>();
  glass->alpha_mode = AlphaMode::blend;
  glass->base_color = {1, 1, 1, 0.3f};
  stage.list.materials[0] = glass;
  ++stage.list.revisions.structure;
  LaserScanner scanner("S", fan(1, 0, 0));
  CHECK(stage.scan(scanner).range_m[0] == kInfinity);
}

TEST_CASE("more beams than a table may have are refused at the attribute, before there is memory for them") {
  const auto refused = [](const std::string& size) {
    return error_of(
        [&] { Simulation::from_string("<sensor type='laser_scanner' name='S' insert_at='ROOT' " + size + "/>"); });
  };
  CHECK(contains(refused("samples='1000000' vertical_samples='100000'"),
                 "attribute \"vertical_samples\": 100000 rings of 1000000 samples are too many beams"));
  CHECK(contains(refused("samples='2048' vertical_samples='2049'"), "expected at most 4194304"));
}

TEST_CASE("an empty scene reads infinity everywhere") {
  ScannerStage stage;
  stage.list.world_from_node.push_back(glm::dmat4(1.0));
  LaserScanner scanner("S", fan(361, -90, 90));
  for (const float range : stage.scan(scanner).range_m) CHECK(range == kInfinity);
}

TEST_CASE("a scan far from the world's origin is the same to 1e-6") {
  ScannerStage stage;
  LaserScanner scanner("S", fan(361, -180, 180));
  const auto scan_at = [&](const glm::dvec3& offset) {
    stage.list = random_room(3, 40, 16);
    for (glm::dmat4& m : stage.list.world_from_node) m = glm::translate(glm::dmat4(1.0), offset) * m;
    return stage.scan(scanner, scanner_at(offset.x, offset.y, offset.z + 1));
  };
  const Scan home = scan_at({0, 0, 0}), away = scan_at({1.2e6, -7.6e6, 300});
  int compared = 0;
  for (std::size_t beam = 0; beam < 361; ++beam) {
    if (home.error_bound_m[beam] == kInfinity) continue;
    ++compared;
    CHECK(std::abs(home.range_m[beam] - away.range_m[beam]) <= 1e-6 * home.range_m[beam]);
  }
  CHECK(compared > 300);
}

TEST_SUITE_END();
