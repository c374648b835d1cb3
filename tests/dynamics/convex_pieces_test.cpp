// Concave meshes divided into convex pieces, against their geometry.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/mass.h"
#include "elements/dynamics/world/part_shapes.h"
#include "tests/support/moving_scene.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// Bullet computes hulls on a grid of about 1e-4 of their size.
constexpr double kHullRounding = 2e-4;

struct Solid {
  std::vector<glm::dvec3> points;
  std::vector<std::uint32_t> triangles;

  void add_quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangles.insert(triangles.end(), {a, b, c, a, c, d});
  }
  std::string obj() const {
    std::string text;
    for (const glm::dvec3& p : points) {
      text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
    }
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
      text += "f";
      for (std::size_t k = i; k < i + 3; ++k) text += " " + std::to_string(triangles[k] + 1);
      text += "\n";
    }
    return text;
  }
  std::vector<CollisionShape> pieces(double concavity_m) const {
    return dynamics_engine().convex_pieces(points, triangles, concavity_m);
  }
};

// A cube of 1 m on the floor z = 0, open at the top, with walls and a floor of this thickness.
Solid cup(double wall_m, double size_m = 1) {
  const double o = 0.5, i = 0.5 - wall_m;
  Solid s;
  s.points = {{-o, -o, 0},      {o, -o, 0},      {o, o, 0},      {-o, o, 0},     {-o, -o, 1}, {o, -o, 1},
              {o, o, 1},        {-o, o, 1},      {-i, -i, 1},    {i, -i, 1},     {i, i, 1},   {-i, i, 1},
              {-i, -i, wall_m}, {i, -i, wall_m}, {i, i, wall_m}, {-i, i, wall_m}};
  for (glm::dvec3& p : s.points) p *= size_m;
  s.add_quad(3, 2, 1, 0);
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t n = (k + 1) % 4;
    s.add_quad(k, n, 4 + n, 4 + k);            // outside
    s.add_quad(4 + k, 4 + n, 8 + n, 8 + k);    // rim
    s.add_quad(8 + k, 8 + n, 12 + n, 12 + k);  // inside
  }
  s.add_quad(12, 13, 14, 15);
  return s;
}

// A torus around z with the radius 1 m of its middle.
Solid torus(double radius_m, std::uint32_t around, std::uint32_t across) {
  Solid s;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const double out = 1 + radius_m * std::cos(b);
      s.points.emplace_back(out * std::cos(a), out * std::sin(a), radius_m * std::sin(b));
      const std::uint32_t next_i = (i + 1) % around, next_j = (j + 1) % across;
      s.add_quad(i * across + j, next_i * across + j, next_i * across + next_j, i * across + next_j);
    }
  }
  return s;
}

double volume_m3(const std::vector<CollisionShape>& pieces) { return mass_of(pieces, 1).mass_kg; }

// Whether a point lies in a hull, `margin_m` or more below its surface.
bool is_inside(const CollisionShape& hull, const glm::dvec3& point, double margin_m) {
  for (std::size_t i = 0; i < hull.triangles.size(); i += 3) {
    const glm::dvec3 a(hull.body_from_shape * glm::dvec4(hull.points[hull.triangles[i]], 1)),
        b(hull.body_from_shape * glm::dvec4(hull.points[hull.triangles[i + 1]], 1)),
        c(hull.body_from_shape * glm::dvec4(hull.points[hull.triangles[i + 2]], 1));
    const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    if (glm::dot(point - a, normal) > -margin_m) return false;
  }
  return true;
}

bool is_inside(const std::vector<CollisionShape>& hulls, const glm::dvec3& point, double margin_m) {
  return std::ranges::any_of(hulls, [&](const CollisionShape& hull) { return is_inside(hull, point, margin_m); });
}

}  // namespace

TEST_CASE("a convex solid is one piece") {
  Solid box;
  for (int corner = 0; corner < 8; ++corner) box.points.emplace_back(corner & 1, corner >> 1 & 1, corner >> 2);
  box.add_quad(0, 2, 3, 1);
  box.add_quad(4, 5, 7, 6);
  box.add_quad(0, 1, 5, 4);
  box.add_quad(1, 3, 7, 5);
  box.add_quad(3, 2, 6, 7);
  box.add_quad(2, 0, 4, 6);
  const std::vector<CollisionShape> pieces = box.pieces(0.02);
  REQUIRE(pieces.size() == 1);
  CHECK(std::abs(volume_m3(pieces) - 1) < 6 * kHullRounding);  // six faces of 1 m^2 may each be off
}

TEST_CASE("an L is divided at its bend") {
  Solid l;
  const glm::dvec2 outline[] = {{0, 0}, {1, 0}, {1, 0.3}, {0.3, 0.3}, {0.3, 1}, {0, 1}};
  for (const double z : {0.0, 0.4}) {
    for (const glm::dvec2& p : outline) l.points.emplace_back(p, z);
  }
  for (std::uint32_t k = 0; k < 6; ++k) l.add_quad(k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k);
  l.add_quad(0, 3, 2, 1);
  l.add_quad(0, 5, 4, 3);
  l.add_quad(6, 7, 8, 9);
  l.add_quad(6, 9, 10, 11);
  const std::vector<CollisionShape> pieces = l.pieces(0.02);
  REQUIRE(pieces.size() == 2);
  constexpr double kVolume_m3 = (1 * 0.3 + 0.7 * 0.3) * 0.4, kSurface_m2 = 2 * kVolume_m3 / 0.4 + 4 * 0.4;
  CHECK(std::abs(volume_m3(pieces) - kVolume_m3) < 2 * kSurface_m2 * kHullRounding);
}

TEST_CASE("a cup is open, has a floor and four walls, at any size") {
  std::set<std::size_t> counts;
  for (const double size_m : {1e-3, 1.0, 1e3}) {
    for (const double wall_m : {0.02, 0.1}) {
      CAPTURE(size_m);
      CAPTURE(wall_m);
      const std::vector<CollisionShape> pieces = cup(wall_m, size_m).pieces(0.02 * size_m);
      counts.insert(pieces.size());
      const double margin_m = kHullRounding * size_m, inner = 0.5 - wall_m;
      for (const double x : {-0.99, -0.5, 0.0, 0.5, 0.99}) {
        for (const double y : {-0.99, 0.1, 0.99}) {
          for (const double z : {0.01, 0.5, 0.99}) {
            const glm::dvec3 in_cavity(inner * x, inner * y, wall_m + (1 - wall_m) * z);
            CHECK(!is_inside(pieces, size_m * in_cavity, margin_m));
          }
          // A plate of half the concavity, 0.01, lies below the inner floor.
          CHECK(is_inside(pieces, size_m * glm::dvec3(inner * x, inner * y, wall_m - 0.005), margin_m));
        }
      }
      for (const double z : {0.2, 0.5, 0.99}) {
        for (const double along : {-0.7, 0.0, 0.7}) {
          const double across = 0.5 - wall_m / 2;
          for (const glm::dvec2& p :
               {glm::dvec2(across, along / 2), {-across, along / 2}, {along / 2, across}, {along / 2, -across}}) {
            CHECK(is_inside(pieces, size_m * glm::dvec3(p, z), margin_m));
          }
        }
      }
    }
  }
  CHECK(counts == std::set<std::size_t>{6});  // inner and outer floor are a plate each
}

TEST_CASE("a torus keeps its hole, and pieces fill no deeper hollow than the concavity") {
  for (const auto& [around, across] : {std::pair{24u, 10u}, {96u, 48u}}) {
    constexpr double kRadius_m = 0.3, kConcavity_m = 0.05;
    const Solid solid = torus(kRadius_m, around, across);
    const std::vector<CollisionShape> pieces = solid.pieces(kConcavity_m);
    CAPTURE(pieces.size());
    CHECK(pieces.size() > 4);
    for (int k = 0; k < 12; ++k) {
      const double turn = 2 * std::numbers::pi * k / 12;
      for (const double out : {0.0, 0.25, 0.5}) {
        CHECK(!is_inside(pieces, {out * std::cos(turn), out * std::sin(turn), 0.0}, 0));
      }
    }
    // A grid of 5 cm: what lies in a piece, and how far outside of the torus that is.
    constexpr double kGrid_m = 0.05;
    double farthest_m = 0;
    std::size_t in_pieces = 0, in_torus = 0;
    for (double x = -1.4; x < 1.4; x += kGrid_m) {
      for (double y = -1.4; y < 1.4; y += kGrid_m) {
        for (double z = -0.4; z < 0.4; z += kGrid_m) {
          const double outside_m = std::hypot(std::hypot(x, y) - 1, z) - kRadius_m;
          in_torus += outside_m < 0;
          if (!is_inside(pieces, {x, y, z}, 0)) continue;
          ++in_pieces;
          farthest_m = std::max(farthest_m, outside_m);
        }
      }
    }
    // HACD measures concavity at corners and in the middle of faces, so that it may be larger in between.
    CHECK(farthest_m < 1.5 * kConcavity_m);
    // The polygons in both circles have 0.9 of their areas in the coarser mesh: 0.8 of the volume.
    CHECK(static_cast<double>(in_pieces) > 0.8 * static_cast<double>(in_torus));
    CHECK(static_cast<double>(in_pieces) < 1.1 * static_cast<double>(in_torus));
  }
}

TEST_CASE("the same mesh gives the same pieces") {
  const Solid solid = torus(0.3, 48, 24);
  const std::vector<CollisionShape> first = solid.pieces(0.05), second = solid.pieces(0.05);
  REQUIRE(first.size() == second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    CHECK(first[i].points == second[i].points);
    CHECK(first[i].triangles == second[i].triangles);
  }
}

TEST_CASE("a ball comes to rest in a cup that stands on the floor") {
  const TemporaryFolder folder;
  write_text(folder / "cup.obj", cup(0.1).obj());
  MovingScene scene(kPhysics + ground("restitution='0'") +
                        body("CUP", "file='cup.obj' up='z' pose_offset='0 0 0 0 0 0'",
                             "shape='decomposition' mass='5' restitution='0'") +
                        body("BALL", "shape='sphere' radius='0.2' pose_offset='0.05 0.02 0.6 0 0 0'",
                             "shape='sphere' mass='0.5' restitution='0' angular_damping='2'"),
                    folder.path());
  scene.run(0, 4, 0.1);
  // The margin that hulls are shrunk by, in which contacts act, and what the rounding of a hull of 1 m adds to it.
  constexpr double kContact_m = 1e-3 + kHullRounding;
  CHECK(std::abs(scene.position("BALL").z - (0.1 + 0.2)) < kContact_m);
  CHECK(std::abs(scene.position("CUP").z) < kContact_m);
  CHECK(std::abs(scene.position("BALL").x) < 0.4 - 0.2 + kContact_m);
}

TEST_CASE("a ball falls through a ring") {
  const TemporaryFolder folder;
  write_text(folder / "ring.obj", torus(0.3, 24, 10).obj());
  const auto height_below = [&](const std::string& shape) {
    MovingScene scene(
        kPhysics + ground("restitution='0'") +
            body("RING", "file='ring.obj' up='z' pose_offset='0 0 2 0 0 0'", "kind='static' shape='" + shape + "'") +
            body("BALL", "shape='sphere' radius='0.4' pose_offset='0 0 3 0 0 0'",
                 "shape='sphere' mass='1' restitution='0'"),
        folder.path());
    scene.run(0, 3, 0.1);
    return scene.position("BALL").z;
  };
  constexpr double kContact_m = 1e-3;
  CHECK(std::abs(height_below("decomposition") - 0.4) < kContact_m);
  CHECK(height_below("hull") > 2.3);  // it lies on the filled hole
}

TEST_CASE("the mass of a closed mesh is that of its solid, however its pieces overlap") {
  const TemporaryFolder folder;
  const Solid ring = torus(0.3, 24, 10);
  write_text(folder / "ring.obj", ring.obj());
  double volume = 0;
  for (std::size_t i = 0; i < ring.triangles.size(); i += 3) {
    const glm::dvec3 &a = ring.points[ring.triangles[i]], &b = ring.points[ring.triangles[i + 1]],
                     &c = ring.points[ring.triangles[i + 2]];
    volume += glm::dot(a, glm::cross(b, c)) / 6;
  }
  REQUIRE(volume_m3(ring.pieces(0.05)) > 1.05 * volume);
  // A ball of the ring's mass hits it in its middle, and the ring takes all of its speed.
  MovingScene scene(
      physics("gravity='0 0 0'") +
          body("RING", "file='ring.obj' up='z'", "shape='decomposition' density='100' restitution='1' friction='0'") +
          body("BALL", "shape='sphere' radius='0.1' pose_offset='-3 0 0 0 0 0'",
               "shape='sphere' mass='" + std::to_string(100 * volume) +
                   "' velocity='2 0 0' restitution='1' friction='0'"),
      folder.path());
  scene.run(0, 2, 0.1);
  const double before_m = scene.position("BALL").x;
  scene.run(2, 3, 0.1);
  // A mass that is wrong by 5 % would leave the ball 2.5 % of 2 m/s. The corners of the obj file have six decimals.
  CHECK(std::abs(scene.position("BALL").x - before_m) < 0.01);
}

TEST_CASE("a mesh is closed if each edge runs both ways") {
  Solid solid = cup(0.1);
  CHECK(is_closed({solid.points, solid.triangles}));
  solid.triangles.resize(solid.triangles.size() - 3);
  CHECK(!is_closed({solid.points, solid.triangles}));
}

TEST_CASE("mistakes in a decomposition") {
  const auto error = [](const std::string& attributes) {
    return error_of([&] { MovingScene scene(kPhysics + body("A", "shape='box' size='1 1 1'", attributes)); });
  };
  CHECK(error("mass='1' shape='decomposition' concavity='0.1'") == "nothing was thrown");
  CHECK(error("mass='1' shape='hull' concavity='0.1'")
            .find("attribute \"concavity\" is allowed with shape=\"decomposition\" only, not with \"hull\"") !=
        std::string::npos);
  CHECK(error("mass='1' shape='decomposition' concavity='0'").find("\"concavity\": 0 is not allowed") !=
        std::string::npos);
}

}  // namespace simvis::test

TEST_SUITE_END();
