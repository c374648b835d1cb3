// SDF's sensors that give rows of numbers.
#include <doctest/doctest.h>

#include "tests/support/error_of.h"
#include "tests/support/sdf_scene.h"

TEST_SUITE_BEGIN("import");

namespace simvis::test {
namespace {

std::string sensing(const std::string& type, const std::string& content) {
  return "<model name='m'><link name='l'>" + sdf_box("1 1 1") + "<sensor name='s' type='" + type +
         "'><pose>1 2 3 0 0 0</pose><update_rate>20</update_rate>" + content + "</sensor></link></model>";
}

TEST_CASE("an IMU has the world's gravity, and the noise of its first axis") {
  const std::string noise =
      "<x><noise type='gaussian'><mean>0.5</mean><stddev>0.01</stddev><bias_mean>0.25</bias_mean>"
      "<bias_stddev>0.02</bias_stddev><dynamic_bias_stddev>0.003</dynamic_bias_stddev>"
      "<dynamic_bias_correlation_time>400</dynamic_bias_correlation_time><precision>0.001</precision></noise></x>";
  SdfScene scene(sdf_world("<gravity>0 0 -3.7</gravity>" +
                           sensing("imu", "<imu><angular_velocity>" + noise + "</angular_velocity></imu>")));
  REQUIRE(scene.built().sensors.size() == 1);
  const std::string name = "m/l/s";
  CHECK(scene.sensor(name, "type") == "imu");
  CHECK(scene.sensor(name, "gravity") == "0 0 -3.7");
  CHECK(scene.sensor(name, "rate") == "20");
  CHECK(scene.sensor(name, "pose_offset") == "1 2 3");
  CHECK(scene.sensor(name, "gyroscope_stddev") == "0.01");
  CHECK(scene.sensor(name, "gyroscope_bias_mean") == "0.75");
  CHECK(scene.sensor(name, "gyroscope_bias_stddev") == "0.02");
  CHECK(scene.sensor(name, "gyroscope_dynamic_bias_stddev") == "0.003");
  CHECK(scene.sensor(name, "gyroscope_dynamic_bias_correlation_time") == "400");
  CHECK(scene.sensor(name, "gyroscope_precision") == "0.001");
  CHECK(scene.sensor(name, "accelerometer_stddev").empty());
  REQUIRE(scene.warnings().size() == 1);
  CHECK(contains(scene.warnings()[0], "noise of a sensor's axis that differs from that of x"));
}

TEST_CASE("GNSS, magnetometer, barometer and altimeter") {
  const std::string noise = "<noise type='gaussian'><stddev>0.5</stddev></noise>";
  const std::string world =
      "<spherical_coordinates><latitude_deg>48</latitude_deg><longitude_deg>11</longitude_deg>"
      "<elevation>520</elevation><heading_deg>30</heading_deg></spherical_coordinates>"
      "<magnetic_field>1e-5 2e-5 -4e-5</magnetic_field>";
  for (const char* const type : {"navsat", "gps"}) {
    SdfScene scene(sdf_world(world + sensing(type, "<" + std::string(type) + "><position_sensing><vertical>" + noise +
                                                       "</vertical></position_sensing></" + type + ">")));
    CHECK(scene.sensor("m/l/s", "type") == "gnss");
    CHECK(scene.sensor("m/l/s", "latitude") == "48");
    CHECK(scene.sensor("m/l/s", "elevation") == "520");
    CHECK(scene.sensor("m/l/s", "heading") == "30");
    CHECK(scene.sensor("m/l/s", "vertical_stddev") == "0.5");
    CHECK(scene.warnings().empty());
  }
  SdfScene field(sdf_world(world + sensing("magnetometer", "")));
  CHECK(field.sensor("m/l/s", "field") == "1e-05 2e-05 -4e-05");
  SdfScene air(
      sdf_world(sensing("air_pressure", "<air_pressure><reference_altitude>123</reference_altitude><pressure>" + noise +
                                            "</pressure></air_pressure>")));
  CHECK(air.sensor("m/l/s", "type") == "barometer");
  CHECK(air.sensor("m/l/s", "elevation") == "123");
  CHECK(air.sensor("m/l/s", "stddev") == "0.5");
  SdfScene height(
      sdf_world(sensing("altimeter", "<altimeter><vertical_velocity>" + noise + "</vertical_velocity></altimeter>")));
  CHECK(height.sensor("m/l/s", "vertical_velocity_stddev") == "0.5");
  CHECK(height.sensor("m/l/s", "vertical_position_stddev").empty());
}

TEST_CASE("a wrong noise leaves the sensor out, with its place") {
  SdfScene scene(sdf_world(sensing("altimeter",
                                   "<altimeter><vertical_velocity><noise type='gaussian'><stddev>-1</stddev>"
                                   "</noise></vertical_velocity></altimeter>")));
  CHECK(scene.built().sensors.empty());
  REQUIRE(scene.warnings().size() == 1);
  CHECK(contains(scene.warnings()[0], "element <stddev> is -1, expected a finite number that is not negative"));
  CHECK(contains(scene.warnings()[0], "the sensor is left out"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
