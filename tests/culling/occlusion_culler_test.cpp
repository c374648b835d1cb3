// Objects hidden by walls are not drawn, and the picture has the same bytes. See engine/culling/occlusion_culler.h and
// engine/culling/occluders.h.
#include "engine/culling/occlusion_culler.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>

#include <simvis/device.h>
#include "engine/culling/normal_cone.h"
#include "engine/render/renderer.h"
#include "tests/culling/culled_picture.h"
#include "tests/support/random_room.h"

TEST_SUITE_BEGIN("engine/culling");

using namespace simvis;

namespace {

constexpr std::uint32_t kWidth_px = 320, kHeight_px = 240;
constexpr double kFocal_px = 250, kPixelSnap_px = 1.0 / 256;

struct Shown {
  bool color = true;
  std::uint32_t supersampling = 1, msaa = 1;
  bool back_faces = false;
};

FramePlan picture(const Shown& shown = {}) {
  View view;
  view.pinhole = {kFocal_px, kFocal_px, kWidth_px / 2.0, kHeight_px / 2.0};
  view.width_px = kWidth_px;
  view.height_px = kHeight_px;
  view.sees_back_faces = shown.back_faces;
  FramePlan plan;
  plan.passes.push_back({.name = "picture",
                         .width_px = kWidth_px,
                         .height_px = kHeight_px,
                         .color = shown.color,
                         .depth = shown.supersampling * shown.msaa == 1,
                         .views = {view},
                         .supersampling = shown.supersampling,
                         .msaa = shown.msaa});
  return plan;
}

/// A rectangle perpendicular to the optical axis, with `corners` in an order that turns its front or its back to the
/// camera.
Mesh rectangle(double half_width_m, double half_height_m, bool front) {
  Mesh mesh;
  const double w = half_width_m, h = half_height_m;
  mesh.positions = {glm::dvec3(-w, -h, 0), glm::dvec3(w, -h, 0), glm::dvec3(w, h, 0), glm::dvec3(-w, h, 0)};
  mesh.indices = {0, 2, 1, 0, 3, 2};  // y points down: from the camera, this is counterclockwise
  if (!front) mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// Rotated boxes and spheres at depths from 6 to 12 m in the picture, with `triangles` or more.
std::uint64_t add_things(DrawList& list, std::mt19937& random, std::uint64_t triangles) {
  std::uint64_t added = 0;
  for (int i = 0; added < triangles; ++i) {
    const double z = between(random, 6, 12);
    const glm::dvec3 place(z * between(random, -0.4, 0.4), z * between(random, -0.3, 0.3), z);
    const double size = between(random, 0.05, 0.4);
    Mesh mesh = i % 4 ? half_box_mesh(size * glm::dvec3(1, 0.7, 0.4)) : sphere_mesh(size, i % 8 ? 24 : 64);
    added += mesh.indices.size() / 3;
    add_item(list, std::move(mesh), glm::translate(glm::dmat4(1.0), place) * random_turn(random));
  }
  return added;
}

std::uint32_t add_material(DrawList& list, const Material& material) {
  list.materials.push_back(std::make_shared<Material>(material));
  list.material_revision.push_back(0);
  return static_cast<std::uint32_t>(list.materials.size() - 1);
}

std::vector<Occluder> extract_occluders(const Mesh& mesh) {
  Mesh whole = mesh;
  compute_bounds(whole);
  return simvis::extract_occluders(whole, make_clusters(whole));
}

}  // namespace

TEST_CASE("a box has six occluders, its sides, each of two triangles that face outwards") {
  const glm::dvec3 half(1, 2, 3);
  const std::vector<Occluder> walls = extract_occluders(half_box_mesh(half));
  REQUIRE(walls.size() == 6);
  double area = 0;
  for (const Occluder& wall : walls) {
    REQUIRE(wall.count == 4);
    const glm::dvec3 a(wall.corners[0]), b(wall.corners[1]), c(wall.corners[2]), d(wall.corners[3]);
    const glm::dvec3 first = glm::cross(b - a, c - a), second = glm::cross(c - a, d - a);
    CHECK(glm::dot(first, a) > 0);
    CHECK(first == second);
    area += glm::length(first) / 2 + glm::length(second) / 2;
  }
  CHECK(area == 8 * (half.x * half.y + half.y * half.z + half.z * half.x));
}

TEST_CASE("bent, non-convex or unequal sides are no quadrangles, and small sides are no occluders") {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  CHECK(extract_occluders(mesh).size() == 1);
  SUBCASE("bent") { mesh.positions[3].z = 0.01f; }
  SUBCASE("not convex") {
    mesh.positions[2] = {0, 1, 0};
    mesh.positions[3] = {-1, 3, 0};
  }
  SUBCASE("one turned over") { mesh.indices = {0, 1, 2, 0, 3, 2}; }
  const std::vector<Occluder> walls = extract_occluders(mesh);
  CHECK(walls.size() == 2);
  for (const Occluder& wall : walls) CHECK(wall.count == 3);
  CHECK(extract_occluders(sphere_mesh(1, 200)).empty());
  CHECK(extract_occluders(sphere_mesh(1, 24)).size() <= kMaxOccluders);
}

TEST_CASE("a box has six flat sides for any grid on them, and a sphere has none") {
  const auto sides_of = [](Mesh mesh) {
    compute_bounds(mesh);
    return face_planes_of(mesh, make_clusters(mesh));
  };
  constexpr double kRounding = 1e-12;  // of the double products here
  const FacePlanes box = sides_of(half_box_mesh({1, 2, 3}));
  REQUIRE(box.sides.size() == 6);
  for (const FacePlane& side : box.sides) {
    const glm::dvec3 half(1, 2, 3);
    CHECK(glm::length(side.normal) == doctest::Approx(1).epsilon(kRounding));
    CHECK(side.offset == doctest::Approx(glm::dot(glm::abs(side.normal), half)).epsilon(kRounding));
    // Half of a rectangle a x b: a b over its diagonal.
    const glm::dvec3 sizes = 2.0 * half * (glm::dvec3(1) - glm::abs(side.normal));
    const double product = 8 * half.x * half.y * half.z / glm::dot(2.0 * half, glm::abs(side.normal));
    CHECK(side.min_height == doctest::Approx(product / glm::length(sizes)).epsilon(kRounding));
  }
  Mesh folded = half_box_mesh({1, 2, 3});  // each side once more, facing inwards
  for (std::size_t i = 0; i < 36; i += 3) {
    folded.indices.insert(folded.indices.end(), {folded.indices[i], folded.indices[i + 2], folded.indices[i + 1]});
  }
  CHECK(sides_of(folded).sides.size() == 6);
  CHECK(sides_of(sphere_mesh(1, 24)).sides.empty());
}

TEST_CASE(
    "the tiles of a wall hide objects behind all of them, and no object that may reach beside or in front of them") {
  const View view = picture().passes[0].views[0];
  OcclusionCuller hidden;
  hidden.begin(view, kPixelSnap_px);
  // A cube that contains a square perpendicular to the optical axis, which is never seen as a sliver.
  const auto is_occluded = [&](const glm::dvec3& center, double half) {
    const FacePlanes flat{.sides = {{.normal = {0, 0, 1}, .offset = 0, .min_height = half}}};
    return hidden.is_occluded({.center = center, .half_size = glm::dvec3(half), .slack_m = 0},
                              glm::translate(glm::dmat4(1.0), center), {.flat = &flat});
  };
  CHECK_FALSE(hidden.any());
  CHECK_FALSE(is_occluded({0, 0, 8}, 0.1));
  // At 4 m, 125 px to either side of the centre.
  const std::vector<Occluder> walls = extract_occluders(rectangle(2, 1, true));
  hidden.add(walls, glm::translate(glm::dmat4(1.0), {0, 0, 4}), 0, true, false);
  CHECK(hidden.any());
  CHECK(is_occluded({0, 0, 8}, 0.1));
  CHECK(is_occluded({0, 0, 4.2}, 0.05));  // the diagonal of the two triangles runs through it
  CHECK(is_occluded({3.5, 0, 8}, 0.1));
  CHECK_FALSE(is_occluded({4.05, 0, 8}, 0.1));  // visible beside the wall
  CHECK_FALSE(is_occluded({0, 2.05, 8}, 0.1));
  CHECK_FALSE(is_occluded({0, 0, 4.05}, 0.1));  // reaches through it
  CHECK_FALSE(is_occluded({0, 0, 3}, 0.1));
  CHECK_FALSE(is_occluded({0, 0, 8}, 3.6));
  CHECK_FALSE(is_occluded({0, 0, -8}, 0.1));
  // A wall that shows its back where only fronts are drawn, and its mirror image, where both are swapped.
  hidden.begin(view, kPixelSnap_px);
  const glm::dmat4 mirrored = glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 4}), {-1, 1, 1});
  hidden.add(walls, mirrored, 0, true, false);
  hidden.add(extract_occluders(rectangle(2, 1, false)), glm::translate(glm::dmat4(1.0), {0, 0, 4}), 0, true, false);
  CHECK_FALSE(hidden.any());
  hidden.add(walls, mirrored, 0, true, true);
  CHECK(is_occluded({0, 0, 8}, 0.1));
}

TEST_CASE("objects behind walls are not drawn, and the picture is the same to the byte") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(17);
  std::uint64_t bare_of_all = 0, behind_of_all = 0;
  for (const Shown& shown : {Shown{}, Shown{.color = false}, Shown{.color = false, .back_faces = true},
                             Shown{.supersampling = 2, .msaa = 4}}) {
    for (int round = 0; round < 4; ++round) {
      CAPTURE(round);
      DrawList list;
      const std::uint64_t things = add_things(list, random, 6000);
      const std::uint64_t bare = test::draw_both_ways(renderer, list, picture(shown)).culled;
      CHECK(bare > things / 40);  // others show their backs, lie between samples or behind other things
      // Slightly rotated walls at 3 to 5 m with gaps between them.
      for (int i = 0; i < 3; ++i) {
        const glm::dvec3 place(i - 1 + between(random, -0.2, 0.2), between(random, -0.3, 0.3), between(random, 3, 5));
        const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), between(random, -0.6, 0.6), glm::dvec3(0, 1, 0));
        add_item(list, rectangle(between(random, 0.5, 2), between(random, 0.5, 3), true),
                 glm::translate(glm::dmat4(1.0), place) * turn);
      }
      const std::uint64_t behind = test::draw_both_ways(renderer, list, picture(shown)).culled;
      bare_of_all += bare;
      behind_of_all += behind;
    }
  }
  CHECK(behind_of_all < bare_of_all * 3 / 4);
}

TEST_CASE("walls fill tiles up to their edges, less the largest displacement of an edge in the view") {
  View view = picture().passes[0].views[0];
  double left_end_px = 0;
  bool fills = false;
  // Displaced by 1 + the tangent of the image's side, times kDisplaced_px / 2, and by snapping: 0.11 and 0.20 px.
  SUBCASE("not quite") { left_end_px = 160.1; }
  SUBCASE("just") {
    left_end_px = 160.12;
    fills = true;
  }
  SUBCASE("not quite, in a view of 127 degrees") {
    view.pinhole.fx_px = view.pinhole.fy_px = 80;
    left_end_px = 160.18;
  }
  SUBCASE("just, in a view of 127 degrees") {
    view.pinhole.fx_px = view.pinhole.fy_px = 80;
    left_end_px = 160.21;
    fills = true;
  }
  SUBCASE("in an image that tiles do not divide") {
    view.width_px = kWidth_px - 1;
    view.height_px = kHeight_px - 1;
    left_end_px = 160.2;
    fills = true;
  }
  CAPTURE(view.pinhole.fx_px);
  OcclusionCuller hidden;
  hidden.begin(view, kPixelSnap_px);
  constexpr double kWall_m = 4, kHalf_m = 20;
  const auto at_px = [&](double u) { return (u - view.pinhole.cx_px) * kWall_m / view.pinhole.fx_px; };
  const std::vector<Occluder> wall = extract_occluders(rectangle(kHalf_m, kHalf_m, true));
  for (const double middle_m : {at_px(left_end_px) - kHalf_m, at_px(161) + kHalf_m}) {
    hidden.add(wall, glm::translate(glm::dmat4(1.0), {middle_m, 0, kWall_m}), 0, true, false);
  }
  const auto hides = [&](double left_px, double right_px) {
    return std::isfinite(hidden.min_seen_m2({left_px, right_px, 118, 122, 8, 8.1}, 0));
  };
  CHECK(hides(158.2, 159.8) == fills);  // the last tile that the left wall may fill
  CHECK_FALSE(hides(160.5, 161.5));
  CHECK_FALSE(hides(162 + kPixelSnap_px, 170));  // snapping may bring it into the tile before
  CHECK(hides(162.1, 170));
  CHECK(hides(300, view.width_px - 0.1));
  CHECK_FALSE(hides(-1, 5));
}

TEST_CASE("a wall whose corners rounding may move along the axis hides only what is behind all places of it") {
  View view;  // so few pixels that a displacement along the axis counts more than one across
  view.pinhole = {10, 10, 8, 6};
  view.width_px = 16;
  view.height_px = 12;
  OcclusionCuller hidden;
  hidden.begin(view, kPixelSnap_px);
  constexpr double kWall_m = 4, kSlack_m = 0.02;
  hidden.add(extract_occluders(rectangle(30, 30, true)), glm::translate(glm::dmat4(1.0), {15, 0, kWall_m}), kSlack_m,
             true, false);
  REQUIRE(hidden.any());
  const auto hides = [&](double nearest_m) {
    return std::isfinite(hidden.min_seen_m2({5, 10, 3, 8, nearest_m, nearest_m + 0.1}, 0));
  };
  CHECK_FALSE(hides(kWall_m + 0.9 * kSlack_m));
  // Two of kRounding, and the slack to first order in slack / z.
  CHECK(hides(kWall_m * (1 + 2 * kRounding) + 1.1 * kSlack_m));
}

TEST_CASE("a wall of two triangles that are not quite in one plane hides only what is behind both") {
  View view = picture().passes[0].views[0];
  view.pinhole.fx_px = view.pinhole.fy_px = 40;  // a wide view of a long wall, whose corner may be off by more
  constexpr double kWall_m = 4, kHalfWidth_m = 14, kHalfHeight_m = 10;
  constexpr double kOff_m = 0.95e-4 * 2 * kHalfWidth_m;  // beyond 1e-4 of a side, the triangles are two occluders
  for (std::size_t bent = 0; bent < 4; ++bent) {
    CAPTURE(bent);
    Mesh wall = rectangle(kHalfWidth_m, kHalfHeight_m, true);
    const glm::vec3 corner = wall.positions[bent];
    wall.positions[bent].z = static_cast<float>(kOff_m);
    const std::vector<Occluder> occluders = extract_occluders(wall);
    REQUIRE(occluders.size() == 1);
    REQUIRE(occluders[0].count == 4);
    OcclusionCuller hidden;
    hidden.begin(view, kPixelSnap_px);
    hidden.add(occluders, glm::translate(glm::dmat4(1.0), {0, 0, kWall_m}), 0, true, false);
    // Beside the corner, by 2.5 % of the wall's width and height: the wall is off by 95 % there.
    const double u = 160 + 0.95 * kHalfWidth_m * 10 * (corner.x < 0 ? -1 : 1),
                 v = 120 + 0.95 * kHalfHeight_m * 10 * (corner.y < 0 ? -1 : 1);
    const auto hides = [&](double nearest_m) {
      return std::isfinite(hidden.min_seen_m2({u - 0.5, u + 0.5, v - 0.5, v + 0.5, nearest_m, nearest_m + 0.1}, 0));
    };
    CHECK_FALSE(hides(kWall_m + 0.9 * kOff_m));
    CHECK(hides(kWall_m * (1 + 2 * kRounding) + 2 * kOff_m));
  }
}

TEST_CASE("the middle of a box is hidden if a wall is before it, and of a box that lies nowhere it is not") {
  const View view = picture().passes[0].views[0];
  OcclusionCuller hidden;
  const auto hides = [&](double x, double z) {
    return hidden.hides_middle({.center = {x, 0, z}, .half_size = glm::dvec3(1)});
  };
  hidden.begin(view, kPixelSnap_px);
  CHECK_FALSE(hides(0, 8));
  hidden.add(extract_occluders(rectangle(2, 2, true)), glm::translate(glm::dmat4(1.0), {-2, 0, 4}), 0, true, false);
  CHECK(hides(-1, 8));
  CHECK(hides(-100, 8));  // beyond the image; the nearest tile counts
  CHECK_FALSE(hides(1, 8));
  CHECK_FALSE(hides(-1, 3));
  CHECK_FALSE(hides(-1, -8));
  constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNone = std::nan("");
  CHECK_FALSE(hides(kNone, kNone));
  CHECK_FALSE(hides(1, kNone));
  hides(kNone, kInfinity);  // any answer, without a place beyond the tiles
  hides(kInfinity, kInfinity);
  CHECK_FALSE(hides(kInfinity, 8));
}

TEST_CASE("the side of an image cuts an object behind a wall: of its triangles only those at the side are drawn") {
  Device device;
  Renderer renderer(device);
  const auto drawn = [&](bool behind_wall) {
    constexpr double kDepth_m = 8, kCut_m = kDepth_m * kWidth_px / 2 / kFocal_px - 0.5;
    DrawList list;
    if (behind_wall) add_item(list, rectangle(20, 20, true), glm::translate(glm::dmat4(1.0), {0, 0, 4}));
    for (int i = -5; i <= 5; ++i) {
      add_item(list, sphere_mesh(0.7, 24),
               glm::translate(glm::dmat4(1.0), {i % 2 == 0 ? kCut_m : -kCut_m, 0.5 * i, kDepth_m}));
    }
    return test::draw_both_ways(renderer, list, picture()).culled;
  };
  const std::uint64_t behind = drawn(true), bare = drawn(false);
  // Whole clusters beyond or across the side remain: half of what is drawn without the wall. Without a test of each
  // triangle two thirds would.
  if (device.is_cpu()) CHECK(behind < bare * 6 / 10);
}

TEST_CASE("a ceiling that continues behind the camera hides objects above it") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(2);
  for (int round = 0; round < 6; ++round) {
    CAPTURE(round);
    DrawList list;
    std::uint64_t things = 0;
    for (int i = 0; i < 600; ++i, things += 12) {
      const glm::dvec3 place(between(random, -8, 8), between(random, -3, -2), between(random, 2, 15));
      add_item(list, half_box_mesh({0.2, 0.1, 0.3}), glm::translate(glm::dmat4(1.0), place) * random_turn(random));
    }
    const std::uint64_t bare = test::draw_both_ways(renderer, list, picture()).culled;
    const glm::dmat4 up = glm::rotate(glm::dmat4(1.0), -0.5 * 3.141592653589793, glm::dvec3(1, 0, 0));
    const glm::dmat4 ceiling = glm::translate(glm::dmat4(1.0), {between(random, -1, 1), -1.4, 3}) *
                               glm::rotate(glm::dmat4(1.0), between(random, -3, 3), glm::dvec3(0, 1, 0)) * up;
    add_item(list, rectangle(40, 40, round % 2), ceiling);
    Material both_sides;
    both_sides.double_sided = true;
    list.items.back().material = add_material(list, both_sides);
    const std::uint64_t behind = test::draw_both_ways(renderer, list, picture()).culled;
    MESSAGE(things << " triangles, " << bare << " drawn, behind the ceiling " << behind);
    CHECK(behind < bare / 2);
  }
}

TEST_CASE("a transparent surface hides nothing") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(5);
  DrawList list;
  add_things(list, random, 4000);
  const std::uint64_t bare = test::draw_both_ways(renderer, list, picture()).culled;
  add_item(list, rectangle(1.5, 1.5, true), glm::translate(glm::dmat4(1.0), {0, 0, 4}));
  CHECK(test::draw_both_ways(renderer, list, picture()).culled < bare / 2);
  Material material;
  SUBCASE("masked") { material.alpha_mode = AlphaMode::mask; }
  SUBCASE("blended") {
    material.alpha_mode = AlphaMode::blend;
    material.base_color.a = 0.5f;
  }
  SUBCASE("faded") { material.opacity = 0.5f; }
  SUBCASE("not there") { material.opacity = 0; }
  list.items.back().material = add_material(list, material);
  ++list.revisions.structure;
  CHECK(test::draw_both_ways(renderer, list, picture()).culled >= bare);
}

TEST_CASE("transparent, masked and mirrored objects are hidden like all others") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(8);
  DrawList list;
  add_things(list, random, 4000);
  Material glass, leaves;
  glass.alpha_mode = AlphaMode::blend;
  glass.base_color.a = 0.5f;
  leaves.alpha_mode = AlphaMode::mask;
  const std::uint32_t kinds[] = {0, add_material(list, glass), add_material(list, leaves)};
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    list.items[i].material = kinds[i % 3];
    if (i % 5 == 0) {
      glm::dmat4& place = list.world_from_node[list.items[i].transform];
      place = glm::scale(place, {-1, 1, 1});
    }
  }
  const std::uint64_t bare = test::draw_both_ways(renderer, list, picture()).culled;
  add_item(list, rectangle(1.5, 1.5, true), glm::translate(glm::dmat4(1.0), {0, 0, 4}));
  CHECK(test::draw_both_ways(renderer, list, picture()).culled < bare / 2);
}

// The depth of surfaces that are seen almost edge-on may have any value, also nearer than the wall: see
// engine/culling/facing_tolerance.h. So they must be drawn even behind a wall.
TEST_CASE("surfaces seen edge-on behind a wall give the same bytes") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(31);
  int sheets = 1;
  SUBCASE("one sheet") {}
  SUBCASE("many, of which none is a side of its own") { sheets = kMaxFacePlanes + 1; }
  Mesh mesh;  // upright, 2 mm apart
  for (int i = 0; i < sheets; ++i) {
    const float x = 2e-3f * static_cast<float>(i);
    const std::uint32_t n = 4 * static_cast<std::uint32_t>(i);
    mesh.positions.insert(mesh.positions.end(), {{x, -1, -0.1f}, {x, 1, -0.1f}, {x, 1, 0.1f}, {x, -1, 0.1f}});
    mesh.indices.insert(mesh.indices.end(), {n, n + 1, n + 2, n, n + 2, n + 3, n, n + 2, n + 1, n, n + 3, n + 2});
  }
  std::uint64_t drawn = 0, all = 0;
  for (int round = 0; round < 4; ++round) {
    DrawList list;
    for (int i = 0; i < 600; ++i, all += mesh.indices.size() / 3) {
      // The plane of the first one passes almost through the eye, and it is seen at the centre of a pixel.
      const double u = std::floor(between(random, 60, 260)) + 0.5 + between(random, -2, 2) * kPixelSnap_px;
      const double azimuth = std::atan((u - kWidth_px / 2.0) / kFocal_px),
                   off_rad = std::pow(10, between(random, -5, 0));
      const glm::dmat4 towards = glm::rotate(glm::dmat4(1.0), azimuth, glm::dvec3(0, 1, 0));
      const glm::dmat4 place = glm::translate(towards, {0, between(random, -0.5, 0.5), 7}) *
                               glm::rotate(glm::dmat4(1.0), off_rad, glm::dvec3(0, 1, 0));
      add_item(list, mesh, place);
    }
    add_item(list, rectangle(6, 6, true), glm::translate(glm::dmat4(1.0), {0, 0, 4.9}));
    drawn += test::draw_both_ways(renderer, list, picture()).culled;
  }
  // With planes off by half a centimetre per metre, two of the five decades are thick enough to be classified.
  CHECK(drawn < all * 2 / 3);
}

TEST_SUITE_END();
