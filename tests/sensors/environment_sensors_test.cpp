// Magnetometer, barometer and altimeter against published values.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include <simvis/simulation.h>
#include "sensors/navigation/barometer.h"
#include "sensors/navigation/magnetometer.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

Simulation measured_once(const std::string& xml) {
  Simulation simulation = Simulation::from_string(xml);
  simulation.step();
  return simulation;
}

TEST_CASE("a magnetometer turns in the given field") {
  const Simulation simulation = measured_once(
      "<sensor type='magnetometer' name='M' insert_at='ROOT' field='0 2e-5 -4e-5' pose_offset='0 0 0 0 0 90'/>");
  CHECK(std::abs(simulation.value("M", "field_x_t") - 2e-5) <= 1e-20);
  CHECK(std::abs(simulation.value("M", "field_y_t")) <= 1e-20);
  CHECK(std::abs(simulation.value("M", "field_z_t") + 4e-5) <= 1e-20);
}

TEST_CASE("the dipole has the poles and the strength of the earth's") {
  // The geomagnetic north pole of the IGRF-13 in 2020 is at 80.65 N, 72.68 W (World Data Center Kyoto). The field there
  // is vertical; its strength is 2 * 29806 nT (6371.2 km / distance)^3, which at that latitude's 6357.4 km is 59,999
  // nT. The place is given to 0.005 degrees, geocentric and geodetic latitude differ by 0.06 degrees.
  const GeodeticOrigin pole{.latitude_deg = 80.65, .longitude_deg = -72.68};
  const glm::dvec3 there = dipole_field_t(pole, {0, 0, 0});
  CHECK(std::hypot(there.x, there.y) <= 60e-6 * 0.0025);
  CHECK(there.z == doctest::Approx(-59999e-9).epsilon(1e-3));
  // On the equator of the dipole the field is level and half as strong; it points to the pole.
  const GeodeticOrigin level{.latitude_deg = 0, .longitude_deg = -72.68 + 90};
  const glm::dvec3 field = dipole_field_t(level, {0, 0, 0});
  CHECK(std::abs(field.z) <= 30e-6 * 0.005);
  CHECK(glm::length(field) == doctest::Approx(29806e-9 * std::pow(6371.2 / 6378.137, 3)).epsilon(1e-3));
  CHECK(field.y > 0);
  // A heading turns the world, and height weakens the field with the third power.
  GeodeticOrigin turned = level;
  turned.heading_rad = std::acos(0.0);
  CHECK(glm::length(dipole_field_t(turned, {0, 0, 0}) - glm::dvec3(field.y, -field.x, field.z)) <= 1e-18);
  CHECK(glm::length(dipole_field_t(level, {0, 0, 100e3})) / glm::length(field) ==
        doctest::Approx(std::pow(6378.137 / 6478.137, 3)).epsilon(1e-4));
}

// ISO 2533:1975, table 5: geometric heights.
TEST_CASE("the standard atmosphere has the pressures of its table") {
  CHECK(standard_pressure_pa(0, 101325) == 101325);
  CHECK(standard_pressure_pa(1000, 101325) == doctest::Approx(89876.3).epsilon(1e-5));
  CHECK(standard_pressure_pa(5000, 101325) == doctest::Approx(54048.3).epsilon(1e-5));
  CHECK(standard_pressure_pa(11000, 101325) == doctest::Approx(22699.9).epsilon(1e-5));
  CHECK(standard_pressure_pa(15000, 101325) == doctest::Approx(12111.8).epsilon(1e-5));
  for (const double height_m : {-400.0, 0.0, 1200.0, 10999.0, 11500.0, 19000.0}) {
    CHECK(pressure_height_m(standard_pressure_pa(height_m, 99000), 99000) == doctest::Approx(height_m).epsilon(1e-9));
  }
}

TEST_CASE("a barometer in the weather, and an altimeter above its reference") {
  Simulation simulation = Simulation::from_string(R"(
    <part name="DRONE" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="DRONE"/>
    <sensor type="barometer" name="B" insert_at="DRONE" elevation="240" sea_level_pressure="100000"/>
    <sensor type="barometer" name="OFF" insert_at="DRONE" bias_mean="-2e5"/>
    <sensor type="altimeter" name="A" insert_at="DRONE" reference="1.5"/>)",
                                                  {.rate_hz = 10, .device = {}, .overrides = {}});
  for (int i = 0; i < 3; ++i) {
    simulation.set("MOVE", "z", 4.0 * i);
    simulation.step();
  }
  CHECK(simulation.value("B", "pressure_pa") == standard_pressure_pa(248, 100000));
  CHECK(simulation.value("B", "altitude_m") > 350);  // low pressure reads as height
  CHECK(std::isnan(simulation.value("OFF", "altitude_m")));
  CHECK(simulation.value("A", "vertical_position_m") == 6.5);
  CHECK(simulation.value("A", "vertical_velocity_m_s") == doctest::Approx(40).epsilon(1e-12));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
