// Radar against the radar equation and true motion; beacons against geometry.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include <simvis/attributes.h>
#include <simvis/simulation.h>
#include "sensors/proximity/radar.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

constexpr double kFrameRate_hz = 50;

Simulation watched(const std::string& xml) {
  SimulationDesc desc;
  desc.rate_hz = kFrameRate_hz;
  return Simulation::from_string(xml, desc);
}

/// A sphere of radius 1 m with its centre at (x, y, 0), below an element `MOVE`.
std::string target(double x, double y) {
  return "<part name='CAR' insert_at='ROOT' pose_offset='" + std::to_string(x) + " " + std::to_string(y) +
         " 0 0 0 0'/><element type='pose' name='MOVE' insert_at='CAR'/><part name='BALL' shape='sphere' radius='1' "
         "insert_at='CAR'/>";
}

std::string radar(const std::string& attributes) {
  return "<sensor type='radar' name='R' insert_at='ROOT' vertical_fov='20' azimuth_resolution='40' "
         "range_resolution='5' speed_resolution='100' angle_step='0.25' " +
         attributes + "/>";
}

TEST_CASE("the radar equation") {
  // 1 W, unit gains, 3 GHz (a wave of 0.0999 m), 10 m2 at 100 m, written out: 1 * 0.0999^2 * 10 / (1984.4 * 10^8) W.
  const RadarDesc desc{.frequency_hz = 3e9, .power_w = 1, .gain_db = 0, .losses_db = 0, .noise_figure_db = 0};
  const double wave_m = 299792458 / 3e9;
  // Ratios, because the tolerance of doctest::Approx is absolute for small numbers.
  const double expected_w = wave_m * wave_m * 10 / (1984.401708 * 1e8);
  CHECK(desc.received_w(10, 100) / expected_w == doctest::Approx(1).epsilon(1e-9));
  // 20 dB of gain count twice, once for each way, and 10 dB of losses once.
  RadarDesc antenna = desc;
  antenna.gain_db = 20;
  antenna.losses_db = antenna.noise_figure_db = 10;
  CHECK(antenna.received_w(10, 100) / desc.received_w(10, 100) == doctest::Approx(1e4 / 10).epsilon(1e-12));
  CHECK(antenna.noise_w() / desc.noise_w() == doctest::Approx(10).epsilon(1e-12));
  CHECK(desc.received_w(10, 100) / desc.received_w(10, 200) == doctest::Approx(16).epsilon(1e-12));
  // k T0 is -174 dBm / Hz, and 30 dB more in 1 kHz.
  CHECK(10 * std::log10(desc.noise_w() * 1e3) == doctest::Approx(-173.975 + 30).epsilon(1e-5));
}

TEST_CASE("a part returns its cross section, a sphere its projected area") {
  const RadarDesc desc;
  const auto measure = [&](const std::string& attributes, const std::string& column) {
    Simulation simulation = watched(target(20, 0) + radar(attributes));
    simulation.step();
    REQUIRE(simulation.reading("R").rows() == 1);
    return *simulation.reading("R").find(column);
  };
  const double range_m = measure("cross_sections='CAR:10'", "range_m");
  CHECK(range_m > 19);
  CHECK(range_m < 19.6);  // the mean of a hemisphere by area is at 2/3 of its depth at most
  CHECK(measure("cross_sections='CAR:10'", "cross_section_m2") == doctest::Approx(10).epsilon(1e-12));
  // All rays have ranges between 19 m and 20 m, so the power lies between those of the equation for them.
  const double snr_db = measure("cross_sections='CAR:10'", "snr_db");
  CHECK(snr_db <= 10 * std::log10(desc.received_w(10, 19) / desc.noise_w()));
  CHECK(snr_db >= 10 * std::log10(desc.received_w(10, 20) / desc.noise_w()));
  // The cone of rays that meet the sphere has the solid angle pi sin^2 / 4 ... its area, taken at each range, lies
  // between pi (19 m)^2 / (20 m)^2 and pi; counting cells at the rim is off by their number along it, 4 of 100.
  const double area = measure("", "cross_section_m2");
  CHECK(area <= std::numbers::pi * 1.04);
  CHECK(area >= std::numbers::pi * 0.9 * 0.96);
  CHECK(measure("reflectivity='0.5'", "cross_section_m2") == doctest::Approx(area / 2).epsilon(1e-12));
}

TEST_CASE("a target that is too weak, too near or too far is not detected") {
  const auto rows = [](const std::string& attributes) {
    Simulation simulation = watched(target(20, 0) + radar(attributes));
    simulation.step();
    return simulation.reading("R").rows();
  };
  CHECK(rows("") == 1);
  CHECK(rows("range_max='18'") == 0);
  CHECK(rows("range_min='21'") == 0);
  const RadarDesc desc;
  // The cross section at which the echo from 20 m equals the threshold; at 19 m it is 0.9 dB stronger.
  const double least = std::pow(10, desc.threshold_db / 10) * desc.noise_w() / desc.received_w(1, 20);
  CHECK(rows("cross_sections='CAR:" + format_number(least * 1.01) + "'") == 1);
  CHECK(rows("cross_sections='CAR:" + format_number(least * 0.81) + "'") == 0);
}

TEST_CASE("radial speeds are those of true motion, of the target and of the radar") {
  Simulation simulation = watched(
      target(20, 0) +
      "<part name='OWN' insert_at='ROOT'/><element type='pose' name='DRIVE' insert_at='OWN'/>"
      "<sensor type='radar' name='R' insert_at='OWN' vertical_fov='20' azimuth_resolution='40' range_resolution='5' "
      "speed_resolution='100' angle_step='0.5'/>");
  for (int i = 0; i < 3; ++i) {
    simulation.set("MOVE", "x", -0.2 * i);  // 10 m/s towards the radar
    simulation.set("MOVE", "y", 0.3 * i);
    simulation.set("DRIVE", "x", 0.1 * i);  // 5 m/s towards the target
    simulation.step();
    if (i == 0) CHECK(*simulation.reading("R").find("radial_speed_m_s") == 0);
  }
  // Rays to the sphere lie within 1/19.4 + 0.6/19.4 rad of the axis; sideways motion of 15 m/s then counts by up to
  // this share, and most of it cancels: the centre of the sphere is 0.6 m / 19.4 m to the side.
  CHECK(std::abs(*simulation.reading("R").find("radial_speed_m_s") - (-15 + 15 * 0.6 / 19.4)) <= 0.1);
  CHECK(simulation.diagnostics().motions_followed() > 0);
}

TEST_CASE("a turning wheel spreads in speed, and cells part it") {
  Simulation simulation = watched(
      "<part name='HUB' insert_at='ROOT' pose_offset='20 0 0 0 0 0'/><element type='joint' name='SPIN' insert_at='HUB' "
      "axis='0 0 1' lower='-1e6' upper='1e6'/><part name='BAR' shape='box' size='0.5 4 1' insert_at='HUB'/>"
      "<sensor type='radar' name='R' insert_at='ROOT' vertical_fov='6' angle_step='0.25' speed_resolution='2' "
      "azimuth_resolution='1'/>");
  for (int i = 0; i < 2; ++i) {
    simulation.set("SPIN", "value", glm::degrees(3.0 / kFrameRate_hz * (i - 1)));  // 3 rad/s, straight at the end
    simulation.step();
  }
  const Reading& reading = simulation.reading("R");
  REQUIRE(reading.rows() >= 5);
  for (std::size_t row = 0; row < reading.rows(); ++row) {
    const double azimuth = *reading.find("azimuth_rad", row), range = *reading.find("range_m", row);
    // The point at (x, y) moves along x with -3 y.
    const double y = range * std::sin(azimuth),
                 expected = -3 * y * std::cos(azimuth) + 3 * (range - 20) * std::sin(azimuth);
    CHECK(std::abs(*reading.find("radial_speed_m_s", row) - expected) <= 0.1);
    CHECK(*reading.find("x_m", row) == doctest::Approx(range * std::cos(azimuth)).epsilon(1e-3));
  }
}

TEST_CASE("the bias is that of the radar, alike in all rows, and white noise is of each row") {
  // Two balls, one behind the other by two cells of range.
  const std::string scene = target(20, 0) +
                            "<part name='FAR' shape='sphere' radius='1' insert_at='ROOT' "
                            "pose_offset='40 8 0 0 0 0'/>";
  const auto ranges_m = [&](const std::string& noise) {
    Simulation simulation = watched(scene + radar(noise));
    simulation.step();
    const Reading reading = simulation.reading("R");
    REQUIRE(reading.rows() == 2);
    return std::pair(*reading.find("range_m", 0), *reading.find("range_m", 1));
  };
  const auto [near_m, far_m] = ranges_m("");
  const auto [near_biased_m, far_biased_m] = ranges_m("range_bias_stddev='0.3'");
  CHECK(near_biased_m != near_m);
  CHECK(near_biased_m - near_m == doctest::Approx(far_biased_m - far_m).epsilon(1e-12));
  const auto [near_noisy_m, far_noisy_m] = ranges_m("range_stddev='0.3'");
  CHECK(near_noisy_m != near_m);
  CHECK(std::abs((near_noisy_m - near_m) - (far_noisy_m - far_m)) > 1e-6);
}

TEST_CASE("a radar that sees all around has one row for what is behind it") {
  for (const char* resolution : {"30", "50"}) {  // 12 cells, and 8 of 45 degrees
    CAPTURE(resolution);
    Simulation simulation = watched(target(-20, 0) +
                                    "<sensor type='radar' name='R' insert_at='ROOT' horizontal_fov='360' "
                                    "vertical_fov='20' azimuth_resolution='" +
                                    std::string(resolution) +
                                    "' range_resolution='5' speed_resolution='100' angle_step='0.5' "
                                    "cross_sections='CAR:10'/>");
    simulation.step();
    const Reading reading = simulation.reading("R");
    REQUIRE(reading.rows() == 1);
    // The ball is seen under asin(1 / 20) to both sides, in columns of half a degree.
    CHECK(std::abs(*reading.find("azimuth_rad")) >= std::numbers::pi - std::numbers::pi / 360);
    CHECK(std::abs(*reading.find("azimuth_rad")) <= std::numbers::pi);
    CHECK(*reading.find("cross_section_m2") == doctest::Approx(10).epsilon(1e-12));
  }
}

TEST_CASE("a noisy range is at least 0") {
  Simulation simulation = watched(target(20, 0) +
                                  "<sensor type='range' name='BEAM' insert_at='ROOT' range_max='100' stddev='100'/>"
                                  "<sensor type='sonar' name='SONAR' insert_at='ROOT' range_max='100' threshold='1e-9' "
                                  "stddev='100'/>" +
                                  radar("range_stddev='100'"));
  int zeros = 0;
  for (int frame = 0; frame < 40; ++frame) {
    simulation.step();
    for (const char* name : {"BEAM", "SONAR", "R"}) {
      const double range_m = simulation.reading(name).find("range_m").value();
      CHECK(range_m >= 0);
      zeros += range_m == 0;
    }
  }
  CHECK(zeros > 0);
}

TEST_CASE("cross sections that make no sense") {
  const auto refused = [](const std::string& text) {
    return error_of([&] { watched(radar("cross_sections='" + text + "'")); });
  };
  for (const char* wrong : {"CAR", "CAR:", "CAR:-1", "CAR:0", ":5", "CAR:ten"}) {
    CHECK(contains(refused(wrong), "expected NAME:SQUARE_METRES with a number above 0"));
  }
  CHECK(contains(error_of([] { watched("<sensor type='radar' name='R' insert_at='ROOT' angle_step='1e-9'/>"); }),
                 "expected a larger angle"));
  Simulation unknown = watched(target(20, 0) + radar("cross_sections='CRA:3'"));
  REQUIRE(unknown.warnings().size() >= 1);
  CHECK(contains(unknown.warnings().back(), "sensor \"R\": there is no part or link \"CRA\", did you mean \"CAR\"?"));
  unknown.step();
  CHECK(unknown.reading("R").rows() == 1);
}

TEST_CASE("beacons are received where geometry says so") {
  const auto scene = [](const std::string& attributes) {
    return std::string(R"(
      <part name="TAG_A" insert_at="ROOT" pose_offset="3 4 0 0 0 0"/>
      <part name="TAG_B" insert_at="ROOT" pose_offset="0 0 2 0 0 0"/>
      <part name="TAG_C" insert_at="ROOT" pose_offset="8 0 0 0 0 0"/>
      <element type="visibility" name="NOT_A_SWITCH" insert_at="TAG_C"/>
      <part name="OTHER" insert_at="ROOT" pose_offset="1 0 0 0 0 0"/>
      <part name="SCREEN" shape="box" size="0.25 2 2" insert_at="ROOT" pose_offset="6 0 0 0 0 0"/>
      <sensor type="beacon" name="B" insert_at="ROOT" beacons="TAG_*" )") +
           attributes + "/>";
  };
  const auto numbers = [&](const std::string& attributes) {
    Simulation simulation = watched(scene(attributes));
    simulation.step();
    std::string text;
    const Reading& reading = simulation.reading("B");
    for (std::size_t row = 0; row < reading.rows(); ++row) text += std::to_string(int(*reading.find("beacon", row)));
    return text;
  };
  CHECK(numbers("") == "01");
  CHECK(numbers("line_of_sight='no'") == "012");
  CHECK(numbers("range_max='4'") == "1");
  CHECK(numbers("opening='120'") == "0");
  CHECK(numbers("opening='100'") == "");
  CHECK(numbers("radius='3'") == "012");
  Simulation simulation = watched(scene(""));
  simulation.step();
  const Reading& reading = simulation.reading("B");
  CHECK(*reading.find("range_m") == 5);
  CHECK(*reading.find("azimuth_rad") == std::atan2(4.0, 3.0));
  CHECK(*reading.find("elevation_rad", 1) == std::numbers::pi / 2);
  CHECK(*reading.find("strength", 1) == 0.25);
  CHECK(std::get<std::string>(simulation.sensors().at(0).report.notes.at(0).value) == "0: TAG_A, 1: TAG_B");
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
