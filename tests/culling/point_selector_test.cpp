#include "engine/culling/point_selector.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <simvis/device.h>
#include "engine/geometry/view_projection.h"
#include "tests/culling/culled_picture.h"
#include "tests/support/random_room.h"

TEST_SUITE_BEGIN("engine/culling");

using namespace simvis;

namespace {

constexpr double kPointSnap_px = 1.0 / 256;
constexpr PointSizes kPointSizes{.max_px = 64, .step_px = 0.125};

View pointed_view(std::uint32_t width_px, std::uint32_t height_px) {
  View view;
  view.pinhole = {0.6 * width_px, 0.6 * width_px, 0.48 * width_px, 0.53 * height_px};
  view.near_m = 0.05;
  view.width_px = width_px;
  view.height_px = height_px;
  return view;
}

// The points that are selected, with coordinates of the view.
std::vector<std::uint32_t> selected_points(const std::vector<glm::vec3>& positions, double size_m,
                                           double slack_m = 1e-6) {
  std::vector<std::uint32_t> points(positions.size()), selected;
  std::iota(points.begin(), points.end(), 0u);
  PointSelector selector;
  selector.begin(pointed_view(64, 48), 1, kPointSnap_px, kPointSizes);
  selector.select(glm::dmat4(1.0), slack_m, size_m, positions, points, selected);
  CHECK(std::ranges::is_sorted(selected));
  return selected;
}

glm::vec3 at_point_px(double u, double v, double z) {
  const Pinhole k = pointed_view(64, 48).pinhole;
  return {(u - k.cx_px) / k.fx_px * z, (v - k.cy_px) / k.fy_px * z, z};
}

// The side of a square of so many pixels at this depth.
double side_m(double px, double z) { return px * z / pointed_view(64, 48).pinhole.fx_px; }

Mesh cloud_mesh(std::vector<glm::vec3> positions, double radius_m) {
  Mesh mesh;
  mesh.topology = Topology::points;
  mesh.positions = std::move(positions);
  mesh.attributes.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
    mesh.attributes[i].color = {static_cast<float>(i % 7) / 7, static_cast<float>(i % 11) / 11, 0.5f, 1};
  }
  mesh.indices.resize(mesh.positions.size());
  std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
  if (radius_m > 0) mesh.surface = ExactSurface{.kind = SurfaceKind::sphere, .radius_m = radius_m};
  return mesh;
}

}  // namespace

TEST_CASE("a point is selected unless nearer squares cover all samples that it may cover, by more than rounding") {
  using Selected = std::vector<std::uint32_t>;
  const double side = side_m(5, 2);
  const glm::vec3 hides = at_point_px(20.5, 20.5, 2);  // the samples from 18.5 to 22.5
  CHECK(selected_points({hides}, side) == Selected{0});
  CHECK(selected_points({hides, at_point_px(20.5, 20.5, 3)}, side) == Selected{0});  // 3.3 pixels behind 5
  CHECK(selected_points({at_point_px(20.5, 20.5, 3), hides}, side) == Selected{1});
  CHECK(selected_points({hides, at_point_px(20.5, 20.5, 1.5)}, side) == Selected{1});
  CHECK(selected_points({hides, at_point_px(22.5, 20.5, 3)}, side) == Selected{0, 1});
  // As near as rounding can tell: both stay, as the device takes the first.
  CHECK(selected_points({hides, at_point_px(20.5, 20.5, 2)}, side) == Selected{0, 1});
  CHECK(selected_points({hides, at_point_px(20.5, 20.5, 2 + 1e-6)}, side) == Selected{0, 1});
  CHECK(selected_points({hides, at_point_px(20.5, 20.5, 2.01)}, side) == Selected{0});
  CHECK(selected_points({hides, at_point_px(20.5, 20.5, 2.3)}, side) == Selected{0});
  CHECK(selected_points({hides, at_point_px(20.5, 20.5, 2.3)}, side, 0.1) == Selected{0, 1});

  // Two squares that together cover a third one.
  CHECK(selected_points({at_point_px(18.5, 20.5, 2), at_point_px(22.5, 20.5, 2), at_point_px(20.5, 20.5, 3)}, side) ==
        Selected{0, 1});
  CHECK(selected_points({at_point_px(17, 20.5, 2), at_point_px(23, 20.5, 2), at_point_px(20, 20.5, 3)}, side) ==
        Selected{0, 1, 2});
}

TEST_CASE("points whose squares lie outside of the view are not selected, and those at its edges are") {
  using Selected = std::vector<std::uint32_t>;
  const double side = side_m(5, 2);
  CHECK(selected_points(
            {at_point_px(-2, 20, 2), at_point_px(66, 20, 2), at_point_px(20, -2, 2), at_point_px(20, 50, 2)}, side) ==
        Selected{0, 1, 2, 3});
  CHECK(selected_points(
            {at_point_px(-3, 20, 2), at_point_px(67, 20, 2), at_point_px(20, -3, 2), at_point_px(20, 51, 2)}, side)
            .empty());
  CHECK(selected_points({{0, 0, -2}, {0, 0, 0}, {0, 0, 0.049f}, {3, 0, -1e-30f}}, side).empty());
  CHECK(selected_points({{0, 0, 0.05f}, {0, 0, 0.0500001f}, {0, 0, 0.051f}}, side).size() == 3);
  // A point beyond the edge is drawn by some devices only, so it hides nothing.
  CHECK(selected_points({at_point_px(-1, 20.5, 2), at_point_px(-0.2, 20.5, 3)}, side) == Selected{0, 1});
  CHECK(selected_points({at_point_px(1, 20.5, 2), at_point_px(-0.2, 20.5, 3)}, side) == Selected{0});
  // So near that rounding may move it by pixels, and what is not a number.
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(selected_points({{0.02f, 0, 0.06f}}, side, 0.005) == Selected{0});
  CHECK(selected_points({{nan, 0, 2}, {0, nan, 2}, {0, 0, nan}}, side) == Selected{0, 1, 2});
  CHECK(selected_points({}, side).empty());
}

TEST_CASE("pictures of dense clouds are the same bytes with selected points and with all") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(23);
  std::uniform_real_distribution<float> in_room(-1, 1);
  std::vector<glm::vec3> positions;
  for (int i = 0; i < 30000; ++i) {  // on walls, which hide those behind, and some in the air, also next to the eye
    glm::vec3 p(in_room(random), in_room(random), in_room(random));
    if (i % 50 != 0) p /= std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    positions.push_back(p * glm::vec3(2.5f, 1.5f, 4));
  }
  for (const double radius_m : {0.0, 0.004, 0.03, 0.2}) {
    for (const std::uint32_t supersampling : {1u, 2u}) {
      CAPTURE(radius_m);
      CAPTURE(supersampling);
      DrawList list;
      add_item(list, cloud_mesh(positions, radius_m),
               glm::translate(glm::dmat4(1.0), {1000.25, 2000.5, -300.125}) * random_turn(random) *
                   glm::scale(glm::dmat4(1.0), glm::dvec3(1, -1.5, 1)));
      add_item(list, sphere_mesh(0.8, 20), glm::translate(glm::dmat4(1.0), {1000, 2001, -300}));
      FramePlan plan;
      plan.passes.push_back({.name = "picture",
                             .width_px = 200,
                             .height_px = 150,
                             .color = true,
                             .depth = supersampling == 1,
                             .views = {pointed_view(200, 150)},
                             .supersampling = supersampling});
      plan.passes[0].views[0].view_from_world =
          random_turn(random) * glm::translate(glm::dmat4(1.0), {-1000, -2000, 301});
      test::draw_both_ways(renderer, list, plan);
      CHECK(renderer.counters().draws > 0);
    }
  }
}

TEST_SUITE_END();
