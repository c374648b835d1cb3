// What each triangle shows of a pixel's square, where a mesh of many triangles stands before others.
#include "sensors/event_camera/visible_faces.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

using Corners = std::array<glm::dvec3, 3>;

// The pixel is 0.05 wide at z = 1, and its centre is on the axis.
constexpr std::uint32_t kPixel = 8;
const Pinhole kSmallPinhole{20, 20, kPixel + 0.5, kPixel + 0.5};

/// Triangles of a sphere, counter-clockwise seen from outside, y down.
std::vector<Corners> sphere(const glm::dvec3& centre_m, double radius_m, int sides) {
  const auto at = [&](int i, int k) {
    const double around = 2 * std::numbers::pi * i / sides, down = 2 * std::numbers::pi * k / sides;
    return centre_m +
           radius_m * glm::dvec3(std::sin(down) * std::cos(around), std::cos(down), std::sin(down) * std::sin(around));
  };
  std::vector<Corners> triangles;
  for (int i = 0; i < sides; ++i) {
    for (int k = 0; k < sides / 2; ++k) {
      triangles.push_back({at(i, k), at(i + 1, k), at(i, k + 1)});
      triangles.push_back({at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return triangles;
}

/// The areas of all triangles by their numbers.
std::vector<double> areas_of(const std::vector<Corners>& triangles, bool both_sides) {
  VisibleFaces faces;
  faces.begin(kSmallPinhole, 0.05, kPixel, kPixel);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    faces.add(static_cast<std::uint32_t>(i), triangles[i], both_sides);
  }
  std::vector<double> areas(triangles.size());
  for (const VisibleFace& face : faces.find()) areas[face.triangle] = face.area;
  return areas;
}

// 24 sides take milliseconds even where pieces are cut needlessly; the distances make the sphere cover a part of the
// square.
TEST_CASE("a sphere before a wall hides as much of it as the sphere's front sides cover") {
  const std::vector<Corners> ball = sphere({0.05, 0.03, 2.6}, 0.06, 24);
  std::vector<Corners> all = ball;
  const double z = 6;
  all.push_back({glm::dvec3(-9, -9, z), glm::dvec3(-9, 9, z), glm::dvec3(9, -9, z)});
  all.push_back({glm::dvec3(9, -9, z), glm::dvec3(-9, 9, z), glm::dvec3(9, 9, z)});
  // The sides of a convex body that face the eye hide nothing of each other.
  double front = 0;
  std::size_t seen = 0;
  for (const Corners& each : ball) {
    const double alone = areas_of({each}, false)[0];
    front += alone;
    seen += alone > 0;
  }
  REQUIRE(front > 0.2);
  REQUIRE(front < 0.8);
  // Each area is wrong by 2^-50 of a pixel or less.
  const double allowed = static_cast<double>(all.size()) * 0x1p-50;
  for (const bool both_sides : {false, true}) {
    const std::vector<double> areas = areas_of(all, both_sides);
    double of_ball = 0;
    std::size_t visible = 0;
    for (std::size_t i = 0; i < ball.size(); ++i) {
      of_ball += areas[i];
      visible += areas[i] > allowed;
    }
    CHECK(std::abs(of_ball - front) < allowed);
    CHECK(std::abs(areas[ball.size()] + areas[ball.size() + 1] - (1 - front)) < allowed);
    CHECK(visible <= seen);
    CHECK(visible + 4 >= seen);  // but for slivers
  }
}

// Random walls that cover the square, at any slope, and the same wall again: from another corner, with the other
// winding, and divided at a place in its middle.
TEST_CASE("of faces that coincide the first is seen, however they are divided and whichever corner they begin with") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int trial = 0; trial < 2000; ++trial) {
    CAPTURE(trial);
    const double reach_m = std::pow(10, 2 * unit(random)), steep = std::pow(10, 2 * unit(random));
    const auto corner = [&](double around) {
      const glm::dvec2 at(std::cos(around), std::sin(around));
      return reach_m * glm::dvec3(0.2 * at.x, 0.2 * at.y, 1) / (1 + 0.15 * at.x * std::tanh(steep));
    };
    const double start = 3 * unit(random);
    const Corners wall{corner(start), corner(start + 2), corner(start + 4)};
    const glm::dvec3 middle = (wall[0] + wall[1] + wall[2]) / 3.0;
    const std::vector<Corners> again[] = {
        {{wall[1], wall[2], wall[0]}},
        {{wall[2], wall[1], wall[0]}},
        {{wall[0], wall[1], middle}, {wall[1], wall[2], middle}, {wall[2], wall[0], middle}}};
    for (const std::vector<Corners>& other : again) {
      std::vector<Corners> all = other;
      all.insert(all.begin(), wall);
      const std::vector<double> first = areas_of(all, true);
      CHECK(first[0] == areas_of({wall}, true)[0]);
      for (std::size_t i = 1; i < first.size(); ++i) CHECK(first[i] == 0);
      std::rotate(all.begin(), all.begin() + 1, all.end());
      const std::vector<double> last = areas_of(all, true);
      // Parts of the square meet at the middle: what is lost there is below the area that counts as none.
      CHECK(last.back() <= 1e-9);
    }
  }
}

TEST_CASE("a face that is nearer by more than rounding is seen, whatever the order") {
  const auto wall = [](double z) { return Corners{glm::dvec3(-9, -9, z), glm::dvec3(-9, 9, z), glm::dvec3(30, 0, z)}; };
  const double z = 4, nearer = z * (1 - 1e-12);
  const std::vector<double> behind = areas_of({wall(z), wall(nearer)}, true),
                            before = areas_of({wall(nearer), wall(z)}, true);
  CHECK(behind[0] == 0);
  CHECK(behind[1] == doctest::Approx(1).epsilon(1e-12));
  CHECK(before[0] == doctest::Approx(1).epsilon(1e-12));
  CHECK(before[1] == 0);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
