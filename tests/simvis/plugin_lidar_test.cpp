// A scanner of a plug-in library takes effects, --method, --max-error, --price and --summary as laser_scanner does.
#include <doctest/doctest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

const std::string kLidarPlugin = tested_build() + "/lib/libsimvis_example_plugin.so";

/// The plate, 5 m wide, stands 2.53 m ahead of the lidar: beam 0 meets it.
constexpr double kAhead_m = 2.53;
/// Of a range that is stored as float and was exact before: half a unit in the last place below 4 m.
constexpr double kStored_m = 2.4e-7 / 2;

std::string scene(const std::string& attributes, const std::string& more = "") {
  return R"(<scene>
  <element type="plate" name="PLATE" insert_at="ROOT" x="2.53" size="5"/>
  <sensor type="ring_lidar" name="LIDAR" insert_at="ROOT" beams="8" )" +
         attributes + "/>\n" + more + "</scene>\n";
}

/// A run of the program on a scene with the plug-in.
struct Run {
  Run(const std::string& xml, const std::vector<std::string>& options = {}) {
    write_text(folder / "scene.xml", xml);
    std::vector<std::string> command{simvis_run(), "--plugin", kLidarPlugin, "--out", (folder / "out").string()};
    command.insert(command.end(), options.begin(), options.end());
    command.push_back((folder / "scene.xml").string());
    result = Process(command).wait();
  }

  /// Of beam 0 in the first frame: its range and its bound.
  std::pair<double, double> ahead_m() const {
    CAPTURE(result.err);
    REQUIRE(result.exit_code == 0);
    std::istringstream lines(read_text(folder / "out/LIDAR.csv"));
    std::string line, cell;
    for (int i = 0; i < 2; ++i) std::getline(lines, line);  // the heading, beam 0
    std::istringstream cells(line);
    std::vector<std::string> row;
    while (std::getline(cells, cell, ',')) row.push_back(cell);
    return {std::stod(row.at(6)), std::stod(row.at(7))};  // behind frame, time_s, ring, beam and two angles
  }

  nlohmann::json lidar() const {
    return nlohmann::json::parse(read_text(folder / "out/run.json")).at("sensors").at("LIDAR");
  }

  const TemporaryFolder folder;
  ProcessResult result;
};

bool has_text(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("effects of scanners belong to a plug-in's scanner, and are described so") {
  const ProcessResult lidar = Process({simvis_run(), "--plugin", kLidarPlugin, "--describe", "ring_lidar"}).wait();
  CHECK(lidar.exit_code == 0);
  CHECK(has_text(lidar.out, "range_noise"));
  CHECK_FALSE(has_text(lidar.out, "vignetting"));
  const ProcessResult noise = Process({simvis_run(), "--plugin", kLidarPlugin, "--describe", "range_noise"}).wait();
  CHECK(has_text(noise.out, "sensors: laser_scanner ring_lidar\n"));
  const ProcessResult lens = Process({simvis_run(), "--plugin", kLidarPlugin, "--describe", "lens_distortion"}).wait();
  CHECK(has_text(lens.out, "sensors: camera "));
  CHECK_FALSE(has_text(lens.out, "ring_lidar"));
}

TEST_CASE("an effect changes the ranges of a plug-in's scanner") {
  CHECK(std::abs(Run(scene("")).ahead_m().first - kAhead_m) <= kStored_m);
  const Run rounded(scene(R"(range_resolution="0.5")"));
  CHECK(rounded.ahead_m().first == 2.5);
  CHECK(rounded.lidar()["effects"] == nlohmann::json{"range_resolution"});
}

TEST_CASE("fog of the scene makes a plug-in's scanner follow its beams") {
  // In clear air the plate's echo has the power 1 / 2.53^2 = 0.156. A visibility of 3 m leaves exp(-6.6) = 0.0014 of
  // it, which is less than the tenth that the lidar needs.
  const std::string lidar = scene(R"(least_power="0.0156")");
  CHECK(std::abs(Run(lidar).ahead_m().first - kAhead_m) <= kStored_m);
  const Run fog(
      scene(R"(least_power="0.0156")", R"(  <element type="fog" name="FOG" insert_at="ROOT" visibility="3"/>)"));
  CHECK(std::abs(fog.ahead_m().first - kAhead_m) > 1);
  CHECK(fog.lidar()["effects"] == nlohmann::json{"atmosphere"});
}

TEST_CASE("--method and --max-error hold for a plug-in's scanner") {
  const Run coarse(scene(""), {"--method", "coarse"});
  CHECK(coarse.lidar()["method"] == "coarse");
  CHECK(std::abs(coarse.ahead_m().first - 2.5) <= kStored_m);
  const Run bounded(scene(R"(method="raycast")"), {"--max-error", "0.25"});
  CHECK(bounded.lidar()["method"] == "coarse");
  CHECK(std::abs(bounded.ahead_m().second - 0.25) <= 2 * kStored_m);
  const Run wrong(scene(""), {"--method", "planar"});
  CHECK(wrong.result.exit_code == 2);
  CHECK(has_text(wrong.result.err, "--method: error: "));
  CHECK(has_text(wrong.result.err, "raycast, coarse"));
}

TEST_CASE("a method that another scanner of the scene does not have is an error") {
  const Run both(scene("", R"(  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT"/>)"), {"--method", "coarse"});
  CHECK(both.result.exit_code == 2);
  CHECK(has_text(both.result.err,
                 "--method: error: attribute \"method\": \"coarse\" is not allowed, expected one of: nearest"));
  const Run neither(scene(""), {"--method", "sonar"});
  CHECK(neither.result.exit_code == 2);
}

TEST_CASE("--price lists the methods of a plug-in's scanner") {
  const Run run(scene(""), {"--price", "--frames", "1"});
  CAPTURE(run.result.err);
  REQUIRE(run.result.exit_code == 0);
  CHECK(has_text(run.result.out, "LIDAR: 8 beams"));
  const std::string csv = read_text(run.folder / "out/price.csv");
  CHECK(has_text(csv, "\nLIDAR,8,1,"));
  CHECK(has_text(csv, ",raycast,"));
  CHECK(has_text(csv, ",coarse,"));
}

TEST_CASE("--summary counts a plug-in's scanner among the scanners") {
  const Run run(scene(""), {"--summary"});
  CAPTURE(run.result.err);
  REQUIRE(run.result.exit_code == 0);
  CHECK(has_text(run.result.out, "scanners: 1 with 8 beams together"));
  CHECK(has_text(run.result.out, "what accuracy costs LIDAR"));
  CHECK(has_text(run.result.out, "  coarse "));
  CHECK_FALSE(has_text(run.result.out, "cameras:"));
  CHECK(has_text(run.result.out, "LIDAR.csv"));
}

}  // namespace simvis

TEST_SUITE_END();
