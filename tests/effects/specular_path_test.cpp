// Mirrors and panes of glass: ranges compared with unfolded paths, powers with Fresnel's equations, for every engine.
#include "engine/light/surface_shares.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "tests/support/reference_directions.h"
#include "tests/support/scan_effects.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

constexpr double kRoundingUnit = 0x1p-53;

Material mirror(float share = 1) {
  Material material;
  material.mirror = share;
  return material;
}
Material glass(float transmission, float refractive_index = 1.5f) {
  Material material;
  material.transmission = transmission;
  material.refractive_index = refractive_index;
  return material;
}
Material grey(float reflectance) {
  Material material;
  material.base_color = glm::vec4(reflectance, reflectance, reflectance, 1);
  return material;
}

// A plate of 100 x 100 m across x, y or z.
Mesh across(int axis) {
  glm::dvec3 half(0), other(0);
  half[(axis + 1) % 3] = 50;
  other[(axis + 2) % 3] = 50;
  return plate_mesh(half, other);
}

std::vector<ChosenScanEffect> depth(int turns) {
  return effects_of("path_depth='" + std::to_string(turns) + "'", "specular_path");
}

glm::dvec3 toward(double azimuth_rad, double elevation_rad = 0) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::sin(elevation_rad)};
}

// Uncertainty from rounding of directions and world coordinates in a scene of about 100 m. The error bound has to cover
// the true range and must be small enough to be useful.
constexpr double kUsefulBound_m = 1e-8;

void check_range(const Echo& echo, double expected_m) {
  CAPTURE(echo.range_m);
  CAPTURE(expected_m);
  CHECK(std::abs(echo.range_m - expected_m) <= echo.error_bound_m);
  CHECK(echo.error_bound_m <= kUsefulBound_m);
}

}  // namespace

TEST_CASE("a mirror at 45 degrees shows the wall beside it at the unfolded distance") {
  const RayEngine engine = each_engine();
  DrawList list;
  // The plane of the mirror contains (4, 0, 0) and turns +x to +y. The wall is at y = 7, and its image is the plane x =
  // 4 + 7.
  add_item(list, plate_mesh({3, 3, 0}, {0, 0, 50}), at(4, 0, 0), mirror());
  add_item(list, across(1), at(0, 7, 0), grey(0.5f));
  std::vector<glm::dvec3> directions;
  for (int i = -20; i <= 20; ++i) directions.push_back(toward(0.01 * i, 0.013 * i));
  const auto echoes = echoes_of(list, directions, depth(1), *engine.caster);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    REQUIRE(echoes[i].size() == 1);
    const double expected_m = 11 / directions[i].x;
    check_range(echoes[i][0], expected_m);
    // At perpendicular incidence the power would be 0.5 / r^2. The incidence angle on the wall equals that on its
    // image. The power is a product of a few doubles; the reflectance is float32.
    const double power = 0.5 * directions[i].x / (expected_m * expected_m);
    CHECK(std::abs(echoes[i][0].power - power) <= 1e-9 * power);
  }
}

TEST_CASE("the matte share of a mirror returns from the mirror itself, and the share applies in both directions") {
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, plate_mesh({3, 3, 0}, {0, 0, 50}), at(4, 0, 0), mirror(0.75f));
  add_item(list, across(1), at(0, 7, 0), Material());
  const auto echoes = echoes_of(list, {{1, 0, 0}}, depth(3), *engine.caster);
  REQUIRE(echoes[0].size() == 2);
  check_range(echoes[0][0], 4);
  check_range(echoes[0][1], 11);
  CHECK(std::abs(echoes[0][0].power - 0.25 * std::sqrt(0.5) / 16) <= 16 * kRoundingUnit);
  CHECK(std::abs(echoes[0][1].power - 0.75 * 0.75 / 121) <= 1e-9 / 121);
}

TEST_CASE("a beam between two mirrors reaches the end of the corridor if path_depth allows its bounces") {
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, across(1), at(0, 1, 0), mirror());
  add_item(list, across(1), at(0, -1, 0), mirror());
  add_item(list, across(0), at(20, 0, 0), Material());
  std::vector<glm::dvec3> directions;
  std::vector<int> bounces;
  for (const double degrees : {1.0, 4.0, 10.0, 20.0, 33.0}) {
    directions.push_back(toward(degrees * kPi / 180));
    bounces.push_back(static_cast<int>((20 * std::tan(degrees * kPi / 180) + 1) / 2));
  }
  CHECK(bounces == std::vector<int>{0, 1, 2, 4, 6});
  for (int turns = 1; turns <= 8; ++turns) {
    CAPTURE(turns);
    const auto echoes = echoes_of(list, directions, depth(turns), *engine.caster);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      CAPTURE(i);
      REQUIRE(echoes[i].size() == (bounces[i] <= turns ? 1 : 0));
      if (!echoes[i].empty()) check_range(echoes[i][0], 20 / directions[i].x);
    }
  }
}

TEST_CASE("a corner of three mirrors returns every beam in its own direction, wherever the world lies") {
  const RayEngine engine = each_engine();
  for (const double offset_m : {0.0, 1e4}) {
    CAPTURE(offset_m);
    DrawList list;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 place(-45, -44, -43);
      place[axis] = 5 + axis;
      add_item(list, across(axis), at(place.x, place.y, place.z), mirror());
    }
    add_item(list, across(0), at(-3, 0, 0), Material());
    const glm::dmat4 turn = glm::rotate(at(offset_m, -offset_m, 0), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
    for (std::size_t t = 1; t < list.world_from_node.size(); ++t) {
      list.world_from_node[t] = turn * list.world_from_node[t];
    }
    std::mt19937 random(8);
    std::vector<glm::dvec3> local, directions;
    while (local.size() < 120) {
      // Directions into the corner that are not so flat at any mirror that the bound becomes useless.
      const glm::dvec3 d = glm::abs(random_direction(random));
      if (std::min({d.x, d.y, d.z}) < 0.3) continue;
      local.push_back(d);
      directions.push_back(glm::dmat3(turn) * d);
    }
    ScanContext moment;
    moment.range_max_m = 1000;
    for (const int turns : {2, 3}) {
      const auto log = std::make_shared<EchoLog>();
      std::vector<ChosenScanEffect> effects = depth(turns);
      effects.push_back({nullptr, log});
      moment.world_from_sensor = at(offset_m, -offset_m, 0);
      engine.caster->set_world(list);
      TracedScan(directions, effects).trace(moment, list, *engine.caster);
      int wrong = 0, back = 0;
      double worst_bound_m = 0;
      for (std::size_t i = 0; i < local.size(); ++i) {
        // The image of the wall in the mirror x = 5 is at 13. The other two mirrors keep x.
        const double expected_m = 13 / local[i].x;
        const double last_mirror_m = std::max({5 / local[i].x, 6 / local[i].y, 7 / local[i].z});
        if (last_mirror_m > 0.99 * expected_m) continue;  // it hits the wall between two mirrors
        const std::vector<Echo>& echoes = log->log()[i];
        ++back;
        if (turns < 3) {
          wrong += !echoes.empty();
          continue;
        }
        wrong += echoes.size() != 1 || std::abs(echoes[0].range_m - expected_m) > echoes[0].error_bound_m;
        if (echoes.size() == 1) worst_bound_m = std::max(worst_bound_m, echoes[0].error_bound_m);
      }
      CHECK(back > 40);
      CHECK(wrong == 0);
      CHECK(worst_bound_m <= (offset_m > 0 ? 1e-6 : kUsefulBound_m));
    }
  }
}

TEST_CASE("a pane gives two returns at known distances and powers, and counts once where two of its triangles meet") {
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, across(0), at(2, 0, 0), glass(0.8f));
  add_item(list, across(0), at(5, 0, 0), grey(0.5f));
  // The edge between the triangles of the pane runs through its centre.
  std::vector<glm::dvec3> directions{{1, 0, 0}};
  for (int i = 1; i < 40; ++i) {
    directions.push_back(glm::normalize(glm::dvec3(1, 0.05 * i, 0.05 * i)));  // along that edge
    directions.push_back(toward(0.03 * i, 0.01 * i));
  }
  const auto echoes = echoes_of(list, directions, depth(2), *engine.caster);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    CAPTURE(i);
    REQUIRE(echoes[i].size() == 2);
    const double cosine = directions[i].x, theta = std::acos(std::min(cosine, 1.0));
    check_range(echoes[i][0], 2 / cosine);
    check_range(echoes[i][1], 5 / cosine);
    // Fresnel by angles: R_s = (sin(a - b) / sin(a + b))^2, R_p = (tan(a - b) / tan(a + b))^2; at perpendicular
    // incidence ((n-1)/(n+1))^2.
    const double inside = std::asin(std::sin(theta) / 1.5);
    const double s = i == 0 ? 0.04 : std::pow(std::sin(theta - inside) / std::sin(theta + inside), 2);
    const double p = i == 0 ? 0.04 : std::pow(std::tan(theta - inside) / std::tan(theta + inside), 2);
    // Each polarisation transmits (1 - R) (1 + R^2 + R^4 + ...) (1 - R) = (1 - R) / (1 + R).
    const double passed = ((1 - s) / (1 + s) + (1 - p) / (1 + p)) / 2;
    const double way_m = 5 / cosine;
    const double of_pane = 0.2 * cosine / (4 / (cosine * cosine));
    const double of_wall = std::pow(0.8 * passed, 2) * 0.5 * cosine / (way_m * way_m);
    // The shares are float32: 0.8 and 0.5 are rounded to the nearest values.
    constexpr double kShares = 4 * 0x1p-24;
    CHECK(std::abs(echoes[i][0].power - of_pane) <= 4 * kShares * of_pane);
    CHECK(std::abs(echoes[i][1].power - of_wall) <= 4 * kShares * of_wall);
  }
}

TEST_CASE("reflectance of a pane: perpendicular, at Brewster's angle, grazing, and beyond the critical angle") {
  const double n = 1.5, square_on = 2 * 0.04 / 1.04;
  CHECK(std::abs(pane_reflectance(n, 1) - square_on) <= 16 * kRoundingUnit);
  CHECK(std::abs(square_on - std::pow(n - 1, 2) / (n * n + 1)) <= 16 * kRoundingUnit);
  // tan(theta) = n: light polarised along the plane of incidence passes completely; across it R = ((n^2 - 1) / (n^2 +
  // 1))^2.
  const double brewster = std::pow((n * n - 1) / (n * n + 1), 2);
  CHECK(std::abs(pane_reflectance(n, std::cos(std::atan(n))) - brewster / (1 + brewster)) <= 64 * kRoundingUnit);
  CHECK(pane_reflectance(n, 1e-9) > 0.99999);
  CHECK(pane_reflectance(1 / n, std::cos(0.75)) == 1);  // the critical angle is 0.73 rad
  const SurfaceShares shares = surface_shares(glass(1, 1.5f), 1, 0.6);
  CHECK(shares.matte == 0);
  CHECK(std::abs(shares.reflected + shares.passed - 1) <= 4 * kRoundingUnit);
}

TEST_CASE("a pane reflects like a weak mirror; a coloured one absorbs what it does not transmit") {
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, plate_mesh({3, 3, 0}, {0, 0, 50}), at(4, 0, 0), glass(1));
  add_item(list, across(1), at(0, 7, 0), Material());
  add_item(list, across(0), at(9, 0, 0), Material());
  const double pane = pane_reflectance(1.5, std::cos(kPi / 4));
  const auto clear = echoes_of(list, {{1, 0, 0}}, depth(1), *engine.caster);
  REQUIRE(clear[0].size() == 2);
  check_range(clear[0][0], 9);
  check_range(clear[0][1], 11);
  CHECK(std::abs(clear[0][0].power - std::pow(1 - pane, 2) / 81) <= 1e-12);
  CHECK(std::abs(clear[0][1].power - std::pow(pane, 2) / 121) <= 1e-12);
  Material green = glass(1);
  green.base_color = {0, 0.75f, 0, 1};
  list.materials[list.items[0].material] = std::make_shared<Material>(green);
  const auto tinted = echoes_of(list, {{1, 0, 0}}, depth(1), *engine.caster);
  REQUIRE(tinted[0].size() == 2);
  CHECK(std::abs(tinted[0][0].power - std::pow(0.25 * (1 - pane), 2) / 81) <= 1e-12);
  CHECK(tinted[0][1].power == clear[0][1].power);
}

TEST_CASE("path_depth limits the path: nothing is hit behind too many panes") {
  const RayEngine engine = each_engine();
  DrawList list;
  for (int i = 0; i < 4; ++i) add_item(list, across(0), at(1 + 0.001 * i, 0, 0), glass(1));
  add_item(list, across(0), at(5, 0, 0), Material());
  for (const int turns : {1, 3, 4}) {
    CAPTURE(turns);
    // Reflections between the panes take more bounces to reach the wall.
    const auto echoes = echoes_of(list, {{1, 0, 0}}, depth(turns), *engine.caster);
    REQUIRE(echoes[0].size() == (turns < 4 ? 0 : 1));
    if (turns == 4) check_range(echoes[0][0], 5);
  }
}

TEST_CASE("surfaces without a specular share give the same echoes to the bit") {
  const RayEngine engine = each_engine();
  const DrawList list = random_room(3, 20, 16);
  std::mt19937 random(2);
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 500; ++i) directions.push_back(random_direction(random));
  const auto with = echoes_of(list, directions, depth(4), *engine.caster);
  const auto without = echoes_of(list, directions, {}, *engine.caster);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    REQUIRE(with[i].size() == without[i].size());
    for (std::size_t k = 0; k < with[i].size(); ++k) {
      CHECK(with[i][k].range_m == without[i][k].range_m);
      CHECK(with[i][k].error_bound_m == without[i][k].error_bound_m);
      CHECK(with[i][k].power == without[i][k].power);
    }
  }
  CHECK(!depth(4).at(0).called_for(list));
}

}  // namespace simvis

TEST_SUITE_END();
