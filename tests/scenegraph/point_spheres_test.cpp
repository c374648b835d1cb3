// `point_radius`: what becomes of the points of a part.
#include "scenegraph/point_spheres.h"

#include <doctest/doctest.h>

#include <memory>

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
  CHECK(make_points_solid(content, 0.5, pool));
  REQUIRE(shape->mesh()->surface.has_value());
  CHECK(shape->mesh()->surface->kind == SurfaceKind::sphere);
  CHECK(shape->mesh()->surface->radius_m == 0.5);
}

}  // namespace simvis

TEST_SUITE_END();
