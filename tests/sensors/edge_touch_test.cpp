// When a moving edge is in a pixel's square, and at which edges of a mesh the light may jump.
#include "sensors/event_camera/edge_touch.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include <simvis/mesh.h>
#include "sensors/event_camera/smooth_neighbours.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

constexpr double kQuarter = std::numbers::pi / 2, kNear_m = 0.1;
// A pixel is 1 m wide at z = 1, and the axis goes through the centre of pixel 0, 0.
const Pinhole kPinhole{.fx_px = 1, .fy_px = 1, .cx_px = 0.5, .cy_px = 0.5};
// Golden section narrows the time of a touch, at most 1, by 0.618 in each of 24 steps.
constexpr double kTime = 1e-5;

/// A short edge on a circle about the axis, from angle 0 at time 0 to a quarter turn at time 1.
std::optional<double> touch_on_circle(double radius_m) {
  const EdgeTouch touch(kPinhole, kNear_m, 0, 0);
  const auto ends = [&](double time) {
    const double angle = kQuarter * time;
    const glm::dvec3 place(radius_m * std::cos(angle), radius_m * std::sin(angle), 1);
    return EdgeTouch::Ends{place, place * (1 + 1e-6)};
  };
  return touch.deepest(ends, radius_m * 1.01 * kQuarter * kQuarter, 0, 1);
}

TEST_CASE("an edge on a circle is deepest in the square at its corner, if it comes that near") {
  const double corner = std::sqrt(0.5);
  // At the corner its depth is that in x and in y, 0.5 - radius / sqrt 2.
  for (const double depth : {0.1, 0.01, 0.001, 2 * kTouch_px}) {
    CAPTURE(depth);
    const std::optional<double> time = touch_on_circle(corner - depth * std::sqrt(2));
    REQUIRE(time);
    CHECK(std::abs(*time - 0.5) < kTime);
  }
  CHECK_FALSE(touch_on_circle(corner));
  CHECK_FALSE(touch_on_circle(corner + 1e-3));
}

TEST_CASE("an edge that is in the square at the begin or at the end needs no time") {
  const EdgeTouch touch(kPinhole, kNear_m, 0, 0);
  const auto from = [&](double begin) {
    return touch.deepest(
        [&](double time) {
          return EdgeTouch::Ends{glm::dvec3(begin + 4 * time, -1, 1), {begin + 4 * time, 1, 1}};
        },
        0, 0, 1);
  };
  CHECK_FALSE(from(0));
  CHECK_FALSE(from(-4));
  CHECK_FALSE(from(0.51));
  CHECK_FALSE(from(-4.51));
  // It passes the centre at half of the time, where it could be moved by as far to either side.
  REQUIRE(from(-2));
  CHECK(std::abs(*from(-2) - 0.5) < kTime);
}

TEST_CASE("an edge that moves along itself beside the square is looked at once") {
  const EdgeTouch touch(kPinhole, kNear_m, 0, 0);
  int looks = 0;
  const auto ends = [&](double time) {
    ++looks;
    return EdgeTouch::Ends{glm::dvec3(0.5, -3 + time, 1), {0.5, -1 + 3 * time, 1}};
  };
  CHECK_FALSE(touch.deepest(ends, 0, 0, 1));
  CHECK(looks == 2);
}

// Two triangles of a square; the corner beyond their diagonal is lifted.
Mesh two_triangles(float lifted, bool has_normals) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, lifted}};
  mesh.attributes.resize(mesh.positions.size());
  for (VertexAttributes& attributes : mesh.attributes) attributes.normal = {0, 0, has_normals ? 1.0f : 0.0f};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

TEST_CASE("triangles go on smoothly in others that share vertices with normals, or their plane") {
  const auto is_smooth = [](const Mesh& mesh) {
    const auto neighbours = smooth_neighbours(mesh);
    for (const std::size_t border : {0, 1}) CHECK(neighbours[0][border] == kNoNeighbour);
    for (const std::size_t border : {1, 2}) CHECK(neighbours[1][border] == kNoNeighbour);
    if (neighbours[0][2] == kNoNeighbour) {
      CHECK(neighbours[1][0] == kNoNeighbour);
      return false;
    }
    CHECK(neighbours[0][2] == 1);
    CHECK(neighbours[1][0] == 0);
    return true;
  };
  CHECK(is_smooth(two_triangles(0, false)));
  CHECK_FALSE(is_smooth(two_triangles(0.5f, false)));
  CHECK(is_smooth(two_triangles(0.5f, true)));
  Mesh split = two_triangles(0, false);
  split.positions.push_back(split.positions[0]);
  split.attributes.push_back(split.attributes[0]);
  split.indices[3] = 4;
  CHECK_FALSE(is_smooth(split));
  Mesh three = two_triangles(0, false);
  three.indices.insert(three.indices.end(), {0, 2, 1});
  CHECK(smooth_neighbours(three)[0][2] == kNoNeighbour);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
