// method="auto": what it chooses, what its scans keep, when it looks again; and the costs that it chooses by.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include <simvis/cost_model.h>
#include <simvis/device.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "engine/base/cache_file.h"
#include "engine/render/renderer.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "sensors/laser_scanner/scan_calibration.h"
#include "simvis/report/run_report.h"
#include "tests/support/error_of.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"
#include "tests/support/run_process.h"
#include "tests/support/scan_truth.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

namespace fs = std::filesystem;
const fs::path kMarvin = fs::path(SIMVIS_SOURCE_DIR) / "scenes/marvin/marvin.xml";
constexpr const char* kScanners[] = {"FRONT_SCANNER", "REAR_SCANNER", "TILT_SCANNER"};

// Sanitizers make the reference some twenty times slower.
const std::uint32_t kFewer = sanitized() ? 8 : 1;

/// Costs where rendering, or casting, is almost for nothing.
CostModel made_up_costs(bool cheap_to_render) {
  CostModel cost;
  for (std::size_t i = 0; i < kCostTerms; ++i) {
    const bool casting = i >= static_cast<std::size_t>(CostTerm::cast);
    cost.of[i] = casting == cheap_to_render ? 1000 : 0.001;
  }
  return cost;
}

struct Machine {
  Device device;
  Renderer renderer{device};
  std::unique_ptr<RayCaster> caster = make_ray_caster(device);
};

Machine& machine() {
  static Machine machine;
  return machine;
}

/// A folder whose cache says that this device has these costs.
struct CostsFolder {
  explicit CostsFolder(const CostModel& cost) : file(cost_model_file(machine().device, folder.path(), version())) {
    save_cost_model(file, cost);
  }
  TemporaryFolder folder;
  fs::path file;
};

void measure(LaserScanner& scanner, const DrawList& list, const glm::dmat4& world_from_sensor = glm::dmat4(1.0)) {
  FramePlan plan;
  scanner.plan(world_from_sensor, list, plan);
  scanner.collect({}, plan, machine().renderer.render(list, plan));
  machine().caster->set_world(list);
  scanner.cast(*machine().caster);
}

LaserScanner make_scanner(const LaserScannerDesc& desc, bool cheap_to_render) {
  const CostModel cost = made_up_costs(cheap_to_render);
  LaserScanner scanner("S", desc);
  scanner.use_cost_model([&]() -> const CostModel& { return cost; });
  return scanner;
}

std::string noted(const SensorReport& report, std::string_view name) {
  for (const SensorNote& note : report.notes) {
    if (note.name != name) continue;
    if (const auto* text = std::get_if<std::string>(&note.value)) return *text;
    if (const auto* whole = std::get_if<std::uint64_t>(&note.value)) return std::to_string(*whole);
    return std::to_string(std::get<double>(note.value));
  }
  return "";
}

/// Every bound meets the tolerance, and the truth lies within every bound.
void check_kept(const LaserScanner& scanner, const LaserScannerDesc& desc, const DrawList& list,
                const glm::dmat4& world_from_sensor) {
  const Scan& scan = *scanner.scan();
  for (std::size_t beam = 0; beam < scan.range_m.size(); ++beam) {
    const double range = scan.range_m[beam], bound = scan.error_bound_m[beam];
    CHECK((bound == 0 || (bound <= desc.max_error_m.value_or(1e9) && bound <= desc.max_error_rel * range)));
  }
  ScanComparison comparison;
  const std::string chosen = noted(scanner.report(), "chosen");
  const double pixel_rad = chosen == "raycast" ? 0 : 2 / std::stod(chosen.substr(chosen.find(' ')));
  compare(scan, reference::RayCaster(list, rigid_inverse(world_from_sensor)), desc.range_min_m, desc.range_max_m,
          pixel_rad, comparison);
  CHECK(comparison.violations == 0);
  CHECK(comparison.uncertain == 0);
}

Simulation marvin(const fs::path& cache, const std::vector<std::pair<std::string, std::string>>& attributes) {
  SimulationDesc desc;
  desc.device.cache_dir = cache.string();
  for (const auto& [name, value] : attributes) desc.overrides.push_back({"laser_scanner", name, value, "this test"});
  Simulation simulation = Simulation::load(kMarvin, desc);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.type == "laser_scanner");
  return simulation;
}

SensorInfo sensor(const Simulation& simulation, std::string_view name) {
  for (const SensorInfo& each : simulation.sensors()) {
    if (each.name == name) return each;
  }
  return {};
}

std::string chosen(const Simulation& simulation, std::string_view name) {
  return noted(sensor(simulation, name).report, "chosen");
}

}  // namespace

TEST_CASE("every beam keeps the tolerance, whatever is chosen") {
  struct Tolerance {
    std::optional<double> max_error_m;
    double max_error_rel;
  };
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const DrawList list = random_room(7, 60, 24);
  Pose pose;
  pose.position_m = {0.3, -0.2, 1.2};
  pose.yaw_rad = 0.7;
  for (const Tolerance& tolerance : {Tolerance{0.01, kNone}, Tolerance{1e-4, kNone}, Tolerance{{}, 1e-4},
                                     Tolerance{1e-3, 2e-4}, Tolerance{{}, 1e-6}}) {
    for (const std::uint32_t rings : {1u, 16u}) {
      for (const bool cheap_to_render : {false, true}) {
        LaserScannerDesc desc;
        desc.pattern = {.beams = rings == 1 ? 1441 / kFewer : 90 / kFewer,
                        .rings = rings,
                        .min_azimuth_rad = -kPi,
                        .max_azimuth_rad = kPi};
        if (rings > 1) desc.pattern.min_elevation_rad = -kPi / 8, desc.pattern.max_elevation_rad = kPi / 8;
        desc.method = ScanMethod::automatic;
        desc.max_error_m = tolerance.max_error_m;
        desc.max_error_rel = tolerance.max_error_rel;
        LaserScanner scanner = make_scanner(desc, cheap_to_render);
        CAPTURE(rings);
        measure(scanner, list, to_matrix(pose));  // surveys
        CHECK(scanner.cast_share() == 1);
        check_kept(scanner, desc, list, to_matrix(pose));
        measure(scanner, list, to_matrix(pose));
        check_kept(scanner, desc, list, to_matrix(pose));
        const bool renders = cheap_to_render && desc.max_error_rel >= min_planar_bound();
        CHECK(noted(scanner.report(), "chosen").starts_with(renders ? "hybrid" : "raycast"));
        CHECK((*scanner.cast_share() < 1) == renders);
      }
    }
  }
  CHECK(machine().device.validation_messages() == 0);
}

TEST_CASE("in the marvin laboratory, too, while the robot drives") {
  const CostsFolder cache(made_up_costs(true));
  for (const char* attribute : {"max_error_m", "max_error_rel"}) {
    Simulation simulation = marvin(cache.folder.path(), {{"method", "auto"}, {attribute, "3e-4"}, {"samples", "721"}});
    ScanComparison comparison;
    for (int frame = 0; frame < 3; ++frame) {
      simulation.set("R_POSE", "yaw", 18.0 * frame);
      simulation.step();
      for (const char* name : kScanners) {
        glm::dmat4 world_from_sensor(1.0);
        REQUIRE(simulation.sensor_pose(name, world_from_sensor));
        const Scan& scan = simulation.scan(name);
        for (std::size_t beam = 0; beam < scan.range_m.size(); ++beam) {
          const bool absolute = attribute == std::string("max_error_m");
          CHECK(scan.error_bound_m[beam] <= 3e-4 * (absolute ? 1 : static_cast<double>(scan.range_m[beam])));
        }
        compare(scan, reference::RayCaster(simulation.diagnostics().draw_list(), rigid_inverse(world_from_sensor)),
                0.05, 80, 2.0 / 512, comparison);
        CHECK(chosen(simulation, name).starts_with("hybrid"));
      }
    }
    CHECK(comparison.violations == 0);
  }
}

TEST_CASE("a loose tolerance where there are no edges casts nothing: that is planar") {
  DrawList list;
  add_item(list, box_mesh({20, 20, 20}), glm::dmat4(1.0));
  LaserScannerDesc desc;
  desc.pattern = {.beams = 361, .min_azimuth_rad = -kPi / 6, .max_azimuth_rad = kPi / 6};  // to one wall
  desc.method = ScanMethod::automatic;
  desc.max_error_m = 0.05;
  desc.max_error_rel = std::numeric_limits<double>::infinity();
  LaserScanner scanner = make_scanner(desc, true);
  measure(scanner, list);
  const RayCounters surveyed = machine().caster->counters();
  measure(scanner, list);
  CHECK(machine().caster->counters() == surveyed);
  CHECK(scanner.cast_share() == 0);
  CHECK(noted(scanner.report(), "chosen") == "hybrid 512");
  CHECK(contains(scanner.report().explanation, "  * hybrid 512: "));
  CHECK(contains(scanner.report().explanation, ", 0 beams cast, "));
  CHECK(contains(scanner.report().explanation, "    raycast: "));
}

TEST_CASE("the choice follows the costs, and the plan says what and why") {
  const DrawList list = random_room(3, 20, 12);
  const glm::dmat4 pose = to_matrix({{0, 0, 1.2}, 0, 0, 0});  // its floor is at 0: no beam runs along an edge
  LaserScannerDesc desc;
  desc.pattern = {.beams = 181, .min_azimuth_rad = -1, .max_azimuth_rad = 1};
  desc.method = ScanMethod::automatic;
  desc.max_error_m = 0.01;
  desc.max_error_rel = std::numeric_limits<double>::infinity();
  for (const bool cheap_to_render : {true, false}) {
    LaserScanner scanner = make_scanner(desc, cheap_to_render);
    FramePlan survey, plan;
    scanner.plan(pose, list, survey);
    CHECK(survey.passes.size() == std::size(kPlanarResolutions));
    measure(scanner, list, pose);
    scanner.plan(pose, list, plan);
    REQUIRE(plan.casts.size() == 1);
    CHECK(plan.passes.size() == (cheap_to_render ? 1 : 0));
    CHECK(contains(plan.casts[0].reason, "by " + noted(scanner.report(), "chosen") + ", the cheapest way"));
    CHECK(contains(noted(scanner.report(), "chosen_because"), "0.01 m"));
  }
  desc.resolution_px = 700;
  LaserScanner given = make_scanner(desc, true);
  measure(given, list, pose);
  CHECK(noted(given.report(), "chosen") == "hybrid 700");
}

TEST_CASE("a tolerance that nothing meets names the best that can be reached") {
  struct Case {
    ScanMethod method;
    std::uint32_t rings;  // of many, no thread reads all
  };
  for (const auto& [method, rings] : {Case{ScanMethod::automatic, 1}, Case{ScanMethod::hybrid, 1},
                                      Case{ScanMethod::automatic, 64}, Case{ScanMethod::hybrid, 64}}) {
    LaserScannerDesc desc;
    desc.pattern = {.beams = 31, .rings = rings, .min_azimuth_rad = -0.5, .max_azimuth_rad = 0.5};
    if (rings > 1) desc.pattern.max_elevation_rad = 0.5;
    desc.method = method;
    desc.max_error_m = 2e-7;  // half an ulp of a float from 2 to 4 m is 1.2e-7, and from 4 to 8 m 2.4e-7
    desc.max_error_rel = std::numeric_limits<double>::infinity();
    desc.where_max_error_m = {.file = "scene.xml", .line = 3, .column = 14};
    DrawList near, far;
    add_item(near, box_mesh({3, 3, 3}), glm::dmat4(1.0));
    add_item(far, box_mesh({5, 5, 5}), glm::dmat4(1.0));
    LaserScanner scanner = make_scanner(desc, true);
    measure(scanner, near);
    const Scan before = *scanner.scan();
    far.revisions.structure = 7;
    const std::string message = error_of([&] { measure(scanner, far); });
    CHECK(contains(message, "scene.xml:3:14: error: attribute \"max_error_m\": 2e-07 is met by no method"));
    CHECK(contains(message, "sensor \"S\""));
    CHECK(scanner.scan()->range_m == before.range_m);  // whole, as it was
    CHECK(scanner.scan()->error_bound_m == before.error_bound_m);
    const std::string best = " with every beam cast, is ";
    REQUIRE(contains(message, best));
    desc.max_error_m = std::stod(message.substr(message.find(best) + best.size()));
    CHECK(*desc.max_error_m < 3e-7);
    LaserScanner relaxed = make_scanner(desc, true);
    measure(relaxed, far);
    CHECK(relaxed.scan()->range_m.size() == 31 * rings);
    measure(scanner, near);  // and the first goes on where it can
  }
}

TEST_CASE("an unreachable tolerance of a scene: the place, no frame, and it can be tried again") {
  for (const char* method : {"auto", "hybrid"}) {
    Simulation simulation = marvin({}, {{"method", method}, {"max_error_rel", "5e-8"}});
    const std::string message = error_of([&] { simulation.step(); });
    CHECK(contains(message, "this test: error: attribute \"max_error_rel\": 5e-08 is met by no method for sensor \""));
    CHECK(contains(message, " of the range"));
    CHECK(simulation.measured().empty());
    CHECK(simulation.next_frame().index == 0);
    CHECK(sensor(simulation, "FRONT_SCANNER").frames == 0);
  }
}

TEST_CASE("it looks again when the scene grows, and not when the scanner moves a little") {
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

TEST_CASE("when the chosen way's cost moves it looks again, the rarer the less that changes") {
  const std::vector<double> none;
  MethodSurvey survey({.beams = 2}, std::vector<double>{512});
  CostModel cost;
  cost[CostTerm::beam] = 1;
  MethodSelector choice;
  DrawList list;
  const std::vector<Reading> readings(2);
  CHECK(choice.is_due(list));
  survey.choose(readings, cost);
  choice.take(survey, {});
  CostModel work;  // the survey's own: nothing was collected, so all of it costs nothing
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
    choice.take(survey, {});  // chooses the same
    waits.push_back(waited);
    waited = 0;
    CHECK_FALSE(choice.is_due(list));
  }
  CHECK(waits == std::vector<int>{1, 2, 3, 5});
}

TEST_CASE("it looks again only where another way may have become the cheapest") {
  const DrawList list = random_room(3, 20, 12);
  LaserScannerDesc desc;
  desc.pattern = {.beams = 181, .min_azimuth_rad = -1, .max_azimuth_rad = 1};
  desc.method = ScanMethod::automatic;
  desc.max_error_rel = 1e-4;
  CostModel cost;
  cost[CostTerm::pass] = 1e15;  // far dearer than casting: no item is tested so often
  cost[CostTerm::item_test] = 1;
  LaserScanner scanner("S", desc);
  scanner.use_cost_model([&]() -> const CostModel& { return cost; });
  // From the room's middle to far outside, from where the room is narrow: what casting costs, the tests of items,
  // swings.
  for (const double x_m : {0.0, -60.0, 0.0, -60.0, 0.0, -60.0}) {
    measure(scanner, list, to_matrix({{x_m, 0, 1.2}, 0, 0, 0}));
    CHECK(noted(scanner.report(), "chosen") == "raycast");
  }
  CHECK(noted(scanner.report(), "surveys") == "1");
}

TEST_CASE("the same costs, the same bytes") {
  const TemporaryFolder cache;
  std::string first;
  for (int run = 0; run < 2; ++run) {
    Simulation simulation = marvin(cache.path(), {{"method", "auto"}, {"max_error_m", "0.003"}});
    std::string bytes;
    for (int frame = 0; frame < 3; ++frame) {
      simulation.set("R_POSE", "yaw", 18.0 * frame);
      simulation.step();
      for (const char* name : kScanners) {
        const Scan& scan = simulation.scan(name);
        bytes.append(reinterpret_cast<const char*>(scan.range_m.data()), scan.range_m.size() * sizeof(float));
        bytes.append(reinterpret_cast<const char*>(scan.error_bound_m.data()), scan.range_m.size() * sizeof(float));
      }
    }
    RunReport report;
    report.sensors = simulation.sensors();
    bytes += to_json(report);
    if (run == 0) first = bytes;
    CHECK(bytes == first);  // measured in the first run, kept for the second
  }
  const auto files = files_below(cache.path());
  CHECK(std::ranges::count_if(files, [](const std::string& file) { return file.starts_with("costs-"); }) == 1);
}

TEST_CASE("who does not choose pays nothing: no costs are measured, and nothing else is drawn") {
  const TemporaryFolder cache;
  Simulation simulation = marvin(cache.path(), {{"method", "planar"}});
  simulation.step();
  for (const std::string& file : files_below(cache.path())) CHECK_FALSE(file.starts_with("costs-"));
  REQUIRE(simulation.diagnostics().frame_plan().passes.size() == std::size(kScanners));
  for (std::size_t i = 0; i < std::size(kScanners); ++i) {
    CHECK(simulation.diagnostics().frame_plan().passes[i].name == kScanners[i] + std::string(".depth"));
  }
  CHECK(simulation.diagnostics().frame_plan().casts.empty());
  const SensorReport report = sensor(simulation, "FRONT_SCANNER").report;
  CHECK(report.notes.empty());
  CHECK(report.explanation.empty());
}

TEST_CASE("a file of costs is taken only as it was written") {
  const TemporaryFolder folder;
  CostModel cost;
  for (std::size_t i = 0; i < kCostTerms; ++i) cost.of[i] = 1.23456e-4 * std::pow(10, i);
  const fs::path file = folder / "costs-x.txt";
  CHECK_FALSE(load_cost_model(file));
  const CostModel written = save_cost_model(file, cost);
  CHECK(written[CostTerm::pass] == 1e-3);  // the least
  CHECK(written[CostTerm::item_test] == 1.2e8);
  CHECK(written[CostTerm::triangle_test] == 1e9);  // the most
  CHECK(load_cost_model(file) == written);
  CHECK(files_below(folder.path()).size() == 1);  // no temporary file

  const std::string text = read_text(file);
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string broken = text;
    broken[i] = static_cast<char>(broken[i] ^ 1);
    write_text(file, broken);
    CHECK_FALSE(load_cost_model(file));
  }
  for (const std::string& broken : {std::string(), text + "\n", text.substr(0, text.size() / 2), text + text}) {
    write_text(file, broken);
    CHECK_FALSE(load_cost_model(file));
  }
  write_text(folder / "costs-y.txt", text);  // of another device
  CHECK_FALSE(load_cost_model(folder / "costs-y.txt"));
  CHECK(save_cost_model("/proc/no/such/costs-x.txt", cost) == written);
  CHECK(save_cost_model({}, cost) == written);
}

TEST_CASE("a broken file of costs is made anew") {
  const CostsFolder cache(made_up_costs(true));
  write_text(cache.file, "nonsense");
  Simulation simulation = marvin(cache.folder.path(), {{"method", "auto"}});
  const std::optional<CostModel> cost = load_cost_model(cache.file);
  REQUIRE(cost);
  CHECK(*cost != made_up_costs(true));
  CHECK((*cost)[CostTerm::ray] + (*cost)[CostTerm::item_test] + (*cost)[CostTerm::triangle_test] > 1);
  CHECK((*cost)[CostTerm::pass] + (*cost)[CostTerm::view] > 1000);
}

TEST_CASE("costs are found from counts and times") {
  CostModel truth;
  truth[CostTerm::pass] = 1e5;
  truth[CostTerm::triangle] = 200;
  truth[CostTerm::pixel] = 0;
  truth[CostTerm::ray] = 300;
  std::vector<TimedWork> measurements;
  for (int i = 0; i < 6; ++i) {
    TimedWork drawing, casting;
    drawing.work[CostTerm::pass] = 1;
    drawing.work[CostTerm::triangle] = 100 * i * i;
    drawing.work[CostTerm::pixel] = 1000 * i;
    drawing.time_ns = predict(drawing.work, truth);
    casting.work[CostTerm::ray] = 1 + i;
    casting.time_ns = predict(casting.work, truth);
    measurements.insert(measurements.end(), {drawing, casting});
  }
  const CostModel found = fit_costs(measurements);
  constexpr double kConverged = 1e-6;  // relative; a thousandth of what the rounding to two digits takes is more
  for (std::size_t i = 0; i < kCostTerms; ++i) {
    CHECK(std::abs(found.of[i] - truth.of[i]) <= kConverged * std::max(truth.of[i], 1.0));
  }
}

TEST_CASE("a limit of the range: what is rendered across it is cast, what is cast there is no breach") {
  const RangeLimits limits{0.05, 80};
  ScanTolerance tolerance{.max_error_m = 0.01, .max_error_rel = std::numeric_limits<double>::infinity()};
  CHECK(tolerance.met(read_range({10, 0.009}, limits)));
  CHECK_FALSE(tolerance.met(read_range({10, 0.011}, limits)));
  CHECK_FALSE(tolerance.met(read_range({79.995, 0.009}, limits)));
  CHECK_FALSE(tolerance.met(read_range({80.005, 0.009}, limits)));
  CHECK_FALSE(tolerance.met(read_range({0.049, 0.009}, limits)));
  CHECK(tolerance.met(read_range({100, 5}, limits)));
  const double inf = std::numeric_limits<double>::infinity();
  CHECK(tolerance.met(read_range({inf, 0}, limits)));
  CHECK_FALSE(tolerance.met(read_range({inf, inf}, limits)));  // a silhouette before the sky
  ToleranceCheck check(tolerance);
  for (const RangeEstimate& cast : {RangeEstimate{80, 1e-13}, RangeEstimate{0.05, 1e-17}, RangeEstimate{inf, 0}}) {
    check.add(cast, read_range(cast, limits));
  }
  check.require("S");
}

TEST_CASE("a sensor that touches a surface breaks no tolerance: that range is all rounding") {
  const RangeLimits limits{0, 80};
  const ScanTolerance tolerance{.max_error_rel = 1e-6};
  ToleranceCheck touching(tolerance);
  for (const RangeEstimate& cast : {RangeEstimate{2e-16, 7e-13}, RangeEstimate{7e-13, 7e-13}}) {
    touching.add(cast, read_range(cast, limits));
  }
  touching.require("S");
  ToleranceCheck near(tolerance);
  near.add({1e-9, 7e-13}, read_range({1e-9, 7e-13}, limits));
  CHECK_FALSE(error_of([&] { near.require("S"); }).empty());
}

TEST_SUITE_END();
