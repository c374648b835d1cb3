// The scanner's methods that cast: compared with a second ray cast in double and with each other, and their cost.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <sstream>

#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "engine/render/renderer.h"
#include "program/report/explain.h"
#include "program/report/run_report.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "sensors/raster_depth/depth_range.h"
#include "tests/support/error_of.h"
#include "tests/support/infinity.h"
#include "tests/support/random_room.h"
#include "tests/support/raster_grid.h"
#include "tests/support/ray_casting.h"
#include "tests/support/reference_directions.h"
#include "tests/support/scan_truth.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

constexpr double kMaxError = 1e-6;  // relative: sixteen times the rounding of a range to float32
// Of `raycast` in random rooms: README, "Figures", which rounds up. Rays give the same bytes on every device.
constexpr double kPublishedMedian = 2.15e-8, kPublishedMaximum = 6e-8;
constexpr double kMaxTightness = 20;  // and of the median bound over the median error
constexpr double kHalfUlp = 0x1p-24;  // of a float32, relative

// The reference is about twenty times slower under sanitizers.
const int kFewerFrames = sanitized() ? 8 : 1;

const std::filesystem::path kMarvin = std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/marvin/marvin.xml";
constexpr const char* kScanners[] = {"FRONT_SCANNER", "REAR_SCANNER", "TILT_SCANNER"};

using Overrides = std::vector<std::pair<std::string, std::string>>;

Simulation marvin(const Overrides& attributes) {
  SimulationDesc desc;
  for (const auto& [name, value] : attributes) desc.overrides.push_back({"laser_scanner", name, value, "this test"});
  Simulation simulation = Simulation::load(kMarvin, desc);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.type == "laser_scanner");
  return simulation;
}

void drive(Simulation& simulation, int frame) {
  simulation.set("R_POSE", "yaw", 18.0 * frame);
  simulation.set("TILT", "value", -30 + 3.0 * frame);
  simulation.step();
}

double cast_share(const Simulation& simulation, const std::string& name) {
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensor.name == name) return sensor.number("cast_share").value_or(-1);
  }
  return -1;
}

std::string json_of(const Simulation& simulation) {
  RunReport report;
  report.sensors = simulation.sensors();
  return to_json(report);
}

std::string hybrid_text(const ScanComparison& comparison) {
  std::ostringstream out;
  out << comparison;
  return out.str();
}

// A cast beam has no pixels: no surface is too narrow for it, and no beam is uncertain.
void check_cast(const ScanComparison& comparison) {
  MESSAGE(hybrid_text(comparison));
  CHECK(comparison.violations == 0);
  CHECK(comparison.narrow == 0);
  CHECK(comparison.uncertain == 0);
  CHECK(ScanComparison::quantile(comparison.relative_errors, 1) <= kMaxError);
  CHECK(ScanComparison::quantile(comparison.relative_bounds, 1) <= kMaxError);
  CHECK(ScanComparison::quantile(comparison.relative_bounds, 0.5) <= kMaxTightness * comparison.median_error());
}

void scan_once(const DrawList& list, const glm::dmat4& world_from_sensor, LaserScanner& scanner) {
  FramePlan plan;
  const std::unique_ptr<RayCaster> caster = make_ray_caster(ray_device());
  caster->set_world(list);
  scanner.plan(world_from_sensor, list, plan);
  CHECK(plan.passes.empty());
  scanner.collect({}, plan, {});
  scanner.cast(*caster);
}

}  // namespace

TEST_CASE("raycast in the marvin laboratory while the robot drives") {
  Simulation simulation = marvin({{"method", "raycast"}, {"samples", "2001"}});
  ScanComparison comparison;
  for (int frame = 0; frame < 10; frame += kFewerFrames) {
    drive(simulation, frame);
    CHECK(simulation.diagnostics().counters() == FrameCounters{});  // nothing is rendered, uploaded or held
    for (const char* name : kScanners) {
      glm::dmat4 world_from_sensor(1.0);
      REQUIRE(simulation.sensor_pose(name, world_from_sensor));
      compare(simulation.scan(name),
              reference::RayCaster(simulation.diagnostics().draw_list(), rigid_inverse(world_from_sensor)), 0.05, 80, 0,
              comparison);
      CHECK(cast_share(simulation, name) == 1);
    }
  }
  check_cast(comparison);
}

TEST_CASE("raycast with 64 rings all around in random rooms") {
  LaserScannerDesc desc;
  desc.pattern = {.beams = 256,
                  .rings = 64,
                  .min_azimuth_rad = -kPi,
                  .max_azimuth_rad = kPi,
                  .min_elevation_rad = -kPi / 2,
                  .max_elevation_rad = kPi / 2};
  desc.method = ScanMethod::raycast;
  ScanComparison comparison;
  for (int room = 0; room * kFewerFrames < 8; ++room) {
    const DrawList list = random_room(static_cast<std::uint32_t>(100 + room), 60, 24);
    Pose pose;
    pose.position_m = {0.1 * room, 0.05 * room, 1.2};
    pose.roll_rad = 0.3 * room;
    pose.yaw_rad = room;
    LaserScanner scanner("S", desc);
    scan_once(list, to_matrix(pose), scanner);
    compare(*scanner.scan(), reference::RayCaster(list, rigid_inverse(to_matrix(pose))), desc.range_min_m,
            desc.range_max_m, 0, comparison);
  }
  check_cast(comparison);
  if (sanitized()) return test::skip(test::kNotSanitized);  // they cast an eighth of the rooms
  CHECK(comparison.median_error() <= kPublishedMedian);
  CHECK(ScanComparison::quantile(comparison.relative_errors, 1) <= kPublishedMaximum);
}

TEST_CASE("hybrid casts beams above its bound, and agrees with raycast within both bounds") {
  constexpr double kBound = 3e-4;
  Simulation hybrid = marvin({{"method", "hybrid"}, {"max_error_rel", "3e-4"}, {"samples", "2001"}});
  Simulation raycast = marvin({{"method", "raycast"}, {"samples", "2001"}});
  double worst = 0, share = 0;
  int scans = 0;
  for (int frame = 0; frame < 10; frame += kFewerFrames) {
    drive(hybrid, frame);
    drive(raycast, frame);
    CHECK(hybrid.diagnostics().counters().passes == 3);
    for (const char* name : kScanners) {
      const Scan &a = hybrid.scan(name), &b = raycast.scan(name);
      for (std::size_t beam = 0; beam < a.range_m.size(); ++beam) {
        const double range = b.range_m[beam], error = std::abs(a.range_m[beam] - range);
        REQUIRE(std::isfinite(range));
        CHECK(error <= static_cast<double>(a.error_bound_m[beam]) + static_cast<double>(b.error_bound_m[beam]));
        CHECK(a.error_bound_m[beam] <= kBound * a.range_m[beam]);
        worst = std::max(worst, error / range);
      }
      share += cast_share(hybrid, name);
      ++scans;
    }
  }
  MESSAGE("with bounds of up to " << kBound << " hybrid casts " << 100 * share / scans
                                  << " % of its beams, and departs from raycast by at most " << worst);
  CHECK(share > 0);
  // Depth from snapped corners has wider bounds, so that more beams are above the limit.
  if (raster_grid().depth_snap_px == 0) CHECK(share < 0.2 * scans);
}

TEST_CASE("hybrid leaves no beam uncertain: beside a silhouette in front of empty space, across a limit of the range") {
  constexpr double kBound = 1e-3;
  DrawList list;
  add_item(list, half_box_mesh({0.5, 40, 3}), glm::translate(glm::dmat4(1.0), {4.5, 0, 0}));  // at 8 m 60 degrees aside
  Device device;
  Renderer renderer(device);
  const auto scan = [&](LaserScannerDesc desc, ScanMethod method) {
    desc.method = method;
    desc.max_error_rel = kBound;
    LaserScanner scanner("S", desc);
    FramePlan plan;
    scanner.plan(glm::dmat4(1.0), list, plan);
    scanner.collect({}, plan, renderer.render(list, plan));
    const std::unique_ptr<RayCaster> caster = make_ray_caster(device);
    caster->set_world(list);
    scanner.cast(*caster);
    return *scanner.scan();
  };

  // The wall ends at (4, 40), at about 84.3 degrees. Beams are closer together than pixels, and none is at its edge.
  LaserScannerDesc around_edge;
  around_edge.pattern = {
      .beams = 200, .min_azimuth_rad = std::atan2(40, 4) - 0.001, .max_azimuth_rad = std::atan2(40, 4) + 0.001};
  LaserScannerDesc at_limit;
  at_limit.pattern = {.beams = 3, .min_azimuth_rad = -kPi / 3, .max_azimuth_rad = kPi / 3};
  at_limit.range_max_m = 8 + 1e-5;  // closer than a rendered bound, farther than a cast one
  for (const LaserScannerDesc& desc : {around_edge, at_limit}) {
    const Scan rendered = scan(desc, ScanMethod::planar), hybrid = scan(desc, ScanMethod::hybrid);
    const Scan cast = scan(desc, ScanMethod::raycast);
    CHECK(std::ranges::count(rendered.error_bound_m, kInfinity) > 0);
    for (std::size_t beam = 0; beam < hybrid.range_m.size(); ++beam) {
      CHECK(std::isfinite(hybrid.error_bound_m[beam]));
      CHECK(hybrid.error_bound_m[beam] <= kBound * hybrid.range_m[beam]);
      CHECK(std::isfinite(hybrid.range_m[beam]) == std::isfinite(cast.range_m[beam]));
    }
  }
}

TEST_CASE("hybrid by default: no rendered range has such a bound, so none is rendered") {
  Simulation hybrid = marvin({{"method", "hybrid"}}), raycast = marvin({{"method", "raycast"}});
  Simulation planar = marvin({{"method", "planar"}});
  for (Simulation* simulation : {&hybrid, &raycast, &planar}) drive(*simulation, 3);
  for (const char* name : kScanners) {
    CHECK(hybrid.scan(name).range_m == raycast.scan(name).range_m);
    CHECK(hybrid.scan(name).error_bound_m == raycast.scan(name).error_bound_m);
    const Scan& rendered = planar.scan(name);
    for (std::size_t beam = 0; beam < rendered.range_m.size(); ++beam) {
      REQUIRE(std::isfinite(rendered.range_m[beam]));
      CHECK(rendered.error_bound_m[beam] >= (min_planar_bound() - kHalfUlp) * rendered.range_m[beam]);
    }
  }
  CHECK(hybrid.diagnostics().counters().passes == 0);
  const std::string explained = explain(hybrid.diagnostics().frame_plan(), {hybrid.diagnostics().counters()});
  CHECK(contains(explained, "cast FRONT_SCANNER: up to 361 rays by " +
                                hybrid.diagnostics().frame_plan().casts[0].engine + ": every"));
  CHECK(!hybrid.diagnostics().frame_plan().casts[0].engine.empty());
}

TEST_CASE("scanners that do not cast cost nothing; others build each mesh once, and a moving robot only moves boxes") {
  Simulation planar = marvin({{"method", "planar"}}), raycast = marvin({{"method", "raycast"}});
  drive(planar, 0);
  CHECK(planar.diagnostics().ray_counters() == RayCounters{});
  CHECK(cast_share(planar, "FRONT_SCANNER") == -1);
  CHECK(json_of(planar).find("cast_share") == std::string::npos);
  CHECK(json_of(raycast).find("\"cast_share\": 0.0") != std::string::npos);

  drive(raycast, 0);
  const RayCounters first = raycast.diagnostics().ray_counters();
  CHECK(first.rays == 3 * 361);
  CHECK(first.meshes_built > 0);
  CHECK(first.item_trees_built == 1);
  const auto trees_of = [](const RayCounters& counters) {  // a device refits its tree where it can
    return counters.item_trees_built + counters.item_trees_refitted;
  };
  drive(raycast, 1);
  const RayCounters second = raycast.diagnostics().ray_counters();
  CHECK(second.meshes_built == first.meshes_built);
  CHECK(second.triangles_built == first.triangles_built);
  CHECK(trees_of(second) == 2);
  CHECK(second.items_placed > first.items_placed);
  CHECK(second.items_placed - first.items_placed < first.items_placed);  // the robot, not the laboratory
  raycast.step();
  CHECK(trees_of(raycast.diagnostics().ray_counters()) == 2);
}

TEST_CASE("two runs give the same bytes") {
  const auto with = [](const char* method) {
    if (method == std::string_view("raycast")) return marvin({{"method", method}});
    return marvin({{"method", method}, {"max_error_rel", "1e-4"}});
  };
  for (const char* method : {"hybrid", "raycast"}) {
    Simulation a = with(method), b = with(method);
    drive(a, 1);  // another frame before changes nothing
    drive(a, 5);
    drive(b, 5);
    for (const char* name : kScanners) {
      CHECK(a.scan(name).range_m == b.scan(name).range_m);
      CHECK(a.scan(name).error_bound_m == b.scan(name).error_bound_m);
    }
  }
}

TEST_CASE("the rasteriser and the ray caster pass the same beams through holes") {
  auto texture = std::make_shared<Texture>();
  texture->width = texture->height = 8;
  std::mt19937 random(3);
  for (int i = 0; i < 4 * 8 * 8; ++i) texture->rgba.push_back(static_cast<std::uint8_t>(random() % 256));
  texture->sampler.wrap_u = Wrap::mirrored_repeat;
  auto material = std::make_shared<Material>();
  material->alpha_mode = AlphaMode::mask;
  material->base_color_texture = texture;
  material->uv_transform = glm::mat3x2(0.8f, 0.1f, -0.1f, 1.7f, -0.3f, 0.2f);
  DrawList list;
  add_item(list, half_box_mesh({0.5, 40, 40}), glm::translate(glm::dmat4(1.0), {5.5, 0, 0}));
  Mesh curtain;
  curtain.positions = {{2, 1.5f, 1}, {2, -1.5f, 1}, {2, -1.5f, -1}, {2, 1.5f, -1}};
  curtain.indices = {0, 1, 2, 0, 2, 3};
  curtain.attributes.resize(4);
  const glm::vec2 uvs[] = {{0, 0}, {2, 0}, {2, 1}, {0, 1}};
  for (std::size_t i = 0; i < 4; ++i) {
    curtain.attributes[i].uv[0] = uvs[i];
    curtain.attributes[i].color.a = 0.9f + 0.03f * static_cast<float>(i);
  }
  add_item(list, curtain, glm::dmat4(1.0));
  list.materials.push_back(material);
  list.material_revision.push_back(0);
  list.items[1].material = 1;

  Device device;
  Renderer renderer(device);
  const std::unique_ptr<RayCaster> caster = make_ray_caster(device);
  caster->set_world(list);
  LaserScannerDesc desc;
  desc.pattern = {.beams = 1501, .min_azimuth_rad = -0.6, .max_azimuth_rad = 0.6};
  int met = 0, passed = 0, uncertain = 0;
  for (const double height_m : {-0.83, -0.31, 0.07, 0.44, 0.9}) {
    const glm::dmat4 pose = glm::translate(glm::dmat4(1.0), {0, 0, height_m});
    desc.method = ScanMethod::planar;
    LaserScanner rendered("R", desc);
    FramePlan plan;
    rendered.plan(pose, list, plan);
    rendered.collect({}, plan, renderer.render(list, plan));
    desc.method = ScanMethod::raycast;
    LaserScanner cast("C", desc);
    cast.plan(pose, list, plan);
    cast.collect({}, plan, {});
    cast.cast(*caster);
    for (std::size_t beam = 0; beam < cast.scan()->range_m.size(); ++beam) {
      const double range = cast.scan()->range_m[beam];
      uncertain += std::isinf(rendered.scan()->error_bound_m[beam]);
      ++(range * std::cos(cast.scan()->azimuth_rad[beam]) < 3 ? met : passed);
      CHECK(std::abs(rendered.scan()->range_m[beam] - range) <=
            static_cast<double>(rendered.scan()->error_bound_m[beam]) + cast.scan()->error_bound_m[beam]);
    }
  }
  CHECK(met > 1000);
  CHECK(passed > 1000);
  CHECK(uncertain < (met + passed) / 20);
}

TEST_CASE("limits along the ray: closer hits read 0, farther ones and misses inf") {
  DrawList list;
  add_item(list, half_box_mesh({0.5, 40, 3}), glm::translate(glm::dmat4(1.0), {4.5, 0, 0}));
  LaserScannerDesc desc;
  desc.pattern = {.beams = 3, .min_azimuth_rad = -kPi / 3, .max_azimuth_rad = kPi / 3};  // at 4 m; at 8 m beside
  desc.method = ScanMethod::raycast;
  desc.range_min_m = 5;
  desc.range_max_m = 9;
  LaserScanner within("S", desc);
  scan_once(list, glm::dmat4(1.0), within);
  CHECK(within.scan()->range_m[1] == 0);
  CHECK(within.scan()->range_m[0] == doctest::Approx(8).epsilon(1e-6));
  desc.range_max_m = 7;
  LaserScanner beyond("S", desc);
  scan_once(list, glm::dmat4(1.0), beyond);
  CHECK(beyond.scan()->range_m[0] == kInfinity);
  CHECK(beyond.scan()->error_bound_m[0] == 0);
  desc.pattern = {.beams = 1, .min_azimuth_rad = kPi, .max_azimuth_rad = kPi};
  LaserScanner away("S", desc);
  scan_once(list, glm::dmat4(1.0), away);
  CHECK(away.scan()->range_m[0] == kInfinity);
  CHECK(away.scan()->error_bound_m[0] == 0);
}

TEST_SUITE_END();
