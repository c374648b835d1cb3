#include "engine/geometry/view_projection.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

View strip(std::uint32_t width, std::uint32_t height, double f_px) {
  View view;
  view.pinhole = {f_px, f_px, width * 0.5, height * 0.5};
  view.width_px = width;
  view.height_px = height;
  return view;
}

glm::dmat4 moved(double x, double y, double z) { return glm::translate(glm::dmat4(1), glm::dvec3(x, y, z)); }

}  // namespace

TEST_CASE("clip rows project a point to the pixel of the pinhole camera") {
  View view = strip(640, 480, 500);
  view.pinhole = {510, 490, 300.5, 250.25};
  view.view_from_world = glm::rotate(moved(1, 2, 3), 0.4, glm::normalize(glm::dvec3(1, 2, 3)));
  const ViewProjection projection = make_projection(view);
  const glm::dmat4 world_from_mesh = glm::scale(moved(0.5, -1, 9), glm::dvec3(2, -3, 0.5));
  shader::Instance instance;
  write_clip_rows(projection, world_from_mesh, instance);
  const glm::dvec4 p(0.3, 0.7, -0.2, 1);
  const glm::dvec4 seen = view.view_from_world * world_from_mesh * p;
  const double u = 300.5 + 510 * seen.x / seen.z, v = 250.25 + 490 * seen.y / seen.z;
  const double w = glm::dot(glm::dvec4(instance.clip_w), p);
  // The rows are rounded to float32: 2^-24 of coefficients up to 40, over a depth of 12 m, times half the width.
  constexpr double kRounding_px = 320 * 4 * 40.0 / 12 / (1 << 24);
  CHECK(w == doctest::Approx(seen.z).epsilon(1e-6));
  CHECK(std::abs((glm::dot(glm::dvec4(instance.clip_x), p) / w + 1) * 320 - u) < kRounding_px);
  CHECK(std::abs((glm::dot(glm::dvec4(instance.clip_y), p) / w + 1) * 240 - v) < kRounding_px);
}

TEST_CASE("a strip is projected into a viewport with guard rows, and a point to the same pixel as without") {
  const View view = strip(4096, 2, 2048);
  REQUIRE(guard_rows(view) == 2047);
  shader::Instance instance;
  write_clip_rows(make_projection(view), glm::dmat4(1), instance);
  const glm::dvec4 p(0.5, 0.001, 2, 1);
  const double v = view.pinhole.cy_px + view.pinhole.fy_px * p.y / p.z;
  const double row = (glm::dot(glm::dvec4(instance.clip_y), p) / p.z + 1) * 4096 / 2 - guard_rows(view);
  // The rows are rounded to float32, half a viewport of pixels times 2^-24 for each of two terms of about 1.
  CHECK(std::abs(row - v) < 2 * 2048.0 / (1 << 24));
  CHECK(guard_rows(strip(640, 480, 500)) == 0);
}

TEST_CASE("no box with a visible point is culled, under any rotation, scale and shear, also far from the origin") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  int culled = 0, kept_in_view = 0;
  for (int round = 0; round < 20000; ++round) {
    View view = strip(64, round % 2 ? 64 : 1, 40);
    const glm::dvec3 origin = round % 3 ? glm::dvec3(0) : glm::dvec3(1e7 * unit(random), 1e7 * unit(random), 0);
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1), 3 * unit(random), glm::dvec3(unit(random), 1, unit(random)));
    view.view_from_world = turn * glm::translate(glm::dmat4(1), -origin);
    glm::dmat4 world_from_mesh(1);
    for (int c = 0; c < 3; ++c) world_from_mesh[c] = {unit(random), unit(random), unit(random), 0};
    world_from_mesh[3] = glm::dvec4(origin + 6.0 * glm::dvec3(unit(random), unit(random), unit(random)), 1);
    const glm::dvec3 center(unit(random), unit(random), unit(random));
    const glm::dvec3 half(1 + unit(random), 1 + unit(random), round % 5 ? 1 + unit(random) : 0);
    const bool gone = outside(make_projection(view), make_box(world_from_mesh, center, half));
    culled += gone;
    bool any_visible = false;
    for (int i = 0; i < 64; ++i) {
      const glm::dvec3 p = center + half * glm::dvec3(unit(random), unit(random), unit(random));
      const glm::dvec3 seen(view.view_from_world * (world_from_mesh * glm::dvec4(p, 1)));
      const double u = 32 + 40 * seen.x / seen.z, v = view.height_px * 0.5 + 40 * seen.y / seen.z;
      any_visible |= seen.z >= view.near_m && u >= 0 && u <= 64 && v >= 0 && v <= view.height_px;
    }
    kept_in_view += any_visible;
    if (any_visible && gone) FAIL("round " << round << " lost a visible point");
  }
  CHECK(culled > 5000);
  CHECK(kept_in_view > 2000);
}

TEST_CASE("a floor below a strip is culled although the sphere around it reaches far above") {
  const ViewProjection projection = make_projection(strip(4096, 1, 2048));
  const WorldBox floor = make_box(glm::dmat4(1), {0, 0.1, 0}, {50, 0, 50});
  CHECK(floor.radius > 50);
  // The strip is half a pixel high on either side. At 50 m it reaches 12 mm down, and the floor is 100 mm below.
  CHECK(outside(projection, floor));
  CHECK(!outside(projection, make_box(glm::dmat4(1), {0, 0.01, 0}, {50, 0, 50})));
}

TEST_CASE("objects in front of the near plane or behind the eye are culled") {
  View view = strip(64, 64, 32);
  view.near_m = 0.5;
  const ViewProjection projection = make_projection(view);
  const auto gone = [&](double z) { return outside(projection, make_box(moved(0, 0, z), {}, {0.1, 0.1, 0.1})); };
  CHECK(gone(-3));
  CHECK(gone(0.3));
  CHECK(!gone(0.41));
  CHECK(!gone(3));
}

TEST_SUITE_END();
