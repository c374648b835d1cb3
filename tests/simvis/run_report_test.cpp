// run.json, the closing line, --explain and the progress bar, made from given numbers.
#include "program/report/run_report.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "program/cli/progress_bar.h"
#include "program/report/explain.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

TEST_CASE("percentiles are values that occurred") {
  const double values[] = {5, 1, 4, 2, 3};
  CHECK(percentile(values, 50) == 3);
  CHECK(percentile(values, 99) == 5);
  CHECK(percentile(values, 100) == 5);
  CHECK(percentile(values, 20) == 1);
  CHECK(percentile(values, 20.1) == 2);
  const double even[] = {1, 2};
  CHECK(percentile(even, 50) == 1);
  CHECK(percentile({}, 50) == 0);
}

RunReport example() {
  RunReport report;
  report.scene = "scenes/a\xff.xml";  // not UTF-8
  report.device.emplace().name = "llvmpipe";
  report.device->driver = "Mesa";
  report.device->api_version = "1.3.230";
  report.seed = 18446744073709551615u;
  report.rate_hz = 15;
  report.wall_s = 1.25;
  report.simulated_s = 0.2;
  for (const double ms : {10.0, 2.0, 2.5}) report.frame_ms.add(ms);
  report.next_frame = report.frames_wanted = 3;
  report.warnings = {"s.xml:1:2: odd", "s.xml:3:4: odder"};
  report.sensors = {{"B_CAM", "camera", "rasterised", 3, true}, {"A_SCAN", "laser_scanner", "planar", 1, true}};
  report.sensors[1].effects = {"range_noise"};
  return report;
}

TEST_CASE("run.json") {
  const auto json = nlohmann::ordered_json::parse(to_json(example()));
  CHECK(json["scene"].get<std::string>().starts_with("scenes/a"));
  CHECK(json["device"] == "llvmpipe");
  CHECK(json["driver"] == "Mesa");
  CHECK(json["versions"]["simvis"] == std::string(version()));
  CHECK(json["versions"]["vulkan"] == "1.3.230");
  CHECK(json["seed"] == 18446744073709551615u);
  CHECK(json["wall_s"] == 1.25);
  CHECK(json["frames"] == 3);
  CHECK(json["frame_ms"]["median"] == 2.5);
  CHECK(json["frame_ms"]["p99"] == 10);
  CHECK(json["warnings"] == nlohmann::ordered_json{"s.xml:1:2: odd", "s.xml:3:4: odder"});
  CHECK(json["rate_hz"] == 15);
  REQUIRE(json["sensors"].size() == 2);
  CHECK(json["sensors"].begin().key() == "B_CAM");  // in the scene's order
  CHECK(json["sensors"]["A_SCAN"]["type"] == "laser_scanner");
  CHECK(json["sensors"]["A_SCAN"]["method"] == "planar");
  CHECK(json["sensors"]["A_SCAN"]["frames"] == 1);
  CHECK(json["sensors"]["A_SCAN"]["effects"] == nlohmann::ordered_json{"range_noise"});
  CHECK(json["sensors"]["B_CAM"]["effects"] == nlohmann::ordered_json::array());
}

TEST_CASE("the closing line compares with real time") {
  CHECK(speed_line(example()) ==
        "3 frames, 2.50 ms a frame: 400.0 Hz, 26.67 x real time at 15 Hz; 1.25 s with loading and files: 0.16 x real "
        "time; 2 warnings");
}

TEST_CASE("explain names every pass, view and reason") {
  Pass pass;
  pass.name = "CAM";
  pass.width_px = 64;
  pass.height_px = 48;
  pass.color = pass.depth = true;
  View view;
  view.name = "CAM/view";
  view.reason = "camera CAM is due";
  view.width_px = 64;
  view.height_px = 48;
  pass.views = {view};
  FrameCounters counters;
  counters.draws = 12;
  counters.bytes_read_back = 61440;
  const std::string text = explain({{pass}}, {counters});
  CHECK(text.find("pass CAM: 64 x 48, colour and depth\n") != std::string::npos);
  CHECK(text.find("view CAM/view: 64 x 48 at 0 0, near 0.05 m: camera CAM is due\n") != std::string::npos);
  CHECK(text.find("12 draws") != std::string::npos);
  CHECK(text.find("61440 bytes read back") != std::string::npos);
}

TEST_CASE("the progress bar waits a second, and is silent when off") {
  using namespace std::chrono_literals;
  const ProgressBar::Time start{};
  std::ostringstream shown, off;
  {
    ProgressBar bar(shown, true, 8, start), silent(off, false, 8, start);
    bar.update(1, start + 900ms);
    CHECK(shown.str().empty());
    bar.update(2, start + 1000ms);
    CHECK(shown.str().ends_with("] 2 of 8 frames, 3 s left"));
    CHECK(shown.str().find("##########   ") != std::string::npos);
    const std::size_t length = shown.str().size();
    bar.update(3, start + 1100ms);  // too soon after the last
    CHECK(shown.str().size() == length);
    silent.update(4, start + 5s);
  }
  CHECK(shown.str().ends_with("\r\033[K"));
  CHECK(off.str().empty());
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
