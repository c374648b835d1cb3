// The light sensor against photometry: Lambert's law, the inverse square, spots, shadows, walls that reflect.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <simvis/simulation.h>
#include "engine/draw/luminance.h"
#include "engine/light/direct_light.h"
#include "sensors/light_sensor.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// Directions and distances of lights are computed in double from attributes: some ten roundings of 100 lx.
constexpr double kDirect_lx = 100 * 30 * 0x1p-53;
constexpr double kHalfTurn_rad = std::numbers::pi;

constexpr std::string_view kDark =
    "<element type='sky' name='SKY' insert_at='ROOT' ambient_red='0' ambient_green='0' ambient_blue='0'/>";

struct Lit {
  double all_lx, direct_lx, reflected_lx;
};

Lit lit(const std::string& xml) {
  Simulation simulation = Simulation::from_string(xml);
  simulation.step();
  return {simulation.value("L", "illuminance_lx"), simulation.value("L", "direct_lx"),
          simulation.value("L", "reflected_lx")};
}

std::string sensor_at(const std::string& pose, const std::string& attributes = "") {
  return "<sensor type='light_sensor' name='L' insert_at='ROOT' pose_offset='" + pose + "' " + attributes + "/>";
}

TEST_CASE("direct light: laws of Lambert and of the inverse square, spots and ranges") {
  const auto at = [](const Light& light, const glm::dvec3& normal) {
    glm::dmat4 world_from_light(1);
    world_from_light[3] = {0, 0, 2, 1};
    const DirectLight direct = direct_light(light, world_from_light, {0, 0, 0});
    return luminance(direct.irradiance) * std::max(0.0, glm::dot(normal, direct.toward));
  };
  const glm::dvec3 up(0, 0, 1), slanted(0, std::sin(1.0), std::cos(1.0));
  Light sun{.kind = LightKind::directional, .intensity = 100, .direction = {0, 0, -1}};
  CHECK(std::abs(at(sun, up) - 100) <= kDirect_lx);
  CHECK(std::abs(at(sun, slanted) - 100 * std::cos(1.0)) <= kDirect_lx);
  CHECK(at(sun, -up) == 0);
  sun.color = {1, 0, 0};
  CHECK(std::abs(at(sun, up) - 21.26) <= kDirect_lx);
  Light bulb{.kind = LightKind::point, .intensity = 100};
  CHECK(std::abs(at(bulb, up) - 25) <= kDirect_lx);
  bulb.range_m = 4;
  CHECK(std::abs(at(bulb, up) - 25 * (1 - 1.0 / 16)) <= kDirect_lx);
  Light spot{.kind = LightKind::spot, .intensity = 100, .inner_cone_rad = 0.2, .outer_cone_rad = 0.6};
  spot.direction = {0, 0, -1};
  CHECK(std::abs(at(spot, up) - 25) <= kDirect_lx);
  spot.direction = {std::sin(0.4), 0, -std::cos(0.4)};
  const double share = (std::cos(0.4) - std::cos(0.6)) / (std::cos(0.2) - std::cos(0.6));
  CHECK(std::abs(at(spot, up) - 25 * share * share) <= kDirect_lx);
  spot.direction = {1, 0, 0};
  CHECK(at(spot, up) == 0);
}

TEST_CASE("a sensor under an even sky measures pi times its luminance") {
  const Lit seen =
      lit("<element type='sky' name='SKY' insert_at='ROOT' ambient_red='0.5' ambient_green='0.5' "
          "ambient_blue='0.5'/><element type='light' "
          "name='OFF' insert_at='ROOT' intensity='0'/>" +
          sensor_at("0 0 0 0 -30 50"));
  // Luminances are float32; the weights add up to pi.
  CHECK(std::abs(seen.all_lx - kHalfTurn_rad / 2) <= kHalfTurn_rad / 2 * 0x1p-22);
  CHECK(seen.direct_lx == 0);
}

// A wall of 40 m x 40 m fills the hemisphere of a sensor 1 cm in front of it, except what is seen beyond its edges: a
// share of (0.01 / 20)^2 in the measure of cosines. Pixels at the horizon of the hemisphere are half wall, half dark.
TEST_CASE("a white wall that is lit with E reflects E onto a sensor close to it") {
  const std::string wall =
      "<part name='WALL' shape='box' size='0.25 40 40' color='1 1 1' insert_at='ROOT' "
      "pose_offset='1.125 0 0 0 0 0'/>";
  const std::string sun =
      "<part name='AT' insert_at='ROOT'/><element type='light' name='SUN' insert_at='AT' "
      "intensity='100' azimuth='180' elevation='0'/>";
  const Lit seen = lit(std::string(kDark) + wall + sun + sensor_at("0.99 0 0 0 0 0"));
  CHECK(std::abs(seen.reflected_lx - 100) <= 100 * 0.005);
  CHECK(seen.direct_lx == 0);  // the light comes from behind the sensor
  // From 20 m away, on the axis of a disk of the same solid angle the share would be sin^2; of a square plate seen
  // under half its side, the form factor from a point to a parallel square is 4 times that of a quarter in the corner:
  // (2 / pi) * 2 * (a / sqrt(1 + a^2)) * atan(a / sqrt(1 + a^2)) with a = half side / distance.
  const double a = 1 / std::sqrt(2.0), form = 4 / kHalfTurn_rad * a * std::atan(a);
  const Lit far = lit(std::string(kDark) + wall + sun + sensor_at("-19 0 0 0 0 0", "resolution='128'"));
  CHECK(std::abs(far.reflected_lx - 100 * form) <= 100 * 0.01);
  // Turned away, it sees nothing but the light.
  const Lit away = lit(std::string(kDark) + wall + sun + sensor_at("-19 0 0 0 0 180"));
  CHECK(std::abs(away.direct_lx - 100) <= kDirect_lx);
  CHECK(away.reflected_lx == 0);
}

TEST_CASE("a light that casts shadows does not shine through things, any other does") {
  const auto scene = [](const std::string& shadows) {
    return std::string(kDark) +
           "<part name='ROOF' shape='box' size='2 2 0.25' insert_at='ROOT' pose_offset='0 0 2 0 0 0'/><part "
           "name='LAMP' "
           "insert_at='ROOT' pose_offset='0 0 4 0 0 0'/><element type='light' name='BULB' insert_at='LAMP' "
           "kind='point' "
           "intensity='160' " +
           shadows + "/>" + sensor_at("0 0 0 0 -90 0");
  };
  CHECK(lit(scene("shadows='no'")).direct_lx == doctest::Approx(10).epsilon(1e-12));
  CHECK(lit(scene("shadows='yes'")).direct_lx == 0);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
