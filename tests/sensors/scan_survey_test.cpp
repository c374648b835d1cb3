// When a scanner with method="auto" surveys the methods again.
#include <doctest/doctest.h>

#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include <simvis/device.h>
#include <simvis/pose.h>
#include "engine/render/renderer.h"
#include "sensors/laser_scanner/method_survey.h"
#include "tests/sensors/auto_scan.h"
#include "tests/support/random_room.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;
using namespace simvis::test;

namespace fs = std::filesystem;

TEST_CASE("methods are surveyed again when the scene grows, but not when the scanner moves a little") {
  const TemporaryFolder folder;
  const CostsFolder cache(made_up_costs(true));
  const fs::path scene = write_wall_scene(folder.path(), R"(
    <element type="pose" name="MOVE" insert_at="ROOT"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" method="auto" max_error_m="0.01" samples="91"/>)");
  SimulationDesc desc;
  desc.device.cache_dir = cache.folder.path().string();
  Simulation simulation = Simulation::load(scene, desc);
  const auto surveys = [&] { return noted(sensor(simulation, "SCAN").report, "surveys"); };
  for (int frame = 0; frame < 4; ++frame) {
    simulation.set("MOVE", "x", 0.01 * frame);
    simulation.set("MOVE", "yaw", 0.1 * frame);
    simulation.step();
    CHECK(surveys() == "1");
    CHECK(simulation.diagnostics().counters().passes == (frame == 0 ? std::size(kPlanarResolutions) : 1));
  }
  std::string more;
  for (int i = 1; i < 10; ++i) {
    more += "<part file=\"wall.gltf\" name=\"WALL" + std::to_string(i) + "\" insert_at=\"ROOT\" pose_offset=\"" +
            std::to_string(i) + " 0 0 0 0 0\"/>";
  }
  simulation.execute(more, folder.path());
  simulation.step();
  CHECK(surveys() == "2");
  simulation.step();
  CHECK(surveys() == "2");
}

TEST_CASE("methods are surveyed again when the cost of the chosen one changes, less often while the choice stays") {
  const std::vector<double> none;
  MethodSurvey survey({.beams = 2}, std::vector<double>{512});
  CostModel cost;
  cost[CostTerm::beam] = 1;
  MethodSelector choice;
  DrawList list;
  const std::vector<BeamReading> readings(2);
  CHECK(choice.is_due(list));
  survey.choose(readings, cost);
  choice.take(survey, {});
  CostModel work;  // that of the survey: nothing was collected, so all of it costs nothing
  CHECK_FALSE(choice.is_due(list));
  choice.measured(work, cost);
  CHECK_FALSE(choice.is_due(list));
  work[CostTerm::beam] = 3;
  int waited = 0;
  std::vector<int> waits;
  while (waits.size() < 4) {
    choice.measured(work, cost);
    ++waited;
    if (!choice.is_due(list)) continue;
    choice.take(survey, {});  // chooses the same method
    waits.push_back(waited);
    waited = 0;
    CHECK_FALSE(choice.is_due(list));
  }
  CHECK(waits == std::vector<int>{1, 2, 3, 5});
}

TEST_CASE("methods are surveyed again only if another one may have become the cheapest") {
  const DrawList list = random_room(3, 20, 12);
  LaserScannerDesc desc;
  desc.pattern = {.beams = 181, .min_azimuth_rad = -1, .max_azimuth_rad = 1};
  desc.method = ScanMethod::automatic;
  desc.max_error_rel = 1e-4;
  CostModel cost;
  cost[CostTerm::pass] = 1e15;  // much more expensive than casting: items are never tested that often
  cost[CostTerm::item_test] = 1;
  LaserScanner scanner("S", desc);
  scanner.use_cost_model([&]() -> const CostModel& { return cost; });
  // From the centre of the room to far outside, where the room appears narrow: the cost of casting, which is the tests
  // of items, varies.
  for (const double x_m : {0.0, -60.0, 0.0, -60.0, 0.0, -60.0}) {
    measure(scanner, list, to_matrix({{x_m, 0, 1.2}, 0, 0, 0}));
    CHECK(noted(scanner.report(), "chosen") == "raycast");
  }
  CHECK(noted(scanner.report(), "surveys") == "1");
}

namespace {

/// A caster of which every ray to the left costs one test of an item, and every other ray none.
class LeftCounter : public RayCaster {
 public:
  void set_world(const DrawList&) override {}
  void ignore(std::span<const std::uint32_t>) override {}
  void cast(const glm::dmat4&, std::span<const glm::dvec3> directions, std::span<RayHit> hits, std::span<const double>,
            const HitsReady&, HitSides) override {
    for (std::size_t i = 0; i < directions.size(); ++i) {
      counters_.item_tests += directions[i].y > 0;
      hits[i].range_m = 2 + directions[i].y;
    }
  }
  void cast_from(const glm::dmat4&, std::span<const glm::dvec3>, std::span<const glm::dvec3>, std::span<RayHit>,
                 std::span<const double>) override {}
  RayCounters counters() const override { return counters_; }
  std::string_view engine() const override { return "left counter"; }

 private:
  RayCounters counters_;
};

}  // namespace

TEST_CASE("a survey prices the beams that a method casts, in whatever order they are cast") {
  // Beams to the right see a wall, which every resolution renders well enough; to the left there is a box, whose edges
  // are to be cast.
  Simulation scene = Simulation::from_string(
      "<s><part shape='box' size='0.2 40 40' name='WALL' insert_at='ROOT' pose_offset='6 0 0 0 0 0'/>"
      "<part shape='box' size='0.4 0.4 0.4' name='BOX' insert_at='ROOT' pose_offset='3 1.2 0 0 0 0'/></s>");
  const DrawList& list = scene.diagnostics().draw_list();
  constexpr ScanPattern kPattern{.beams = 101,
                                 .rings = 9,
                                 .min_azimuth_rad = -0.7,
                                 .max_azimuth_rad = 0.7,
                                 .min_elevation_rad = -0.2,
                                 .max_elevation_rad = 0.2};
  const double resolutions_px[] = {256, 512};
  Device device;
  Renderer renderer(device);
  std::vector<std::uint32_t> rows(kPattern.beams * kPattern.rings), backwards;
  std::iota(rows.begin(), rows.end(), 0);
  backwards.assign(rows.rbegin(), rows.rend());
  std::vector<std::vector<double>> costs;
  for (const std::vector<std::uint32_t>& order : {rows, backwards}) {
    MethodSurvey survey(kPattern, resolutions_px);
    FramePlan plan;
    survey.plan("S", glm::dmat4(1), plan);
    survey.collect(plan, renderer.render(list, plan), list.items.size(), VertexRounding(list, glm::dmat4(1)),
                   {0.01, 100}, {.max_error_rel = 1e-3});
    const std::vector<double> azimuth = azimuths(kPattern), elevation = elevations(kPattern);
    std::vector<glm::dvec3> directions;
    for (const std::uint32_t beam : order) {
      directions.push_back(beam_direction(azimuth[beam % kPattern.beams], elevation[beam / kPattern.beams]));
    }
    std::vector<RayHit> hits(order.size());
    LeftCounter caster;
    survey.cast(caster, list.items.size(), glm::dmat4(1), order, directions, hits);
    for (std::size_t i = 0; i < order.size(); ++i) REQUIRE(hits[i].range_m == 2 + directions[i].y);
    std::vector<double>& found = costs.emplace_back();
    for (const ScanCandidate& candidate : survey.candidates()) {
      found.push_back(static_cast<double>(candidate.beams_cast));
      found.push_back(candidate.work[CostTerm::item_test]);
    }
    CHECK(survey.candidates()[0].work[CostTerm::item_test] > 0);
    CHECK(survey.candidates()[0].beams_cast < order.size());
  }
  CHECK(costs[0] == costs[1]);
}

TEST_SUITE_END();
