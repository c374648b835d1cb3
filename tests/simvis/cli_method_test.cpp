// simvis-run --method and --max-error: the scan method and the tolerance that override those of the scene.
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

TEST_CASE("--method overrides the scene's method and is reported") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  REQUIRE(run_simvis({scene.string(), "--out", (folder / "out").string(), "--method", "nearest"}).exit_code == 0);
  const auto json = nlohmann::json::parse(read_text(folder / "out/run.json"));
  CHECK(json["sensors"]["SCAN"]["method"] == "nearest");
  check_refused({"--method", "sonar"}, std::string(kWallSensors), {"--method", "sonar", "nearest", "planar"});
  check_refused({"--method", "sonar"}, "", {"--method", "sonar"});  // also without a scanner
}

TEST_CASE("--method drops a tolerance of the scene that the method does not use") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(
      folder.path(), R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" max_error_m="0.01"/>)");
  for (const std::string method : {"nearest", "planar", "hybrid", "raycast"}) {
    const ProcessResult result = run_simvis({scene.string(), "--out", (folder / "out").string(), "--method", method});
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    CHECK(nlohmann::json::parse(read_text(folder / "out/run.json"))["sensors"]["SCAN"]["method"] == method);
  }
}

TEST_CASE("--max-error selects hybrid over the scene's method; the price list of auto and its entries in run.json") {
  const TemporaryFolder folder;
  const Strings cache{"XDG_CACHE_HOME=" + (folder / "cache").string()};
  const fs::path scene = write_wall_scene(
      folder.path(), std::string(kWallSensors) + R"(<sensor type="laser_scanner" name="NEAREST" insert_at="ROOT"
                         method="nearest"/>)");
  const std::string out = (folder / "out").string();
  REQUIRE(run_simvis({scene.string(), "--out", out, "--max-error", "0.001"}, cache).exit_code == 0);
  for (const char* name : {"SCAN", "NEAREST"}) {
    CHECK(nlohmann::json::parse(read_text(folder / "out/run.json"))["sensors"][name]["method"] == "hybrid");
  }
  for (const Strings& row : read_csv(folder / "out/SCAN.csv").rows) CHECK(std::stod(row[7]) <= 0.001);

  const ProcessResult result =
      run_simvis({scene.string(), "--out", out, "--max-error", "0.001", "--method", "auto", "--explain"}, cache);
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const auto json = nlohmann::json::parse(read_text(folder / "out/run.json"));
  for (const char* name : {"SCAN", "NEAREST"}) {
    const auto& sensor = json["sensors"][name];
    CHECK(sensor["method"] == "auto");
    const std::string chosen = sensor["chosen"];
    CHECK((chosen == "raycast" || chosen.starts_with("hybrid ")));
    CHECK(sensor["chosen_because"].get<std::string>().find("no bound above 0.001 m") != std::string::npos);
    CHECK(sensor["predicted_ms"].get<double>() > 0);
    CHECK(sensor["surveys"] == 1);
    CHECK(sensor["cast_share"] == 1);  // a survey casts every beam
    CHECK(result.out.find(std::string("price list of ") + name) != std::string::npos);
    CHECK(result.out.find("  * " + chosen + ": ") != std::string::npos);
  }
  for (const Strings& row : read_csv(folder / "out/SCAN.csv").rows) CHECK(std::stod(row[7]) <= 0.001);

  for (const char* method : {"auto", "hybrid"}) {
    REQUIRE(run_simvis({scene.string(), "--out", out, "--max-error", "1e-5", "--method", method, "--quiet"}, cache)
                .exit_code == 0);
    CHECK(nlohmann::json::parse(read_text(folder / "out/run.json"))["sensors"]["SCAN"]["method"] == method);
    for (const Strings& row : read_csv(folder / "out/SCAN.csv").rows) CHECK(std::stod(row[7]) <= 1e-5);
  }

  const std::string commands(kWallSensors);
  for (const char* method : {"nearest", "planar", "raycast"}) {
    check_refused({"--max-error", "0.001", "--method", method}, commands,
                  {"simvis-run: --max-error: ", method, "ignores a tolerance"});
  }
  for (const char* wrong : {"0", "-1", "nan", "inf", "much", ""}) {
    check_refused({"--max-error", wrong}, commands, {"--max-error"});
  }
  check_refused({"--max-error", "0"}, "", {"--max-error", "0 is not allowed, expected a number greater than 0 (m)"});

  const ProcessResult unreachable =
      run_simvis({scene.string(), "--out", (folder / "none").string(), "--max-error", "1e-9"}, cache);
  CHECK(unreachable.exit_code == 2);
  CHECK(unreachable.err.find(
            "simvis-run: --max-error: error: attribute \"max_error_m\": 1e-09 cannot be kept by any method "
            "for sensor \"SCAN\"") != std::string::npos);
  CHECK(files_below(folder / "none").empty());
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
