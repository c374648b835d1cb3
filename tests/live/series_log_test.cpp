// The numbers that graphs of a recorded page show.
#include "program/live/series_log.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

using Json = nlohmann::json;

const std::string kMovedScene = R"(
  <part name="BODY" insert_at="ROOT" shape="sphere" radius="0.1"/>
  <element type="pose" name="MOVE" insert_at="BODY" x="0.5"/>
  <sensor type="imu" name="IMU" insert_at="BODY"/>)";

TEST_CASE("parameters are noted when they change, numbers of sensors each time, and constants not at all") {
  Simulation simulation = Simulation::from_string(kMovedScene);
  ViewCopier copier;
  SeriesLog log;
  for (const double x : {0.5, 0.5, 0.75, 0.75}) {
    simulation.set("MOVE", "x", x);
    const FrameTime time = simulation.next_frame();
    simulation.step();
    log.add(copier.copy(simulation, time, 0, {.every_sensor = true}));
  }
  const Json message = Json::parse(log.message());
  CHECK(message["op"] == "series");
  Json found, measured;
  for (const Json& each : message["series"]) {
    if (each["owner"] == "MOVE") {
      CHECK(found.is_null());  // the other parameters are constant
      found = each;
    }
    if (each["owner"] == "IMU" && measured.is_null()) measured = each;
  }
  REQUIRE(found.is_object());
  CHECK(found["name"] == "x");
  CHECK(found["unit"] == "m");
  CHECK(found["steps"] == true);
  REQUIRE(found["points"].size() == 2);
  CHECK(found["points"][0] == Json::parse("[0.0, 0.5]"));
  CHECK(found["points"][1][1] == 0.75);
  REQUIRE(measured.is_object());
  CHECK(measured["steps"] == false);
  CHECK(measured["points"].size() == 4);
}

TEST_CASE("of a long run, a series has a limited number of evenly spaced points, and the last one") {
  Simulation simulation = Simulation::from_string(kMovedScene);
  ViewCopier copier;
  SeriesLog log;
  const FrameTime time = simulation.next_frame();
  simulation.step();
  ViewFrame frame = copier.copy(simulation, time, 0, {.every_sensor = true});
  constexpr std::int64_t kFrames = 40'000, kSpacing = 4;  // 20,000 would be more than are kept, 10,000 are not
  for (std::int64_t i = 0; i < kFrames; ++i) {
    frame.time_ns = i * 1'000'000'000;
    log.add(frame);
  }
  std::size_t series = 0;
  const Json message = Json::parse(log.message());
  for (const Json& each : message["series"]) {
    if (each["owner"] != "IMU") continue;
    ++series;
    const Json& points = each["points"];
    REQUIRE(points.size() == kFrames / kSpacing + 1);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) REQUIRE(points[i][0] == static_cast<double>(i * kSpacing));
    CHECK(points.back()[0] == static_cast<double>(kFrames - 1));
  }
  CHECK(series > 0);
}

}  // namespace
}  // namespace simvis::live

TEST_SUITE_END();
