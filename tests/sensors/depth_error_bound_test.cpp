// The bound on the depths of an image compared with a double-precision ray cast at the pixels' centres.
#include "sensors/camera/depth_error_bound.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "engine/render/renderer.h"
#include "program/report/run_report.h"
#include "sensors/camera/camera.h"
#include "tests/support/error_of.h"
#include "tests/support/measured_images.h"
#include "tests/support/random_room.h"
#include "tests/support/raster_grid.h"
#include "tests/support/reference_raycast.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

// The reference is about twenty times slower under sanitizers.
const int kFewerRows = sanitized() ? 16 : 1;

// A corner is snapped to the rasteriser's grid, 1/256 pixel with lavapipe, by up to half of that in x and in y, and an
// edge moves with it. Rounding of its position in the image adds the same amount.
double pixel_snap_px() { return raster_grid().snap_px; }
// Two ranges on one plane agree within their rounding in double.
constexpr double kSamePlane = 1e-9;

struct Comparison {
  std::size_t pixels = 0;      // with a finite depth
  std::size_t violations = 0;  // beyond a bound that covers them
  std::size_t on_edge = 0;     // beyond the bound of the surface at the centre, within that of an adjacent one
  std::size_t narrow = 0;      // beyond the bound, on a surface less than three pixels wide or high
  std::vector<double> uses;    // for each image, the largest error within the bound over the bound
  std::vector<double> bounds_m;
};

glm::dvec3 direction(const Pinhole& k, double u, double v) {
  return glm::normalize(glm::dvec3((u - k.cx_px) / k.fx_px, (v - k.cy_px) / k.fy_px, 1));
}

double true_depth(const reference::RayCaster& truth, const Pinhole& k, double u, double v) {
  const glm::dvec3 d = direction(k, u, v);
  return truth.cast(d).range_m * d.z;
}

// Whether the surface hit at (u, v) is flat over less than three pixels of its row or its column, in quarters of a
// pixel.
bool is_narrow(const reference::RayCaster& truth, const Pinhole& k, double u, double v) {
  const reference::Hit hit = truth.cast(direction(k, u, v));
  if (!std::isfinite(hit.range_m)) return false;
  for (const glm::dvec2 axis : {glm::dvec2(1, 0), glm::dvec2(0, 1)}) {
    int quarters = 0;
    for (const int side : {-1, 1}) {
      for (int q = 1; q <= 12; ++q, ++quarters) {
        const glm::dvec3 d = direction(k, u + side * q * axis.x / 4, v + side * q * axis.y / 4);
        const double expected = truth.range_of_plane(hit.triangle, d);
        if (!(std::abs(truth.cast(d).range_m - expected) <= kSamePlane * std::abs(expected))) break;
      }
    }
    if (quarters < 12) return true;
  }
  return false;
}

bool met_beside(const reference::RayCaster& truth, const Pinhole& k, double u, double v, double depth_m,
                double bound_m) {
  const double snap_px = pixel_snap_px();
  for (const double du : {-snap_px, 0.0, snap_px}) {
    for (const double dv : {-snap_px, 0.0, snap_px}) {
      if (std::abs(true_depth(truth, k, u + du, v + dv) - depth_m) <= bound_m) return true;
    }
  }
  return false;
}

void compare(const Image& depth, double bound_m, const Pinhole& k, const reference::RayCaster& truth,
             Comparison& result) {
  double worst = 0;
  for (std::uint32_t y = 0; y < depth.height; y += kFewerRows) {
    for (std::uint32_t x = 0; x < depth.width; ++x) {
      const double seen = depth.pixels[std::size_t{y} * depth.width + x];
      if (!std::isfinite(seen)) continue;
      ++result.pixels;
      const double u = x + 0.5, v = y + 0.5, error = std::abs(seen - true_depth(truth, k, u, v));
      if (error <= bound_m) {
        worst = std::max(worst, error);
      } else if (met_beside(truth, k, u, v, seen, bound_m)) {
        ++result.on_edge;
      } else {
        ++(is_narrow(truth, k, u, v) ? result.narrow : result.violations);
      }
    }
  }
  result.uses.push_back(worst / bound_m);
  result.bounds_m.push_back(bound_m);
}

void check(Comparison& c) {
  std::ranges::sort(c.uses);
  std::ranges::sort(c.bounds_m);
  MESSAGE(c.pixels << " pixels in " << c.uses.size() << " images: violations " << c.violations << ", beside an edge "
                   << c.on_edge << ", on narrow surfaces " << c.narrow << "; bound " << c.bounds_m.front() << " to "
                   << c.bounds_m.back() << " m; largest error over bound: median " << c.uses[c.uses.size() / 2]
                   << ", at most " << c.uses.back());
  CHECK(c.violations == 0);
  CHECK(c.narrow < c.pixels / 10000);
  // An image of several hundred edges, each within 1/256 pixel of every 128th centre along it, or within another step
  // of the grid of as many more.
  CHECK(static_cast<double>(c.on_edge) < 256 * pixel_snap_px() * static_cast<double>(c.pixels) / 1000);
}

}  // namespace

TEST_CASE("random rooms: 460,000 pixels") {
  Device device;
  Renderer renderer(device);
  Comparison comparison;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int room = 0; room < 6; ++room) {
    DrawList list = random_room(static_cast<std::uint32_t>(40 + room), 60, 24);
    Material both_sides;  // a camera sees the room's box from within
    both_sides.double_sided = true;
    list.materials[0] = std::make_shared<Material>(both_sides);
    Pose pose;
    pose.position_m = {0.3 * unit(random), 0.3 * unit(random), 1 + 0.5 * unit(random)};
    pose.roll_rad = 0.5 * unit(random);
    pose.pitch_rad = 0.5 * unit(random);
    pose.yaw_rad = 3 * unit(random);
    const CameraDesc desc{.pinhole = {.width_px = 320,
                                      .height_px = 240,
                                      .hfov_rad = glm::radians(75 + 45 * unit(random)),
                                      .near_m = room % 2 == 0 ? 0.05 : 0.005},
                          .color = false,
                          .depth = true};
    Camera camera("C", desc);
    FramePlan plan;
    camera.plan(to_matrix(pose), list, plan);
    camera.collect({}, plan, renderer.render(list, plan));
    const View& view = plan.passes[0].views[0];
    compare(depth_of(camera), requested(camera, "depth_error_bound_m"), view.pinhole,
            reference::RayCaster(list, view.view_from_world), comparison);
  }
  check(comparison);
}

TEST_CASE("the marvin laboratory while the robot turns: 610,000 pixels") {
  SimulationDesc desc;
  desc.overrides = {{"camera", "outputs", "depth", "this test"}};
  Simulation simulation = Simulation::load(std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/marvin/marvin.xml", desc);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.name == "ROBOT_CAM");
  Comparison comparison;
  for (int frame = 0; frame < 2; ++frame) {
    simulation.set("R_POSE", "yaw", 120.0 * frame);
    simulation.step();
    const View& view = simulation.diagnostics().frame_plan().passes[0].views[0];
    compare(simulation.depth("ROBOT_CAM"), simulation.value("ROBOT_CAM", kDepthErrorBound), view.pinhole,
            reference::RayCaster(simulation.diagnostics().draw_list(), view.view_from_world), comparison);
  }
  check(comparison);
}

TEST_CASE("a wall that faces the camera: the bound follows from its distance alone") {
  TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), R"(
    <sensor type="camera" name="DEPTH" insert_at="ROOT" width="64" height="48" outputs="color depth" msaa="4"/>
    <sensor type="camera" name="FAR" insert_at="ROOT" width="8" height="8" outputs="depth" pose_offset="0 0 0 0 0 180"/>
    <sensor type="stereo_camera" name="EYES" insert_at="ROOT" width="64" height="48" outputs="depth"/>
    <sensor type="camera" name="COLOR" insert_at="ROOT" width="64" height="48"/>)"));
  CHECK(std::isnan(simulation.value("DEPTH", kDepthErrorBound)));
  simulation.step();
  const double bound_m = simulation.value("DEPTH", kDepthErrorBound);
  // At least one rounding of 4 m. At most: corners at sqrt(4^2 + 2 * 10^2) = 14.7 m, displaced by 27 roundings of their
  // distance and of the mesh's size (VertexRounding), and 18 roundings of w = 1/4 m in the setup of the plane. The
  // slope that rounding alone creates adds a tenth.
  constexpr double kDistance_m = 4, kCorner_m = 14.7;
  CHECK(bound_m >= kDistance_m * 0x1p-24);
  CHECK(bound_m <= 1.1 * (27 * 2 * kCorner_m + 18 * kDistance_m) * 0x1p-24);
  for (const float z : simulation.depth("DEPTH").pixels) CHECK(std::abs(z - kDistance_m) <= bound_m);
  CHECK(simulation.value("EYES", kDepthErrorBound) >= kDistance_m * 0x1p-24);
  CHECK(simulation.value("FAR", kDepthErrorBound) == 0);  // nothing is seen
  CHECK(contains(error_of([&] { simulation.value("COLOR", kDepthErrorBound); }), "has no value"));
  CHECK_FALSE(simulation.find_value("COLOR", kDepthErrorBound));

  RunReport report;
  report.sensors = with_bounds(simulation);
  report.sensors[1].depth_error_bound_m = std::numeric_limits<double>::infinity();
  const auto sensors = nlohmann::json::parse(to_json(report))["sensors"];
  CHECK(sensors["DEPTH"]["depth_error_bound_m"] == bound_m);
  CHECK(sensors["FAR"]["depth_error_bound_m"].is_null());
  CHECK_FALSE(sensors["COLOR"].contains("depth_error_bound_m"));
}

TEST_CASE("the bound is that of the measurement, also when the scene has changed and when there is none any more") {
  constexpr int kBoxes = 160;  // more than those for which the roundings at all ranges are computed at once
  std::string scene = "<s><element type='pose' name='P' insert_at='ROOT'/>";
  for (int i = 0; i < kBoxes; ++i) {
    scene += "<part name='B" + std::to_string(i) + "' shape='box' size='0.2 0.2 0.2' insert_at='ROOT' pose_offset='" +
             std::to_string(2 + 0.25 * (i / 16)) + " " + std::to_string(0.3 * (i % 16) - 2.3) + " 0 0 0 0'/>";
  }
  scene +=
      "<sensor type='camera' name='CAM' insert_at='ROOT' width='32' height='24' outputs='depth' rate='1'/>"
      "<sensor type='stereo_camera' name='EYES' insert_at='ROOT' width='32' height='24' outputs='depth' rate='1'/></s>";
  std::optional<Simulation> simulation(Simulation::from_string(scene));
  simulation->step();
  Simulation same = Simulation::from_string(scene);
  same.step();
  for (const char* camera : {"CAM", "EYES"}) {
    CAPTURE(camera);
    const double bound_m = same.value(camera, kDepthErrorBound);
    CHECK(bound_m > 0);
    CHECK(std::isfinite(bound_m));
  }
  const Measurement measured = simulation->measurement("CAM");
  simulation->set("P", "x", 1);
  simulation->execute("<part name='MORE' shape='box' size='0.2 0.2 0.2' insert_at='ROOT' pose_offset='4 0 0 0 0 0'/>");
  simulation->step();
  REQUIRE(simulation->measured().empty());
  for (const char* camera : {"CAM", "EYES"}) {
    CHECK(simulation->value(camera, kDepthErrorBound) == same.value(camera, kDepthErrorBound));
  }
  simulation.reset();
  CHECK(measured.value(kDepthErrorBound) == same.value("CAM", kDepthErrorBound));
}

TEST_SUITE_END();
