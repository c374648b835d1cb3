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

glm::dvec3 dipole_t(const GeodeticOrigin& origin, const glm::dvec3& point_m) {
  return earth_field_t(MagneticField::dipole, origin, 0, point_m);
}

TEST_CASE("the World Magnetic Model has its published values") {
  struct Published {
    double latitude_deg, longitude_deg, height_m, year;
    glm::dvec3 east_north_up_nt;
  };
  // The package pygeomag 1.1.0 from the same coefficients; it gives the test values of the model's report.
  const Published values[] = {
      {49.44, 7.75, 250, 2025, {1170.5, 20419.6, -44374.9}},   {80, 0, 0, 2025, {145.9, 6521.6, -54791.5}},
      {0, 120, 0, 2025, {-109.6, 39677.8, 10580.2}},           {-80, -120, 0, 2025, {15751.9, 6117.5, 52022.5}},
      {80, 0, 100000, 2027.5, {233.8, 6196.7, -52670.5}},      {0, 120, 100000, 2027.5, {-148.7, 37711.5, 9969.8}},
      {-80, -120, 100000, 2027.5, {14760.1, 5984.0, 49317.7}}, {-33.9, 18.4, 1500, 2029.5, {-4963.8, 9583.3, 22343.3}}};
  constexpr double kPrinted_nt = 0.06;  // one digit after the point, and two sums of doubles
  for (const Published& each : values) {
    const GeodeticOrigin place{
        .latitude_deg = each.latitude_deg, .longitude_deg = each.longitude_deg, .elevation_m = each.height_m};
    const glm::dvec3 field_nt = 1e9 * earth_field_t(MagneticField::wmm2025, place, each.year, {0, 0, 0});
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(std::abs(field_nt[axis] - each.east_north_up_nt[axis]) <= kPrinted_nt);
    }
  }
  // A pole has no meridian of its own: its field is that of a place 10 m away, where it changes by less than 1 nT.
  const auto near_pole = [](double latitude_deg) {
    return 1e9 * earth_field_t(MagneticField::wmm2025, {.latitude_deg = latitude_deg}, 2026, {0, 0, 0});
  };
  CHECK(glm::length(near_pole(90) - near_pole(89.9999)) <= 1);
  const Simulation simulation = measured_once(
      "<sensor type='magnetometer' name='M' insert_at='ROOT' model='wmm2025' year='2027.5' latitude='80' "
      "elevation='100000'/>");
  CHECK(std::abs(simulation.value("M", "field_z_t") + 52670.5e-9) <= kPrinted_nt * 1e-9);
}

TEST_CASE("the dipole has the poles and the strength of the earth's") {
  // The geomagnetic north pole of the IGRF-13 in 2020 is at 80.65 N, 72.68 W (World Data Center Kyoto). The field there
  // is vertical; its strength is 2 * 29806 nT (6371.2 km / distance)^3, which at that latitude's 6357.4 km is 59,999
  // nT. The place is given to 0.005 degrees, geocentric and geodetic latitude differ by 0.06 degrees.
  const GeodeticOrigin pole{.latitude_deg = 80.65, .longitude_deg = -72.68};
  const glm::dvec3 there = dipole_t(pole, {0, 0, 0});
  CHECK(std::hypot(there.x, there.y) <= 60e-6 * 0.0025);
  CHECK(std::abs(there.z + 59999e-9) <= 1e-3 * 59999e-9);
  // On the equator of the dipole the field is level and half as strong; it points to the pole.
  const GeodeticOrigin level{.latitude_deg = 0, .longitude_deg = -72.68 + 90};
  const glm::dvec3 field = dipole_t(level, {0, 0, 0});
  CHECK(std::abs(field.z) <= 30e-6 * 0.005);
  const double level_t = 29806e-9 * std::pow(6371.2 / 6378.137, 3);
  CHECK(std::abs(glm::length(field) - level_t) <= 1e-3 * level_t);
  CHECK(field.y > 0);
  // A heading turns the world, and height weakens the field with the third power.
  GeodeticOrigin turned = level;
  turned.heading_rad = std::acos(0.0);
  CHECK(glm::length(dipole_t(turned, {0, 0, 0}) - glm::dvec3(field.y, -field.x, field.z)) <= 1e-18);
  CHECK(glm::length(dipole_t(level, {0, 0, 100e3})) / glm::length(field) ==
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

TEST_CASE("a barometer above the limits of its formulas reads the pressure at them") {
  for (const auto& [height, limit] : {std::pair{"-1e6", -5000.0}, std::pair{"1e6", 80000.0}}) {
    const Simulation simulation = measured_once("<sensor type='barometer' name='B' insert_at='ROOT' pose_offset='0 0 " +
                                                std::string(height) + " 0 0 0'/>");
    CHECK(simulation.value("B", "pressure_pa") == standard_pressure_pa(limit, 101325));
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
