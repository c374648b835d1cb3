// The costs by which method="auto" chooses: when they are measured, how they are fitted, and the file that keeps them.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sensors/laser_scanner/scan_calibration.h"
#include "tests/sensors/auto_scan.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;
using namespace simvis::test;

namespace fs = std::filesystem;

TEST_CASE("with a fixed method no costs are measured and nothing else is drawn") {
  const TemporaryFolder cache;
  Simulation simulation = marvin_scanners(cache.path(), {{"method", "planar"}});
  simulation.step();
  for (const std::string& file : files_below(cache.path())) CHECK_FALSE(file.starts_with("costs-"));
  REQUIRE(simulation.diagnostics().frame_plan().passes.size() == std::size(kMarvinScanners));
  for (std::size_t i = 0; i < std::size(kMarvinScanners); ++i) {
    CHECK(simulation.diagnostics().frame_plan().passes[i].name == kMarvinScanners[i] + std::string(".depth"));
  }
  CHECK(simulation.diagnostics().frame_plan().casts.empty());
  const SensorReport report = sensor(simulation, "FRONT_SCANNER").report;
  CHECK(report.notes.empty());
  CHECK(report.explanation.empty());
}

TEST_CASE("a file of costs is used only if it is unchanged and belongs to the device") {
  const TemporaryFolder folder;
  CostModel cost;
  for (std::size_t i = 0; i < kCostTerms; ++i) cost.of[i] = 1.23456e-4 * std::pow(10, i);
  const fs::path file = folder / "costs-x.txt";
  CHECK_FALSE(load_cost_model(file));
  const CostModel written = save_cost_model(file, cost);
  CHECK(written[CostTerm::pass] == 1e-3);  // the minimum
  CHECK(written[CostTerm::item_test] == 1.2e8);
  CHECK(written[CostTerm::triangle_test] == 1e9);  // the maximum
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

TEST_CASE("a broken file of costs is replaced by new measurements") {
  const CostsFolder cache(made_up_costs(true));
  write_text(cache.file, "nonsense");
  Simulation simulation = marvin_scanners(cache.folder.path(), {{"method", "auto"}});
  const std::optional<CostModel> cost = load_cost_model(cache.file);
  REQUIRE(cost);
  CHECK(*cost != made_up_costs(true));
  CHECK((*cost)[CostTerm::ray] + (*cost)[CostTerm::item_test] + (*cost)[CostTerm::triangle_test] > 1);
  CHECK((*cost)[CostTerm::pass] + (*cost)[CostTerm::view] > 1000);
}

TEST_CASE("costs are fitted to counts and times") {
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
  constexpr double kConverged = 1e-6;  // relative; below a thousandth of the rounding to two digits
  for (std::size_t i = 0; i < kCostTerms; ++i) {
    CHECK(std::abs(found.of[i] - truth.of[i]) <= kConverged * std::max(truth.of[i], 1.0));
  }
}

TEST_SUITE_END();
