#include "engine/culling/normal_cone.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include <simvis/device.h>
#include "engine/render/renderer.h"
#include "engine/vulkan/device_impl.h"
#include "tests/culling/culled_picture.h"
#include "tests/support/random_room.h"

TEST_SUITE_BEGIN("engine/culling");

using namespace simvis;

namespace {

constexpr double kSnap_px = 1.0 / 256;

struct Corners {
  glm::dvec3 a, b, c;
  glm::dvec3 normal() const { return glm::cross(b - a, c - a); }
};

/// Calls `look` for each triangle of a cluster with three corners in three different places.
template <typename Look>
void each_triangle(const Mesh& mesh, const Clustering& clustering, const Cluster& cluster, const Look& look) {
  const auto vertices = clustering.vertices_of(cluster);
  const auto corners = clustering.corners_of(cluster);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const Corners t{mesh.positions[vertices[corners[i]]], mesh.positions[vertices[corners[i + 1]]],
                    mesh.positions[vertices[corners[i + 2]]]};
    if (t.a != t.b && t.b != t.c && t.c != t.a) look(t);
  }
}

View camera(std::uint32_t width_px, std::uint32_t height_px, double focal_px) {
  View view;
  view.pinhole = {focal_px, focal_px, width_px / 2.0, height_px / 2.0};
  view.near_m = 1e-3;
  view.width_px = width_px;
  view.height_px = height_px;
  return view;
}

FramePlan picture_of(const View& view) {
  FramePlan plan;
  plan.passes.push_back({.name = "picture",
                         .width_px = view.width_px,
                         .height_px = view.height_px,
                         .color = true,
                         .depth = true,
                         .views = {view}});
  return plan;
}

/// Devices on the host's cores draw single triangles of clusters; all others draw whole clusters.
void select_no_triangles(Device& device) {
  device.impl().physical.properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_OTHER;
}

/// A sphere with its front inside: from outside the nearer half shows its back, and nothing hides the visible part.
Mesh hollow_mesh(double radius_m, int segments) {
  Mesh mesh = sphere_mesh(radius_m, segments);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) std::swap(mesh.indices[i], mesh.indices[i + 1]);
  return mesh;
}

}  // namespace

TEST_CASE("the cone of a cluster contains all of its normals, the apex offset all planes and the height all heights") {
  // Rounded outwards by a millionth: no violation is allowed, and little is lost.
  constexpr double kLost = 1e-5;
  for (const Mesh& mesh : {sphere_mesh(2, 90), sphere_mesh(1e-3, 24), half_box_mesh({1, 2, 3})}) {
    const Clustering clustering = make_clusters(mesh);
    const std::vector<NormalCone> facing = normal_cones_of(mesh, clustering);
    REQUIRE(facing.size() == clustering.clusters.size());
    for (std::size_t i = 0; i < facing.size(); ++i) {
      const Cluster& cluster = clustering.clusters[i];
      double cosine = 1, apex_offset = -1e9, height = 1e9;
      each_triangle(mesh, clustering, cluster, [&](const Corners& t) {
        const glm::dvec3 normal = glm::normalize(t.normal());
        cosine = std::min(cosine, glm::dot(normal, glm::dvec3(facing[i].axis)));
        apex_offset = std::max(apex_offset, glm::dot(normal, glm::dvec3(cluster.center) - t.a));
        const double longest = std::max({glm::distance(t.a, t.b), glm::distance(t.b, t.c), glm::distance(t.c, t.a)});
        height = std::min(height, glm::length(t.normal()) / longest);
      });
      if (glm::length(facing[i].axis) == 0) {  // a closed box
        CHECK(facing[i].cutoff <= 0);
        continue;
      }
      const double size = glm::length(glm::dvec3(cluster.half_size));
      CHECK(facing[i].cutoff <= cosine);
      CHECK(facing[i].cutoff >= cosine - kLost);
      CHECK(facing[i].apex_offset >= apex_offset);
      CHECK(facing[i].apex_offset <= apex_offset + kLost * size);
      CHECK(facing[i].min_height <= height);
      CHECK(facing[i].min_height >= height * (1 - kLost));
    }
  }
}

TEST_CASE("clusters classified as backfacing are so from every eye position, and few others are") {
  std::mt19937 random(5);
  const Mesh mesh = sphere_mesh(1, 96);
  const Clustering clustering = make_clusters(mesh);
  const std::vector<NormalCone> facing = normal_cones_of(mesh, clustering);
  const View view = camera(640, 480, 400);
  const ViewProjection projection = make_projection(view);
  const FacingTolerance limit(view, kSnap_px);
  std::size_t told = 0, true_backs = 0;
  for (int i = 0; i < 60; ++i) {
    // In front of the camera and completely visible; every third one is mirrored, in sizes from a millimetre to ten
    // metres.
    const double scale = std::pow(10, between(random, -3, 1));
    const glm::dvec3 place(between(random, -0.1, 0.1), between(random, -0.1, 0.1), between(random, 2.5, 6));
    const glm::dmat4 view_from_mesh = glm::translate(glm::dmat4(1.0), scale * place) * random_turn(random) *
                                      glm::scale(glm::dmat4(1.0), scale * glm::dvec3(i % 3 ? 1 : -1, 1, 1));
    const WorldBox box = make_box(view_from_mesh, glm::dvec3(0), glm::dvec3(1));
    const MeshPlanes planes = make_mesh_planes(projection, view_from_mesh, box);
    const NormalConeCuller eye(limit, planes, view_from_mesh);
    REQUIRE(eye.is_usable());
    const glm::dvec3 eye_in_mesh(glm::inverse(view_from_mesh)[3]);
    for (std::size_t c = 0; c < facing.size(); ++c) {
      bool backs = true;
      each_triangle(mesh, clustering, clustering.clusters[c],
                    [&](const Corners& t) { backs &= glm::dot(t.normal(), eye_in_mesh - t.a) < 0; });
      const bool said = eye.is_backfacing(clustering.clusters[c], facing[c]);
      if (said) CHECK(backs);
      told += said;
      true_backs += backs;
    }
  }
  MESSAGE(told << " of " << true_backs << " clusters that show only backs");
  // Clusters at the rim are tested by a cone that is wider than they are, and those at the poles have triangles that
  // are too thin.
  CHECK(told > true_backs * 3 / 4);
}

TEST_CASE("stretched meshes and orthographic views are never classified as backfacing") {
  View view = camera(640, 480, 400);
  const auto is_usable = [&](const glm::dmat4& view_from_mesh) {
    const WorldBox box = make_box(view_from_mesh, glm::dvec3(0), glm::dvec3(1));
    const MeshPlanes planes = make_mesh_planes(make_projection(view), view_from_mesh, box);
    const FacingTolerance limit(view, kSnap_px);
    return NormalConeCuller(limit, planes, view_from_mesh).is_usable();
  };
  const glm::dmat4 ahead = glm::translate(glm::dmat4(1.0), {0, 0, 3});
  CHECK(is_usable(ahead));
  CHECK(is_usable(glm::scale(ahead, {2, 2, -2})));
  CHECK_FALSE(is_usable(glm::scale(ahead, {2, 2, 2.001})));
  CHECK_FALSE(is_usable(glm::scale(ahead, glm::dvec3(0))));
  glm::dmat4 sheared(1.0);
  sheared[1].x = 0.01;
  CHECK_FALSE(is_usable(ahead * sheared));
  view.orthographic = true;
  view.near_m = 1;
  view.far_m = 10;
  CHECK_FALSE(is_usable(ahead));
}

TEST_CASE("pictures have the same bytes whether backs are drawn or not") {
  Device device;
  select_no_triangles(device);
  Renderer renderer(device);
  std::mt19937 random(3);
  std::uint64_t drawn = 0, whole = 0;
  for (const int segments : {24, 96, 300}) {
    DrawList list;
    for (int i = 0; i < 12; ++i) {
      const glm::dvec3 place(between(random, -2, 2), between(random, -1.5, 1.5), between(random, 2, 6));
      const glm::dvec3 size = between(random, 0.1, 0.8) * glm::dvec3(i % 3 ? 1 : -1, 1, i % 4 ? 1 : 1.3);
      add_item(list, i % 2 ? sphere_mesh(1, segments) : hollow_mesh(1, segments),
               glm::scale(glm::translate(glm::dmat4(1.0), place) * random_turn(random), size));
    }
    const auto [some, all] = test::draw_both_ways(renderer, list, picture_of(camera(640, 480, 500)));
    drawn += some;
    whole += all;
  }
  MESSAGE(drawn << " of " << whole << " triangles drawn");
  CHECK(drawn < whole * 4 / 5);
}

// The grid to which corners are snapped flips some triangles that are thinner than its step, and these show their
// fronts.
TEST_CASE("slivers with their backs to the camera give the same bytes, although some flip") {
  Device device;
  Renderer renderer(device);
  constexpr double kFocal_px = 400, kDistance_m = 3;
  const auto pixels_of_slivers = [&](double height_px) {
    Mesh slivers;
    for (std::uint32_t i = 0; i < 2000; ++i) {
      const double y = 0.0004 * i, height_m = height_px * kDistance_m / kFocal_px;
      slivers.positions.insert(slivers.positions.end(),
                               {glm::dvec3(-0.5, y, 0), glm::dvec3(0.5, y, 0), glm::dvec3(0.1, y + height_m, 0)});
      slivers.indices.insert(slivers.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    }
    // Their fronts face +z, away from the camera.
    DrawList list;
    add_item(list, slivers, glm::rotate(glm::translate(glm::dmat4(1.0), {0, 0, kDistance_m}), 0.3, {0, 0, 1}));
    const FramePlan plan = picture_of(camera(320, 240, kFocal_px));
    const std::span<const float> seen = renderer.render(list, plan)[0].depth;
    const auto turned = std::ranges::count_if(seen, [](float depth) { return depth > 0; });
    add_item(list, half_box_mesh({2, 2, 0.5}), glm::translate(glm::dmat4(1.0), {0, 0, kDistance_m + 3}));
    const auto [some, all] = test::draw_both_ways(renderer, list, picture_of(camera(320, 240, kFocal_px)));
    CHECK(all > 0);
    return turned;
  };
  CHECK(pixels_of_slivers(0.2 * kSnap_px) > 0);
  CHECK(pixels_of_slivers(0.7 * kSnap_px) > 0);
  CHECK(pixels_of_slivers(20 * kSnap_px) == 0);
}

TEST_CASE("a device with one draw at a time, or few, gives the same picture as one with many") {
  DrawList list;
  std::mt19937 random(9);
  for (int i = 0; i < 4; ++i) {
    add_item(list, sphere_mesh(0.4, 96), glm::translate(glm::dmat4(1.0), {i - 1.5, 0.2 * i, 3}) * random_turn(random));
  }
  const FramePlan plan = picture_of(camera(320, 240, 250));
  std::vector<float> expected;
  FrameCounters counters;
  for (const std::uint32_t max_draws : {1u, 3u, 0u}) {  // 0: no limit
    Device device;
    select_no_triangles(device);
    std::uint32_t& most = device.impl().physical.max_draws;
    if (max_draws > 0) most = std::min(most, max_draws);
    Renderer renderer(device);
    const std::span<const float> depth = renderer.render(list, plan)[0].depth;
    if (expected.empty()) {
      expected.assign(depth.begin(), depth.end());
      counters = renderer.counters();
      CHECK(counters.draws > 8);  // parts of each mesh
    }
    CHECK(std::ranges::equal(depth, expected));
    CHECK(renderer.counters() == counters);
  }
}

TEST_SUITE_END();
