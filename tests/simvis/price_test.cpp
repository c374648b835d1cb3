// The price list of accuracy: every method measures as in a normal run, and the advice for the scene.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "program/report/cost_report.h"
#include "program/report/scanner_costs.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "tests/support/error_of.h"
#include "tests/support/infinity.h"
#include "tests/support/simvis_run.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

// The wall ends at 68 degrees on either side, so there are hits, misses, and beams that a raster method cannot decide.
// LATER moves elements inserted after it, so not the scanner.
constexpr std::string_view kPricedSensors = R"(
<element type="pose" name="MOVE" insert_at="ROOT" x="0.5"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" pose_offset="0.5 0 0 0 0 20" samples="721" rate="1"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="8" height="8"/>
<element type="pose" name="LATER" insert_at="ROOT" x="-3"/>)";
constexpr std::string_view kDrive = "time_s,MOVE.x,MOVE.yaw\n0,0.5,0\n1,2.5,40\n";

const CostDesc kShort{.frames = 3, .warm_up = 1};

struct WallScene {
  explicit WallScene(std::string_view sensors = kPricedSensors) : scene(write_wall_scene(folder.path(), sensors)) {
    write_text(folder / "drive.csv", kDrive);
  }
  Simulation load(const SimulationDesc& desc = {}) const { return Simulation::load(scene, desc); }

  TemporaryFolder folder;
  fs::path scene;
};

SimulationDesc overridden(const ScanVariant& variant) {
  SimulationDesc desc;
  const auto set = [&](const char* name, const std::string& value) {
    desc.overrides.push_back({"laser_scanner", name, value, "this test"});
  };
  set("rate", "15");
  set("method", variant.method);
  if (variant.resolution_px) set("resolution", format_number(*variant.resolution_px));
  if (variant.max_error_rel) set("max_error_rel", format_number(*variant.max_error_rel));
  return desc;
}

/// The smallest value that half of them do not exceed.
double middle(std::vector<double> values) {
  if (values.empty()) return VariantCosts::kNone;
  std::sort(values.begin(), values.end());
  return values[(values.size() - 1) / 2];
}

/// Results of frames 1 to `frames` of a normal run of a variant, driven or at rest.
struct NormalRun {
  NormalRun(const WallScene& scene, const ScanVariant& variant, std::uint64_t frames, bool drives) {
    Simulation simulation = scene.load(overridden(variant));
    const Trajectory drive(scene.folder / "drive.csv", simulation.parameters());
    std::vector<double> medians_m, medians_rel;
    double beams = 0;
    for (std::uint64_t frame = 0; frame <= frames; ++frame) {
      if (drives) {
        drive.apply(static_cast<double>(simulation.next_frame().time_ns) / 1e9, simulation.parameters());
      }
      simulation.step();
      if (frame == 0) continue;
      const Scan& scan = simulation.scan("SCAN");
      std::vector<double> bounds_m, bounds_rel;
      for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
        const double range_m = scan.range_m[i], bound_m = scan.error_bound_m[i];
        unbounded += std::isinf(bound_m);
        if (std::isinf(bound_m) || std::isinf(range_m)) continue;
        bounds_m.push_back(bound_m);
        bounds_rel.push_back(bound_m / range_m);
      }
      largest_m = std::max(largest_m, *std::ranges::max_element(bounds_m));
      largest_rel = std::max(largest_rel, *std::ranges::max_element(bounds_rel));
      medians_m.push_back(middle(bounds_m));
      medians_rel.push_back(middle(bounds_rel));
      beams += static_cast<double>(scan.range_m.size());
      cast += simulation.sensors()[0].number("cast_share").value_or(0) / static_cast<double>(frames);
      method = simulation.sensors()[0].method;
    }
    unbounded /= beams;
    median_m = middle(medians_m);
    median_rel = middle(medians_rel);
  }
  std::string method;
  double median_m = 0, median_rel = 0, largest_m = 0, largest_rel = 0, unbounded = 0, cast = 0;
};

/// A list with the decisive columns: time, largest bound, beams without one.
ScannerCosts made_up(const std::vector<std::array<double, 3>>& rows) {
  ScannerCosts costs{.scanner = "MADE, UP", .rings = 2, .beams = 20, .frames = 1, .load = 1.5, .variants = {}};
  for (const auto& [time_ms, bound_rel, unbounded] : rows) {
    VariantCosts row{.variant = {"planar", 512 + static_cast<double>(costs.variants.size()), {}}};
    row.median_ms = time_ms;
    row.bound_largest_rel = bound_rel;
    row.unbounded_share = unbounded;
    costs.variants.push_back(row);
  }
  return costs;
}

ProcessResult run(Strings arguments) {
  arguments.insert(arguments.begin(), simvis_run());
  return Process(arguments).wait();
}

Strings lines_of(const std::string& text) {
  Strings lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace

TEST_CASE("a variant has the pose of its sensor, moves with it, and measures as the sensor would") {
  const WallScene scene;
  Simulation simulation = scene.load();
  Command command = simulation.diagnostics().command("SCAN");
  for (CommandAttribute& attribute : command.attributes) {
    if (attribute.name == "name") attribute.value = "SCAN.2";
  }
  simulation.add_variant("SCAN", command);
  const std::size_t items = simulation.diagnostics().draw_list().items.size();
  for (int frame = 0; frame < 3; ++frame) {
    simulation.set("MOVE", "x", 0.3 * frame);
    simulation.set("MOVE", "yaw", 10.0 * frame);
    simulation.set("LATER", "x", -1.0 * frame);
    for (int second = 0; second < 15; ++second) simulation.step();
    CHECK(simulation.scan("SCAN.2").range_m == simulation.scan("SCAN").range_m);
    CHECK(simulation.scan("SCAN.2").error_bound_m == simulation.scan("SCAN").error_bound_m);
  }
  CHECK(simulation.diagnostics().draw_list().items.size() == items);
  simulation.enable("SCAN.2", false);
  CHECK(simulation.sensors().back().enabled == false);
}

TEST_CASE("overrides are in the command of a sensor and do not change a variant") {
  const WallScene scene;
  Simulation simulation = scene.load(overridden({"nearest", 512, {}}));
  CHECK(scan_variants(simulation.diagnostics().command("SCAN")).own == ScanVariant{"nearest", 512, {}});
  simulation.add_variant("SCAN", with_variant(simulation.diagnostics().command("SCAN"), {"planar", 64, {}}, "SCAN.0"));
  CHECK(simulation.sensors().back().method == "planar");
  CHECK(error_of([&] { simulation.diagnostics().command("SCAM"); }).find("did you mean \"SCAN\"?") !=
        std::string::npos);
}

TEST_CASE("an impossible variant leaves the simulation unchanged") {
  const WallScene scene;
  Simulation simulation = scene.load();
  const Command command = simulation.diagnostics().command("SCAN");
  const auto refused = [&](const Command& wrong, const std::string& why) {
    return contains(error_of([&] { simulation.add_variant("SCAN", wrong); }), why);
  };
  CHECK(refused(command, "\"SCAN\""));  // the name is taken
  CHECK(refused(with_variant(command, {"sonar", 512, {}}, "A"), "sonar"));
  CHECK(refused(with_variant(command, {"planar", 1, {}}, "A"), "resolution"));
  Command camera = simulation.diagnostics().command("CAM");
  camera.attributes[1].value = "A";
  REQUIRE(camera.attributes[1].name == "name");
  CHECK(refused(camera, "must have its type"));
  CHECK(contains(error_of([&] { simulation.add_variant("SCAM", command); }), "did you mean \"SCAN\"?"));
  CHECK(simulation.sensors().size() == 2);
  simulation.add_variant("SCAN", with_variant(command, {"planar", 512, {}}, "A"));
  simulation.step();
  CHECK(simulation.sensors().size() == 3);
}

TEST_CASE("variants: the requested one of a scanner is among them once, and equal ones are not priced twice") {
  const auto scanner = [](const std::string& attributes) {
    return parse_commands(R"(<sensor type="laser_scanner" name="S" insert_at="ROOT" )" + attributes + "/>", "", "")[0];
  };
  CHECK(scan_variants(scanner("")).own == ScanVariant{"raycast", {}, {}});
  CHECK(scan_variants(scanner("method=\"planar\"")).own == ScanVariant{"planar", kPlanarResolution, {}});
  CHECK(scan_variants(scanner("method=\"planar\" vertical_samples=\"2\"")).own ==
        ScanVariant{"planar", kRingsResolution, {}});
  CHECK(attributes_of({"hybrid", 512, 1e-3}) == R"(method="hybrid" resolution="512" max_error_rel="0.001")");
  CHECK(attributes_of({"raycast", {}, {}}) == R"(method="raycast")");
  constexpr std::size_t per_resolution = 5, casting = 1;
  CHECK(scan_variants(scanner("")).priced.size() == 5 * per_resolution + casting);
  CHECK(scan_variants(scanner("resolution=\"4096\"")).priced.size() == 5 * per_resolution + casting);
  CHECK(scan_variants(scanner("resolution=\"300\"")).priced.size() == 6 * per_resolution + casting);
  CHECK(scan_variants(scanner("vertical_samples=\"2\"")).priced.size() == 4 * per_resolution + casting);
  CHECK(scan_variants(scanner("method=\"raycast\" resolution=\"64\"")).own == ScanVariant{"raycast", {}, {}});
  // A tolerance below the bound of any pixel: nothing is rendered at any resolution.
  CHECK(scan_variants(scanner("method=\"hybrid\"")).own == ScanVariant{"hybrid", {}, 1e-6});
  CHECK(scan_variants(scanner("method=\"hybrid\"")).priced.size() == 27);
  CHECK(scan_variants(scanner("max_error_rel=\"0.01\"")).priced.size() == 31);
  for (const char* own : {"", "method=\"raycast\"", "method=\"hybrid\"", "method=\"hybrid\" max_error_rel=\"2e-4\"",
                          "method=\"nearest\" resolution=\"100\"", "vertical_samples=\"8\" max_error_rel=\"2e-4\""}) {
    CAPTURE(own);
    const std::vector<ScanVariant> variants = scan_variants(scanner(own)).priced;
    CHECK(std::ranges::count(variants, scan_variants(scanner(own)).own) == 1);
    for (const ScanVariant& variant : variants) CHECK(std::ranges::count(variants, variant) == 1);
  }
}

TEST_CASE("each row equals a normal run of its variant; errors are within bounds; at rest and driven") {
  const WallScene scene;
  const std::vector<bool> at_rest_and_driven = sanitized() ? std::vector{true} : std::vector{false, true};
  for (const bool drives : at_rest_and_driven) {
    Simulation simulation = scene.load();
    const Trajectory drive(scene.folder / "drive.csv", simulation.parameters());
    CostDesc desc = kShort;
    if (drives) desc.trajectory = &drive;
    const std::vector<ScannerCosts> all_costs = scanner_costs(std::move(simulation), desc);
    REQUIRE(all_costs.size() == 1);
    const ScannerCosts& costs = all_costs[0];
    CHECK(costs.scanner == "SCAN");
    CHECK(costs.rings == 1);
    CHECK(costs.beams == 721);
    CHECK(costs.frames == desc.frames);
    REQUIRE(costs.variants.size() == 26);
    const VariantCosts& exact = costs.variants.back();
    CHECK(std::ranges::count(costs.variants, true, &VariantCosts::in_scene) == 1);
    CHECK(std::ranges::min(costs.variants, {}, &VariantCosts::ratio).ratio == 1);
    double max_unbounded = 0;
    for (const VariantCosts& row : costs.variants) {
      CAPTURE(attributes_of(row.variant));
      const NormalRun normal(scene, row.variant, desc.frames, drives);
      CHECK(row.in_scene == (row.variant == ScanVariant{"raycast", {}, {}}));
      CHECK(normal.method == row.variant.method);
      CHECK(row.median_ms > 0);
      CHECK(row.first_quartile_ms <= row.median_ms);
      CHECK(row.third_quartile_ms >= row.median_ms);
      CHECK(row.processor_ms > 0);
      CHECK(std::isfinite(row.ratio));
      CHECK(row.ratio >= 1);
      CHECK(row.bound_median_m == normal.median_m);
      CHECK(row.bound_median_rel == normal.median_rel);
      CHECK(row.bound_largest_m == normal.largest_m);
      CHECK(row.bound_largest_rel == normal.largest_rel);
      CHECK(row.unbounded_share == normal.unbounded);
      CHECK(row.cast_share == doctest::Approx(normal.cast).epsilon(1e-12));  // another order of sums
      max_unbounded = std::max(max_unbounded, row.unbounded_share);
      CHECK(row.difference_largest_m <= row.bound_largest_m + exact.bound_largest_m);
      CHECK(row.difference_largest_rel <= row.bound_largest_rel + exact.bound_largest_rel);
      CHECK(std::isnan(row.unbounded_difference_m) == !(row.unbounded_share > 0));
      // The kind of a reading is uncertain only where there is no bound.
      CHECK(row.wrong_kind_share <= row.unbounded_share);
      if (row.variant.max_error_rel) CHECK(row.meets(*row.variant.max_error_rel));
    }
    CHECK(max_unbounded > 0);
    CHECK(exact.variant == ScanVariant{"raycast", {}, {}});
    CHECK(exact.cast_share == 1);
    CHECK(exact.difference_largest_m == 0);
    CHECK(exact.wrong_kind_share == 0);
  }
}

TEST_CASE("the advice can be written in a scene and meets its tolerance there") {
  const WallScene scene;
  const ScannerCosts costs = scanner_costs(scene.load(), kShort).front();
  const std::string advice = cost_advice(costs);
  CHECK(advice.starts_with("SCAN: for 0.001"));
  CHECK(advice.find('\n') == std::string::npos);
  for (const double tolerance_rel : kCostTolerances_rel) {
    CAPTURE(tolerance_rel);
    const std::optional<std::size_t> variant = cheapest_for(costs, tolerance_rel);
    REQUIRE(variant.has_value());
    const std::string attributes = attributes_of(costs.variants[*variant].variant);
    CHECK(contains(advice, " write " + attributes + " ("));
    std::string sensors(kPricedSensors);
    sensors.insert(sensors.find("samples="), attributes + " ");
    Simulation simulation = WallScene(sensors).load();
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
      CHECK(std::isfinite(scan.error_bound_m[i]));
      CHECK(scan.error_bound_m[i] <= tolerance_rel * scan.range_m[i]);
    }
  }
}

TEST_CASE("the cheapest method for a tolerance: within 5 % the better bound; none where none meets it") {
  using Rows = std::vector<std::array<double, 3>>;
  CHECK(cheapest_for(made_up(Rows{{1, 1e-3, 0}, {2, 1e-7, 0}}), 1e-3) == 0);
  CHECK(cheapest_for(made_up(Rows{{1, 1e-3, 0}, {2, 1e-7, 0}}), 1e-4) == 1);
  CHECK(cheapest_for(made_up(Rows{{1, 1e-3, 0}, {1.04, 1e-7, 0}, {1.06, 1e-8, 0}}), 1e-3) == 1);
  CHECK(cheapest_for(made_up(Rows{{1, 1e-7, 1e-5}, {2, 1e-4, 0}}), 1e-3) == 1);
  CHECK(cheapest_for(made_up(Rows{{1, kInfinity, 0}}), 1e-3) == std::nullopt);

  // Bounds do not cover objects narrower than three pixels, except those of raycast.
  ScannerCosts costs = made_up({{1, 1e-5, 0}, {1, 1e-5, 0}, {2, 1e-5, 0}});
  costs.variants[0].difference_largest_rel = 0.2;
  costs.variants[1].wrong_kind_share = 0.01;
  costs.variants[2].difference_largest_rel = 1e-5;
  costs.variants[2].wrong_kind_share = 0;
  CHECK(cheapest_for(costs, 1e-3) == 2);
  CHECK(cost_advice(costs) ==
        "MADE, UP: for 0.001 and 1e-04 write method=\"planar\" resolution=\"514\" (2.000 ms); no variant keeps 1e-06, "
        "nearest is method=\"planar\" resolution=\"512\" with bounds up to 1.0e-05 and none for 0 % of the beams");
}

TEST_CASE("a table of aligned columns, and CSV that reads back") {
  ScannerCosts costs = made_up({{1.25, 1e-3, 0}, {2.5, 1e-7, 0.125}});
  costs.variants[0].variant = {"hybrid", 512, 1e-3};
  costs.variants[0].in_scene = true;
  const Strings table = lines_of(to_table(costs));
  REQUIRE(table.size() == 6);
  CHECK(table[0] == "MADE, UP: 10 beams x 2 rings, 1 frame of each, load 1.50 at the start");
  CHECK(table[3].starts_with("hybrid * "));
  for (const auto& column : {std::pair{"ms", "1.250"}, {"resolution", "512"}, {"max_error_rel", "0.001"}}) {
    const std::string name = column.first, value = column.second;
    CAPTURE(name);
    CHECK(table[2].find(name) + name.size() == table[3].find(value) + value.size());
  }
  CHECK(table[3].ends_with("  0.001"));
  CHECK(table[4].find("12.5") != std::string::npos);
  CHECK(table[5] == cost_advice(costs));

  const Strings csv = lines_of(to_csv({&costs, 1}));
  REQUIRE(csv.size() == 3);
  CHECK(csv[0] ==
        "scanner,beams,frames,load,method,resolution_px,max_error_rel,max_error_m,in_scene,median_ms,first_quartile_ms,"
        "third_quartile_ms,processor_ms,ratio,cast_share,bound_median_m,"
        "bound_median_rel,bound_largest_m,bound_largest_rel,unbounded_share,difference_largest_m,"
        "difference_largest_rel,unbounded_difference_m,wrong_kind_share,cheapest_for");
  CHECK(csv[1] == "\"MADE, UP\",20,1,1.5,hybrid,512,0.001,,1,1.25,0,0,0,0,0,,,,0.001,0,,,,,0.001");
  CHECK(csv[2] == "\"MADE, UP\",20,1,1.5,planar,513,,,0,2.5,0,0,0,0,0,,,,1e-07,0.125,,,,,");
  costs.scanner = "A \"B\"";
  CHECK(lines_of(to_csv({&costs, 1}))[1].starts_with("\"A \"\"B\"\"\",20,"));
}

TEST_CASE("only enabled laser scanners are priced; without one it is an error; progress is reported and can end it") {
  constexpr std::string_view kTwo = R"(
<sensor type="laser_scanner" name="A" insert_at="ROOT" samples="3"/>
<sensor type="laser_scanner" name="B" insert_at="ROOT" samples="3" vertical_samples="2" min_angle="100" max_angle="120"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="8" height="8"/>)";
  const WallScene scene(kTwo);
  CHECK(costed_scanners(scene.load()) == Strings{"A", "B"});
  Simulation simulation = scene.load();
  simulation.enable("A", false);
  std::uint64_t calls = 0, last = 0;
  CostDesc desc{.frames = 1, .warm_up = 0};
  desc.on_frame = [&](std::uint64_t done, std::uint64_t all) {
    CHECK(done == ++calls);
    last = all;
  };
  const std::vector<ScannerCosts> all_costs = scanner_costs(std::move(simulation), desc);
  REQUIRE(all_costs.size() == 1);
  CHECK(all_costs[0].scanner == "B");
  CHECK(all_costs[0].rings == 2);
  CHECK(calls == last);
  CHECK(calls == 2 * all_costs[0].variants.size());
  for (const VariantCosts& row : all_costs[0].variants) {  // the scene is empty for all of them
    CHECK(std::isnan(row.bound_median_m));
    CHECK(row.bound_largest_m == 0);
    CHECK(row.unbounded_share == 0);
    CHECK(row.meets(1e-6));
  }

  desc.on_frame = [](std::uint64_t, std::uint64_t) { throw std::runtime_error("enough"); };
  CHECK_THROWS_WITH(scanner_costs(scene.load(), desc), "enough");
  Simulation none = scene.load();
  none.enable("A", false);
  none.enable("B", false);
  CHECK(contains(error_of([&] { scanner_costs(std::move(none)); }), "no enabled laser scanner"));
}

TEST_CASE("scanners in parts have prices, too") {
  const TemporaryFolder folder;
  std::string robot = wall_gltf();
  robot.insert(robot.find("\"mesh\": 0"), R"("extras": {"simvis": ["<element type='pose' name='P'/>",
      "<sensor type='laser_scanner' name='S' samples='3' min_angle='-10' max_angle='10'/>"]}, )");
  write_text(folder / "robot.gltf", robot);
  write_text(folder / "scene.xml", R"(<scene><part file="robot.gltf" name="R1" insert_at="ROOT"/>
    <part file="robot.gltf" name="R2" insert_at="ROOT" pose_offset="1 0 0 0 0 0"/></scene>)");
  Simulation simulation = Simulation::load(folder / "scene.xml");
  const std::vector<ScannerCosts> all_costs = scanner_costs(std::move(simulation), {.frames = 1, .warm_up = 0});
  REQUIRE(all_costs.size() == 2);
  CHECK(all_costs[0].scanner == "R1/S");
  CHECK(all_costs[1].scanner == "R2/S");
  for (const ScannerCosts& costs : all_costs) {
    for (const VariantCosts& row : costs.variants) CHECK(row.bound_largest_m > 0);
  }
}

TEST_CASE("simvis-run --price prints tables, and writes price.csv if --out is given") {
  const WallScene scene;
  const std::string out = (scene.folder / "new/out").string();
  const Strings arguments = {
      scene.scene.string(), "--price",  "--frames", "2", "--trajectory", (scene.folder / "drive.csv").string(), "--set",
      "LATER.x=1",          "--sensor", "SCAN"};
  const ProcessResult printed = run(arguments);
  INFO(printed.err);
  REQUIRE(printed.exit_code == 0);
  CHECK(printed.err == "");
  CHECK(contains(printed.out, "SCAN: 721 beams, 2 frames of each, load "));
  CHECK(contains(printed.out, "\nraycast * "));
  CHECK(contains(printed.out, cost_legend()));
  CHECK(files_below(scene.folder.path()) == Strings{"drive.csv", "scene.xml", "wall.gltf"});

  Strings written = arguments;
  written.insert(written.end(), {"--out", out});
  CHECK(contains(run(written).out, "wrote " + out + "/price.csv\n"));
  CHECK(files_below(out) == Strings{"price.csv"});
  const Strings csv = lines_of(read_text(scene.folder / "new/out/price.csv"));
  REQUIRE(csv.size() == 27);
  for (const std::string& line : csv) CHECK(std::ranges::count(line, ',') == 24);
  for (std::size_t i = 1; i < csv.size(); ++i) CHECK(csv[i].starts_with("SCAN,721,2,"));

  written.push_back("--quiet");
  const ProcessResult quiet = run(written);
  CHECK(quiet.exit_code == 0);
  CHECK(quiet.out == "");
  const ProcessResult standing = run({scene.scene.string(), "--price", "--frames", "1"});
  CHECK(contains(standing.out, "; no parameter is set: --trajectory prices what moves"));
}

TEST_CASE("simvis-run --price with contradictory options") {
  const auto refused = [](std::string_view sensors, const Strings& options, const Strings& expected) {
    const WallScene scene(sensors);
    Strings arguments = {scene.scene.string(), "--price"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProcessResult result = run(arguments);
    INFO(result.err);
    CHECK(result.exit_code == 2);
    CHECK(result.out == "");
    for (const std::string& text : expected) CHECK(contains(result.err, text));
    CHECK(files_below(scene.folder.path()) == Strings{"drive.csv", "scene.xml", "wall.gltf"});
  };
  const TemporaryFolder folder;
  const Strings out = {"--out", (folder / "out").string()};
  refused("", out, {"simvis-run: --price: ", "no enabled laser scanner"});
  refused(kPricedSensors, {"--method", "planar"}, {"--price", "--method"});
  refused(kPricedSensors, {"--explain"}, {"--price", "--explain"});
  refused(kPricedSensors, {"--profile", (folder / "p.json").string()}, {"--price", "--profile"});
  refused(kPricedSensors, {"--quiet"}, {"--price", "--quiet", "--out"});
  refused(kPricedSensors, {"--frames", "0"}, {"--frames", "1 or more"});
  refused(kPricedSensors, {"--sensor", "SCAM"}, {"SCAM", "did you mean \"SCAN\"?"});
  CHECK(files_below(folder.path()).empty());
  CHECK(contains(run({"--help"}).out, "--price"));

  const WallScene scene;  // below a file there is no folder
  const ProcessResult full = run({scene.scene.string(), "--price", "--out", scene.scene.string() + "/out"});
  CHECK(full.exit_code == 1);
  CHECK(full.err.starts_with(scene.scene.string() + "/out: error: "));
}

}  // namespace simvis

TEST_SUITE_END();
