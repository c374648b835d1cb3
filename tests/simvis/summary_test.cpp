// The closing lines of a run: their measurements and their text.
#include "program/report/summary.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSummedSensors = R"(
<sensor type="camera" name="CAM" insert_at="ROOT" width="8" height="8"/>
<sensor type="camera" name="VIEW" insert_at="ROOT" width="8" height="8" view="visualization"/>
<sensor type="laser_scanner" name="LEFT" insert_at="ROOT" samples="181"/>
<sensor type="laser_scanner" name="RIGHT" insert_at="ROOT" samples="91"/>
<sensor type="laser_scanner" name="OFF" insert_at="ROOT" samples="7"/>)";

RunSummary summary_of(std::string_view sensors, const SummaryDesc& desc = {}) {
  const TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), std::string(sensors)));
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.name != "OFF");
  return summarize(std::move(simulation), desc);
}

std::vector<std::string> methods_of(const RunSummary& summary) {
  std::vector<std::string> methods;
  for (const VariantCosts& each : summary.costs.value().variants) methods.push_back(each.variant.method);
  return methods;
}

VariantCosts priced(const std::string& method, double median_ms, double difference_m) {
  return {.variant = {method, {}, {}},
          .median_ms = median_ms,
          .bound_largest_m = 2e-6,
          .difference_largest_m = difference_m,
          .wrong_kind_share = method == "nearest" ? 0.015 : 0};
}

}  // namespace

TEST_CASE("the scanners that are on, the other sensors, and the price of each method for the first scanner") {
  std::size_t frames = 0;
  const RunSummary summary = summary_of(
      kSummedSensors, {.frame_ms = 10, .later_frames = 9, .later_frames_s = 0.5, .on_frame = [&] { ++frames; }});
  CHECK(summary.wall_hz == 18);
  CHECK(summary.scanners == 2);
  CHECK(summary.beams == 181 + 91);
  CHECK(summary.set_ms > 0);
  CHECK(summary.cameras == 2);
  CHECK(summary.rate_hz == SimulationDesc{}.rate_hz);
  REQUIRE(summary.costs.has_value());
  CHECK(summary.costs->scanner == "LEFT");
  CHECK(methods_of(summary) == std::vector<std::string>{"nearest", "planar", "hybrid", "raycast"});
  const auto error_m = [&](std::size_t i) { return bounded_error_m(*summary.costs, summary.costs->variants[i]); };
  CHECK(error_m(0) > error_m(1));
  CHECK(error_m(3) > 0);  // rounding
  CHECK(error_m(1) >= error_m(3));
  CHECK(frames > 100);
}

TEST_CASE("a scanner with an effect that follows beams has one price, a scene without scanners none") {
  const RunSummary sweeps =
      summary_of(R"(<sensor type="laser_scanner" name="SWEEPS" insert_at="ROOT" samples="31" sweep="0.01"/>)");
  CHECK(methods_of(sweeps) == std::vector<std::string>{"raycast"});
  CHECK(sweeps.cameras == 0);
  const RunSummary pictures = summary_of(R"(<sensor type="camera" name="CAM" insert_at="ROOT" width="8" height="8"/>)");
  CHECK(pictures.scanners == 0);
  CHECK_FALSE(pictures.costs.has_value());
}

TEST_CASE("the files to open first exist: a picture for people, a scan, the report") {
  const TemporaryFolder out;
  const auto files = [&] { return summary_of(kSummedSensors, {.frame_ms = 10, .out = out.path()}).files; };
  CHECK(files().empty());
  for (const char* file : {"CAM/000000.png", "RIGHT.csv", "OFF.csv", "run.json"}) {
    fs::create_directories((out / file).parent_path());
    write_text(out / file, "");
  }
  using Files = std::vector<fs::path>;
  CHECK(files() == Files{out / "CAM/000000.png", out / "RIGHT.csv", out / "run.json"});
  fs::create_directories(out / "VIEW");
  write_text(out / "VIEW/000000.png", "");
  CHECK(files() == Files{out / "VIEW/000000.png", out / "RIGHT.csv", out / "run.json"});
}

TEST_CASE("the lines") {
  RunSummary summary{.scanners = 3, .beams = 1083, .set_ms = 2, .rate_hz = 15, .frame_ms = 80, .cameras = 2};
  summary.wall_hz = 12;
  summary.files = {"out/CAM/000000.png", "out/run.json"};
  ScannerCosts costs;
  costs.scanner = "FRONT";
  costs.variants = {priced("nearest", 0.5, 0.25), priced("planar", 0.5, 1e-3), priced("hybrid", 0.5, 0),
                    priced("raycast", 0.0625, 0)};
  // A few beams hit a surface that is far away: their share must not read as 0, and their error is not that of all
  // beams.
  costs.variants[1].unbounded_share = 1.0 / 361;
  costs.variants[1].unbounded_difference_m = 5.8;
  costs.variants[1].wrong_kind_share = 1.0 / 5415;
  costs.variants[2].unbounded_share = 0.5;  // no reading there is a range
  summary.costs = costs;
  CHECK(to_text(summary) ==
        "scanners: 3 with 1083 beams together, 2.00 ms a set: 500 sets per second, 33 x 15 Hz\n"
        "cameras: 98 % of a frame of 80.0 ms\n"
        "wall clock: 12.0 frames per second with their files, from the second frame on: 0.80 x 15 Hz\n"
        "what accuracy costs FRONT (--price lists more):\n"
        "  nearest     0.500 ms, error up to 2.5e-01 m, wrong hit or miss for 1.5 % of the beams\n"
        "  planar      0.500 ms, error up to 1.0e-03 m, no bound for 1 in 361 beams (error up to 5.8e+00 m), "
        "wrong hit or miss for 1 in 5415 beams\n"
        "  hybrid      0.500 ms, error up to 2.0e-06 m, no bound for 50 % of the beams, wrong hit or miss for no beam\n"
        "  raycast     0.062 ms, error up to 2.0e-06 m, wrong hit or miss for no beam\n"
        "open first: out/CAM/000000.png, out/run.json\n");
  CHECK(to_text({.files = {"out/run.json"}}) == "open first: out/run.json\n");
}

}  // namespace simvis

TEST_SUITE_END();
