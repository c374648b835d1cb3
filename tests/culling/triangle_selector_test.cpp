#include "engine/culling/triangle_selector.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>

#include <simvis/device.h>
#include "engine/geometry/view_projection.h"
#include "engine/render/renderer.h"
#include "tests/support/random_room.h"

TEST_SUITE_BEGIN("engine/culling");

using namespace simvis;

namespace {

constexpr std::uint32_t kSelectedWidth_px = 320, kSelectedHeight_px = 240;

View selecting_view() {
  View view;
  view.pinhole = {200, 220, 150, 125};
  view.near_m = 0.05;
  view.width_px = kSelectedWidth_px;
  view.height_px = kSelectedHeight_px;
  return view;
}

/// One triangle, as a cluster.
std::size_t selected(const TriangleSelector& selector, const std::vector<glm::vec3>& positions) {
  const std::vector<std::uint32_t> vertices{0, 1, 2};
  const std::vector<std::uint8_t> corners{0, 1, 2};
  std::vector<std::uint32_t> indices;
  selector.select({.offsets = vertices}, corners, positions, indices);
  CHECK((indices.empty() || indices == vertices));
  return indices.size() / 3;
}

/// The point at depth z that appears at the pixel coordinates.
glm::vec3 at_px(double u, double v, double z) {
  const Pinhole k = selecting_view().pinhole;
  return {(u - k.cx_px) / k.fx_px * z, (v - k.cy_px) / k.fy_px * z, z};
}

}  // namespace

TEST_CASE("a triangle is selected unless it shows its back or lies between samples, by more than rounding") {
  constexpr double kSnap_px = 1.0 / 256, kAside_px = 2 * kSnap_px;
  TriangleSelector selector;
  const OcclusionCuller none;
  // From (100.5, 50.5) to the right and down; in the order of the corners its front is seen.
  const auto triangle = [&](double first_px, double size_px) {
    return std::vector{at_px(100 + first_px, 50 + first_px, 2), at_px(100 + first_px, 50 + first_px + size_px, 2),
                       at_px(100 + first_px + size_px, 50 + first_px, 2)};
  };
  const auto reversed = [](std::vector<glm::vec3> corners) {
    std::swap(corners[1], corners[2]);
    return corners;
  };
  selector.begin(selecting_view(), 1, kSnap_px, none);
  selector.place(glm::dmat4(1.0), 0, true, false, false);
  CHECK(selected(selector, triangle(0.3, 0.4)) == 1);
  CHECK(selected(selector, reversed(triangle(0.3, 0.4))) == 0);
  CHECK(selected(selector, triangle(0.6, 0.8)) == 0);                   // the next sample is at 1.5
  CHECK(selected(selector, triangle(0.6, 0.9 - kAside_px)) == 0);       // not quite there
  CHECK(selected(selector, triangle(0.6, 0.9 - 0.5 * kSnap_px)) == 1);  // snapping may bring it there
  CHECK(selected(selector, triangle(0.5 + 0.5 * kSnap_px, 0.4)) == 1);
  CHECK(selected(selector, triangle(0.5 + kAside_px, 0.4)) == 0);
  // Thinner than the grid to which corners are snapped: it may show either side.
  const std::vector<glm::vec3> thin{at_px(90, 60.5, 2), at_px(110, 60.5, 2), at_px(100, 60.5 - 0.5 * kSnap_px, 2)};
  CHECK(selected(selector, thin) == 1);
  CHECK(selected(selector, reversed(thin)) == 1);

  // Beyond a side or before the near plane the device clips, which the test leaves to it.
  CHECK(selected(selector, {at_px(-0.4, 50.6, 2), at_px(0.3, 50.6, 2), at_px(0.3, 51, 2)}) == 1);
  CHECK(selected(selector, {at_px(100.6, 50.6, 0.02), at_px(100.7, 50.6, 2), at_px(100.6, 50.7, 2)}) == 1);
  CHECK(selected(selector, {at_px(100.6, 50.6, 0), at_px(100.7, 50.6, 2), at_px(100.6, 50.7, 2)}) == 1);

  // Four samples along each axis, at 1/8, 3/8, 5/8 and 7/8.
  selector.begin(selecting_view(), 4, kSnap_px, none);
  selector.place(glm::dmat4(1.0), 0, true, false, false);
  CHECK(selected(selector, triangle(0.6, 0.2)) == 1);
  CHECK(selected(selector, triangle(0.65, 0.2)) == 0);

  // Both sides, and a mirror image, whose sides are exchanged.
  selector.place(glm::dmat4(1.0), 0, false, false, false);
  CHECK(selected(selector, reversed(triangle(0.3, 0.4))) == 1);
  selector.place(glm::dmat4(1.0), 0, true, true, false);
  CHECK(selected(selector, triangle(0.3, 0.4)) == 0);
  CHECK(selected(selector, reversed(triangle(0.3, 0.4))) == 1);

  // Rounding in space: 1 mm at 2 m is a tenth of a pixel.
  selector.begin(selecting_view(), 1, kSnap_px, none);
  selector.place(glm::dmat4(1.0), 1e-3, true, false, false);
  CHECK(selected(selector, triangle(0.55, 0.2)) == 1);
  CHECK(selected(selector, triangle(0.9, 0.2)) == 0);
}

TEST_CASE("a triangle behind a wall is not selected if its mesh is partly hidden and rounding cannot bring it nearer") {
  constexpr double kSnap_px = 1.0 / 256, kWall_m = 2;
  Mesh wall;
  for (const auto& [u, v] : {std::pair(-50, -50), {370, -50}, {370, 290}, {-50, 290}}) {
    wall.positions.push_back(at_px(u, v, kWall_m));
  }
  wall.indices = {0, 1, 2, 0, 2, 3};
  compute_bounds(wall);
  OcclusionCuller occlusion;
  occlusion.begin(selecting_view(), kSnap_px);
  occlusion.add(extract_occluders(wall, make_clusters(wall)), glm::dmat4(1.0), 0, false, false);
  REQUIRE(occlusion.any());
  TriangleSelector selector;
  selector.begin(selecting_view(), 1, kSnap_px, occlusion);
  const auto behind = [&](double z_m) {
    return std::vector{at_px(100, 50, z_m), at_px(104, 50, z_m), at_px(101, 53, z_m)};
  };
  const auto slanted = [&](double height_px) {
    const double aside_px = height_px / std::numbers::sqrt2;
    return std::vector{at_px(100, 50, 3), at_px(104, 54, 3), at_px(102 + aside_px, 52 - aside_px, 3)};
  };
  selector.place(glm::dmat4(1.0), 0, false, false, true);
  CHECK(selected(selector, behind(3)) == 0);
  CHECK(selected(selector, behind(kWall_m)) == 1);
  CHECK(selected(selector, behind(1.5)) == 1);
  // At 3 m, which is D, FacingTolerance demands h D > 8 kSnap_px sqrt(2 + 1.42^2) / 200 * 9 m^2, h is 0.07 px or more.
  CHECK(selected(selector, slanted(0.05)) == 1);
  CHECK(selected(selector, slanted(0.1)) == 0);
  CHECK(selected(selector, {at_px(-1, 50, 3), at_px(104, 50, 3), at_px(101, 53, 3)}) == 1);  // the side may clip it
  selector.place(glm::dmat4(1.0), 0, false, false, false);
  CHECK(selected(selector, behind(3)) == 1);
  selector.place(glm::dmat4(1.0), 1.1, false, false, true);  // displaced as far as the wall
  CHECK(selected(selector, behind(3)) == 1);
  // Displaced along the axis. The rounding of each depth is 1e-4 of it, 0.4 mm together: nearer than slack + 0.4 mm
  // behind the wall it may be visible.
  constexpr double kSlack_m = 5e-4, kBehind_m = 7.5e-4;
  const auto large = [&](double z_m) {
    return std::vector{at_px(100, 50, z_m), at_px(180, 50, z_m), at_px(101, 130, z_m)};
  };
  selector.place(glm::dmat4(1.0), 0, false, false, true);
  CHECK(selected(selector, large(kWall_m + kBehind_m)) == 0);
  selector.place(glm::dmat4(1.0), kSlack_m, false, false, true);
  CHECK(selected(selector, large(kWall_m + kBehind_m)) == 1);
  CHECK(selected(selector, large(kWall_m + 10 * kSlack_m)) == 0);
  selector.place(glm::scale(glm::dmat4(1.0), {-1, 1, 1}), 0, false, true, true);
  std::vector<glm::vec3> mirrored = behind(3);
  for (glm::vec3& corner : mirrored) corner.x = -corner.x;
  CHECK(selected(selector, mirrored) == 0);
  selector.place(glm::scale(glm::dmat4(1.0), {1, 1, 1.5}), 0, false, false, true);  // D is not known of unequal scales
  std::vector<glm::vec3> scaled = behind(3);
  for (glm::vec3& corner : scaled) corner.z /= 1.5f;
  CHECK(selected(selector, scaled) == 1);
}

TEST_CASE("of a finely divided sphere a device on the host's cores draws what can change a pixel, to the same bytes") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(17);
  for (const std::uint32_t supersampling : {1u, 2u}) {
    for (const std::uint32_t msaa : {1u, 4u}) {
      CAPTURE(supersampling);
      CAPTURE(msaa);
      DrawList list;
      for (int i = 0; i < 6; ++i) {
        const glm::dvec3 place(0.4 * (i - 3), 0.2 * (i % 3), 3);
        const glm::dvec3 scale(i % 2 ? 1 : -1, 1, i % 3 ? 1 : 1.5);
        add_item(list, sphere_mesh(0.3, 150),
                 glm::scale(glm::translate(glm::dmat4(1.0), place) * random_turn(random), scale));
      }
      FramePlan plan;
      plan.passes.push_back({.name = "picture",
                             .width_px = kSelectedWidth_px,
                             .height_px = kSelectedHeight_px,
                             .color = true,
                             .depth = supersampling * msaa == 1,
                             .views = {selecting_view()},
                             .supersampling = supersampling,
                             .msaa = msaa});
      const auto draw = [&](bool culled) {
        plan.passes[0].views[0].culled = culled;
        const PassResult result = renderer.render(list, plan)[0];
        return std::pair(std::vector<float>(result.depth.begin(), result.depth.end()),
                         std::vector<glm::vec4>(result.color.begin(), result.color.end()));
      };
      const auto seen = draw(true);
      const std::uint64_t drawn = renderer.counters().triangles;
      CHECK(seen == draw(false));
      // The front halves at most; of these, with one sample for a pixel, those that are about as large as a pixel.
      if (device.is_cpu()) CHECK(drawn < renderer.counters().triangles / (supersampling * msaa == 1 ? 4 : 2));
    }
  }
}

TEST_SUITE_END();
