// Ids over the time of a run, what truth costs where it is not asked for, and truth that a sensor cannot give.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include <simvis/camera_layout.h>
#include <simvis/diagnostics.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "sensors/camera/camera_views.h"
#include "sensors/camera/pixel_rays.h"
#include "tests/sensors/truth_scene.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

TEST_CASE("ids stay over frames, commands and other sensors") {
  Simulation simulation = truth_simulation(truth_camera("instance"));
  simulation.step();
  const std::vector<double> before = truth_numbers(simulation.measurement("CAM"), "instance");
  CHECK(std::set<double>(before.begin(), before.end()).size() == 6);  // five things and the sky
  simulation.execute("<part name='A' insert_at='ROOT' shape='sphere' radius='1' pose_offset='-9 0 0 0 0 0'/>");
  simulation.execute("<remove kind='part' name='A'/>");
  simulation.step();
  CHECK(truth_numbers(simulation.measurement("CAM"), "instance") == before);
  simulation.execute("<remove kind='element' name='L1'/><remove kind='part' name='BALL'/>");
  simulation.step();
  const std::vector<double> without = truth_numbers(simulation.measurement("CAM"), "instance");
  int revealed = 0;
  for (std::size_t i = 0; i < before.size(); ++i) revealed += without[i] != before[i];
  CHECK(revealed > 0);
  const std::set<double> now(without.begin(), without.end()), then(before.begin(), before.end());
  CHECK(std::ranges::includes(then, now));
  CHECK(now.size() == 5);
}

TEST_CASE("truth that is not asked for costs nothing, and labels alone change no byte") {
  const auto work = [](const std::string& commands) {
    Simulation simulation = Simulation::from_string("<simvis>" + commands + "</simvis>");
    simulation.step();
    simulation.step();
    const Diagnostics diagnostics = simulation.diagnostics();
    return std::tuple(diagnostics.counters(), diagnostics.ray_counters().rays, diagnostics.motions_followed(),
                      diagnostics.device_memory_bytes(), truth_numbers(simulation.measurement("CAM"), "color"));
  };
  std::string unlabelled = kTruthThings;
  for (std::size_t at = 0; (at = unlabelled.find("<element type=\"label\"")) != std::string::npos;) {
    unlabelled.erase(at, unlabelled.find("/>", at) + 2 - at);
  }
  CHECK(work(unlabelled + truth_camera("color depth")) == work(kTruthThings + truth_camera("color depth")));
  // Ranges come with depth from the pass of colour: no pass, no pixel and no ray more.
  const auto depth = work(kTruthThings + truth_camera("color depth")),
             range = work(kTruthThings + truth_camera("color depth range"));
  CHECK(depth == range);
  // Ids come from it too. Only the outlines of the round shapes are cast, as for depth.
  const auto ids = work(kTruthThings + truth_camera("color depth range instance semantic"));
  CHECK(std::get<0>(ids).passes == std::get<0>(depth).passes);
  CHECK(std::get<0>(ids).bytes_read_back == std::get<0>(depth).bytes_read_back);
  CHECK(std::get<1>(ids) == std::get<1>(depth));
  CHECK(std::get<1>(ids) > 0);
  CHECK(std::get<1>(ids) < kTruthWidth * kTruthHeight / 4);
  std::string flat = kTruthThings;
  for (const char* const name : {"BALL", "ROD"}) {
    const std::size_t at = flat.find("<part name=\"" + std::string(name));
    flat.erase(at, flat.find("/>", at) + 2 - at);
  }
  flat.erase(flat.find("<element type=\"label\" name=\"L1\""));
  for (const char* const outputs : {"color depth", "color depth range instance semantic"}) {
    CHECK(std::get<1>(work(flat + truth_camera(outputs))) == 0);
  }
}

TEST_CASE("rows at other times share one copy of the list") {
  Simulation simulation = truth_simulation(truth_camera("instance"));
  simulation.step();
  const DrawList list = simulation.diagnostics().draw_list();
  glm::dmat4 world_from_sensor;
  simulation.sensor_pose("CAM", world_from_sensor);
  const glm::dmat4 world_from_view = world_from_sensor * sensor_from_view();
  const CameraLayout layout{.width_px = kTruthWidth,
                            .height_px = kTruthHeight,
                            .pinhole = centred_pinhole(kTruthWidth, kTruthHeight, 70 * std::numbers::pi / 180)};
  const CameraViews views = camera_views(layout, 1);
  PixelRays rays(layout, views, 0.05);
  const std::unique_ptr<RayCaster> caster = make_host_ray_caster();
  caster->set_world(list);
  std::vector<SeenSurface> seen(std::size_t{kTruthWidth} * kTruthHeight), reference = seen;
  for (int image = 1; image <= 2; ++image) {
    rays.begin(list);
    for (std::uint32_t first = 0; first < kTruthHeight; first += 12) {
      const ItemPlace place{0, glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, -0.7 + 0.001 * first * image))};
      const PixelRows rows{.first = first, .count = 12, .world_from_view = world_from_view, .places = {&place, 1}};
      rays.cast(*caster, rows, seen);
      PixelRays alone(layout, views, 0.05);
      alone.begin(list);
      alone.cast(*caster, rows, reference);
    }
    CHECK(rays.lists_copied() == static_cast<std::uint64_t>(image));
  }
  int met = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    CHECK(seen[i].range_m == reference[i].range_m);
    CHECK(seen[i].item == reference[i].item);
    met += seen[i].item == 0;
  }
  CHECK(met > 100);
}

TEST_CASE("truth that a sensor cannot give is an error at its place") {
  const auto error = [](const std::string& command) {
    return error_of(
        [&] { Simulation::from_string("<simvis>" + kTruthThings + "\n" + command + "</simvis>", {}, ".", "s"); });
  };
  CHECK(contains(error("<sensor type='camera' name='C' insert_at='CAR' view='visualization' outputs='instance'/>"),
                 ": error: attribute \"outputs\": a camera that sees what is drawn for people only gives color and "
                 "depth"));
  CHECK(contains(error("<sensor type='camera' name='C' insert_at='CAR' outputs='color depth_error_bound'/>"),
                 ": error: attribute \"outputs\": depth_error_bound needs depth, expected both"));
  CHECK(contains(error("<sensor type='camera' name='C' insert_at='CAR' outputs='instances'/>"), "instance"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
