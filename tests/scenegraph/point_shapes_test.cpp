// `point_radius` and `point_shape`: what becomes of the points of a part.
#include "scenegraph/point_shapes.h"

#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "tests/support/error_of.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {

TEST_CASE("the points of a deeply nested part become solid without recursion") {
  Mesh points;
  points.topology = Topology::points;
  points.positions = {{0, 0, 0}, {1, 0, 0}};
  points.indices = {0, 1};
  const auto shape = std::make_shared<Shape>(std::make_shared<const Mesh>(points));
  NodePtr node = shape;
  const int depth = sanitized() ? 10'000 : 200'000;
  for (int i = 0; i < depth; ++i) {
    auto group = std::make_shared<Group>();
    group->add(std::move(node));
    node = std::move(group);
  }
  PartContent content;
  content.root = std::move(node);
  ContentPool pool;
  make_points_solid(content, "points.ply", {.kind = SurfaceKind::sphere, .radius_m = 0.5}, pool);
  CHECK(content.warnings.empty());
  REQUIRE(shape->mesh()->surface.has_value());
  CHECK(shape->mesh()->surface->kind == SurfaceKind::sphere);
  CHECK(shape->mesh()->surface->radius_m == 0.5);
}

TEST_CASE("points without a normal are no discs, and a file that has no other points is refused") {
  Mesh points;
  points.topology = Topology::points;
  points.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  points.attributes = {{.normal = {0, 1, 0}}, {.normal = {0, 0, 0}}, {.normal = {1, 0, 0}}};
  points.indices = {0, 1, 2};
  constexpr ExactSurface kDisc{.kind = SurfaceKind::disc, .radius_m = 0.5};
  ContentPool pool;
  const auto made_solid = [&](const ExactSurface& shape, PartContent& content) {
    const auto drawn = std::make_shared<Shape>(std::make_shared<const Mesh>(points));
    content.root = drawn;
    make_points_solid(content, "points.ply", shape, pool);
    return drawn->mesh();
  };
  PartContent discs;
  CHECK(made_solid(kDisc, discs)->indices == std::vector<std::uint32_t>{0, 2});
  REQUIRE(discs.warnings.size() == 1);
  CHECK(discs.warnings[0] == "points.ply: 1 points are left out, which have no normal for a disc");
  PartContent spheres;
  CHECK(made_solid({.kind = SurfaceKind::sphere, .radius_m = 0.5}, spheres)->indices.size() == 3);
  CHECK(spheres.warnings.empty());
  for (VertexAttributes& attributes : points.attributes) attributes.normal = glm::vec3(0);
  PartContent bare;
  CHECK(contains(error_of([&] { made_solid(kDisc, bare); }),
                 "points.ply: error: its points have no normals, expected point_shape=\"sphere\""));
}

}  // namespace simvis

TEST_SUITE_END();
