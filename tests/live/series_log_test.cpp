// The numbers that graphs of a recorded page show.
#include "live/series_log.h"

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

}  // namespace
}  // namespace simvis::live

TEST_SUITE_END();
