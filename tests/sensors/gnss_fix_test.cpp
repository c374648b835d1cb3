// Positions from pseudoranges, and the nominal constellation, without a scene.
#include <doctest/doctest.h>

#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <tuple>
#include <vector>

#include <simvis/philox.h>
#include "sensors/navigation/position_fix.h"
#include "sensors/navigation/satellites.h"
#include "tests/sensors/sky_point.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

using test::SkyPoint;

std::vector<Pseudorange> cross_and_zenith(double elevation_deg, double north_error_m) {
  std::vector<Pseudorange> all;
  for (const double azimuth_deg : {0, 90, 180, 270}) {
    all.push_back({SkyPoint{azimuth_deg, elevation_deg}.along(), azimuth_deg == 0 ? north_error_m : 0});
  }
  all.push_back({{0, 0, 1}, 0});
  return all;
}

TEST_CASE("the fix of four satellites in a cross and one above is that of the closed form") {
  constexpr double kRounding = 1e-13;  // some hundred roundings of numbers of about 1
  for (const double elevation_deg : {10.0, 30.0, 55.0}) {
    const double c = std::cos(glm::radians(elevation_deg)), s = std::sin(glm::radians(elevation_deg)), error_m = 7;
    const auto fix = fix_position(cross_and_zenith(elevation_deg, error_m));
    REQUIRE(fix);
    CHECK(fix->hdop() == doctest::Approx(1 / c).epsilon(kRounding));
    CHECK(fix->vdop() == doctest::Approx(std::sqrt(5.0) / (2 * (1 - s))).epsilon(kRounding));
    CHECK(std::abs(fix->error_m.x) <= error_m * kRounding);
    CHECK(fix->error_m.y == doctest::Approx(-error_m / (2 * c)).epsilon(kRounding));
    CHECK(fix->error_m.z == doctest::Approx(error_m / (4 * (1 - s))).epsilon(kRounding));
    // An error of the clock is no error of the place.
    std::vector<Pseudorange> late = cross_and_zenith(elevation_deg, 0);
    for (Pseudorange& each : late) each.error_m = 1000;
    CHECK(glm::length(fix_position(late)->error_m) <= 1e4 * kRounding);
  }
}

// Random skies of `count` satellites with errors of a few metres.
std::vector<Pseudorange> random_sky(std::uint64_t number, std::uint32_t count) {
  const SensorRandom random(5, "sky");
  std::vector<Pseudorange> all;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto normal = [&](std::uint32_t draw) { return random.gaussian(number, i, draw); };
    glm::dvec3 to(normal(0), normal(1), std::abs(normal(2)) + 0.1);
    all.push_back({glm::normalize(to), 5 * normal(3)});
  }
  return all;
}

TEST_CASE("dilutions are those of the matrix of four unknowns, and fixes solve the distances themselves") {
  int tried = 0;
  for (std::uint64_t number = 0; number < 200; ++number) {
    const std::vector<Pseudorange> sky = random_sky(number, 4 + number % 9);
    const auto fix = fix_position(sky);
    if (!fix || fix->pdop() > 30) continue;
    ++tried;
    glm::dmat4 normal(0);
    for (const Pseudorange& each : sky) {
      const glm::dvec4 row(-each.direction, 1);
      normal += glm::outerProduct(row, row);
    }
    const glm::dmat4 inverse = glm::inverse(normal);
    // The condition of the matrix is at most the square of the dilution times its trace, 900 x 24.
    constexpr double kRounding = 900 * 24 * 16 * 0x1p-53;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        CHECK(std::abs(fix->cofactors[i][j] - inverse[i][j]) <= kRounding * fix->pdop() * fix->pdop());
      }
    }
    // Satellites at 20,000 km: three steps of Gauss and Newton from the true place.
    constexpr double kFar_m = 2e7;
    glm::dvec4 x(0);
    for (int step = 0; step < 3; ++step) {
      glm::dmat4 of_step(0);
      glm::dvec4 right(0);
      for (const Pseudorange& each : sky) {
        const glm::dvec3 way = kFar_m * each.direction - glm::dvec3(x);
        const glm::dvec4 row(-glm::normalize(way), 1);
        of_step += glm::outerProduct(row, row);
        right += row * (kFar_m + each.error_m - glm::length(way) - x.w);
      }
      x += glm::inverse(of_step) * right;
    }
    // The distances bend by at most x^2 / 2 R, which counts as an error of each of the pseudoranges; those of 2e7 m
    // round to 4e-9 m.
    const double bend_m = glm::dot(x, x) / (2 * kFar_m) + 1e-8;
    CHECK(glm::distance(fix->error_m, glm::dvec3(x)) <= 2 * fix->pdop() * std::sqrt(double(sky.size())) * bend_m);
  }
  CHECK(tried > 100);
}

TEST_CASE("three satellites, satellites on a cone and in a plane give no fix") {
  std::vector<Pseudorange> three = cross_and_zenith(30, 0);
  three.erase(three.begin(), three.begin() + 2);
  CHECK_FALSE(fix_position(three));
  CHECK_FALSE(fix_position({}));
  std::vector<Pseudorange> cone, plane;
  for (int i = 0; i < 12; ++i) {
    const double turn_deg = 30.0 * i;
    cone.push_back({SkyPoint{turn_deg, 40}.along(), 1});
    plane.push_back({SkyPoint{i < 6 ? 77.0 : 257.0, 14.0 * (i % 6) + 5}.along(), 1});
  }
  CHECK_FALSE(fix_position(cone));
  CHECK_FALSE(fix_position(plane));
}

TEST_CASE("satellites in two directions, several in each, give no fix") {
  // Two eigenvalues of the sum are 0. Where both are rounding, the dilution of their quotients can be below 1.
  const SensorRandom random(4, "directions");
  constexpr std::uint32_t kPairs = 1000;
  std::uint32_t fixes = 0, skies = 0;
  for (std::uint32_t i = 0; i < kPairs; ++i) {
    const auto direction = [&](std::uint32_t draw) {
      return SkyPoint{std::floor(360 * random.uniform(i, 0, draw)), std::floor(90 * random.uniform(i, 1, draw))}
          .along();
    };
    for (std::size_t first = 2; first <= 5; ++first) {
      for (std::size_t second = 2; second <= 5; ++second) {
        std::vector<Pseudorange> sky(first, {direction(0), 1});
        sky.insert(sky.end(), second, {direction(1), 1});
        fixes += fix_position(sky).has_value();
        ++skies;
      }
    }
  }
  CHECK(skies == 16 * kPairs);
  CHECK(fixes == 0);
  // A third direction beside them gives none, a fourth one does.
  std::vector<Pseudorange> sky(5, {SkyPoint{290, 10}.along(), 1});
  sky.push_back({SkyPoint{110, 37}.along(), 1});
  sky.push_back({SkyPoint{200, 60}.along(), 1});
  CHECK_FALSE(fix_position(sky));
  sky.push_back({SkyPoint{20, 80}.along(), 1});
  CHECK(fix_position(sky));
}

// From the reference slots by rotations, in the frame of the earth.
glm::dvec3 slot_m(double node_deg, double argument_deg, double time_s) {
  const double turn_rad_s = std::sqrt(3.986005e14 / std::pow(26559700.0, 3));
  const glm::dvec3 x(1, 0, 0), z(0, 0, 1);
  glm::dmat4 m(1);
  m = glm::rotate(m, glm::radians(node_deg - (18 * 15 + 36 * 0.25 + 14.4 / 240)) - 7.2921151467e-5 * time_s, z);
  m = glm::rotate(m, glm::radians(55.0), x);
  m = glm::rotate(m, glm::radians(argument_deg) + turn_rad_s * time_s, z);
  return glm::dvec3(m * glm::dvec4(26559700.0, 0, 0, 1));
}

TEST_CASE("the nominal constellation moves along its orbits, and gives a fix everywhere at all times") {
  SatellitesDesc desc;
  desc.satellites = "gps";
  const GeodeticOrigin origin{.latitude_deg = 49.44, .longitude_deg = 7.75, .elevation_m = 240};
  const GeographicLib::Geocentric earth = GeographicLib::Geocentric::WGS84();
  // The first slot of plane A and the last one of plane F.
  for (const auto& [number, node, argument] : {std::tuple(1u, 272.847, 268.126), std::tuple(24u, 212.847, 135.346)}) {
    int seen = 0;
    for (double time_s = 0; time_s < 90000; time_s += 1234.5) {
      double x = 0, y = 0, z = 0;
      earth.Forward(origin.latitude_deg, origin.longitude_deg, origin.elevation_m, x, y, z);
      const glm::dvec3 way = glm::normalize(slot_m(node, argument, time_s) - glm::dvec3(x, y, z));
      const double phi = glm::radians(origin.latitude_deg), lambda = glm::radians(origin.longitude_deg);
      const glm::dvec3 up(std::cos(phi) * std::cos(lambda), std::cos(phi) * std::sin(lambda), std::sin(phi)),
          east(-std::sin(lambda), std::cos(lambda), 0);
      const glm::dvec3 expected(glm::dot(way, east), glm::dot(way, glm::cross(up, east)), glm::dot(way, up));
      for (const Satellite& each : satellites_in_sky(desc, origin, glm::dvec3(0), time_s)) {
        if (each.number != number) continue;
        ++seen;
        CHECK(glm::distance(each.direction, expected) <= 1e-13);  // of sums of 3e7 m, rounded to 4e-9 m, at 2e7 m
        CHECK(each.elevation_deg >= 5);
      }
    }
    CHECK(seen > 5);
  }
  // The standard states a PDOP of at most 6 for 98 % of a day. Here: of 500 skies.
  int good = 0, all = 0;
  for (int i = 0; i < 500; ++i, ++all) {
    const GeodeticOrigin place{.latitude_deg = -80.0 + i * 0.32, .longitude_deg = std::fmod(i * 77.7, 360) - 180};
    std::vector<Pseudorange> sky;
    for (const Satellite& each : satellites_in_sky(desc, place, glm::dvec3(0), i * 173.0)) {
      sky.push_back({each.direction, 0});
    }
    CHECK(sky.size() >= 4);
    CHECK(sky.size() <= 13);
    const auto fix = fix_position(sky);
    good += fix && fix->pdop() <= 6;
  }
  CHECK(good >= 0.98 * all);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
