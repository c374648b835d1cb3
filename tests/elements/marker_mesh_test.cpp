// Meshes of markers are closed, face outwards and have the given size.
#include "elements/visualization/marker_mesh.h"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <tuple>
#include <utility>

TEST_SUITE_BEGIN("elements");

namespace simvis {
namespace {

const glm::vec4 kColor(0.25f, 0.5f, 0.75f, 0.5f);

double volume_m3(const Mesh& mesh) {
  double volume = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                     c = mesh.positions[mesh.indices[i + 2]];
    volume += glm::dot(a, glm::cross(b, c)) / 6;
  }
  return volume;
}

// Each edge between two corners is used once in each direction. Corners at the same place count as one.
bool is_closed(const Mesh& mesh) {
  const auto before = [](const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::map<glm::vec3, int, decltype(before)> places(before);
  std::map<std::pair<int, int>, int> edges;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
    const auto place = [&](std::size_t at) {
      return places.emplace(mesh.positions[mesh.indices[at]], static_cast<int>(places.size())).first->second;
    };
    const int from = place(i), to = place(next);
    ++edges[{from, to}];
  }
  for (const auto& [edge, count] : edges) {
    if (count != 1 || !edges.contains({edge.second, edge.first})) return false;
  }
  return true;
}

void check_common(const Mesh& mesh) {
  CHECK(mesh.name == "marks");
  CHECK(mesh.topology == Topology::triangles);
  REQUIRE(mesh.attributes.size() == mesh.positions.size());
  for (const VertexAttributes& each : mesh.attributes) CHECK(each.color == kColor);
  Mesh bounded = mesh;
  compute_bounds(bounded);
  CHECK(bounded == mesh);
}

// Each corner is rounded by at most half a unit in the last place. Volumes of bodies within `reach_m` then have an
// error of at most their surface times that, and the sum of tetrahedra from the origin adds several roundings in
// double.
double volume_tolerance_m3(double surface_m2, double reach_m) { return surface_m2 * std::ldexp(2 * reach_m, -24); }

TEST_CASE("a point is an octahedron") {
  MarkerMesh markers;
  markers.add_point({1, -2, 3}, 0.5, kColor);
  const auto mesh = markers.take("marks");
  check_common(*mesh);
  CHECK(is_closed(*mesh));
  CHECK(mesh->bounds_min == glm::vec3(0.75f, -2.25f, 2.75f));
  CHECK(mesh->bounds_max == glm::vec3(1.25f, -1.75f, 3.25f));
  // size^3 / 6 between opposite corners; eight faces of sqrt(3) / 8 * size^2.
  CHECK(std::abs(volume_m3(*mesh) - 0.125 / 6) < volume_tolerance_m3(std::sqrt(3.0) * 0.25, 4));
}

TEST_CASE("a line is a bar whose sides have the given width in any direction") {
  for (const glm::dvec3& to : {glm::dvec3(3, 0, 0), glm::dvec3(0, -3, 0), glm::dvec3(0, 0, 3), glm::dvec3(0, 0, -3),
                               glm::dvec3(-1, 2, 2), glm::dvec3(-2e-3, 1e-3, 2e-3)}) {
    CAPTURE(to.x);
    CAPTURE(to.z);
    const double length_m = glm::length(to), width_m = 0.1 * length_m;
    MarkerMesh markers;
    markers.add_line({0, 0, 0}, to, width_m, kColor);
    const auto mesh = markers.take("marks");
    check_common(*mesh);
    CHECK(is_closed(*mesh));
    const double base_m2 = std::sqrt(3.0) / 4 * width_m * width_m;
    CHECK(std::abs(volume_m3(*mesh) - base_m2 * length_m) <
          volume_tolerance_m3(3 * width_m * length_m + 2 * base_m2, length_m));
  }
}

TEST_CASE("a horizontal line seen from above shows its upper edge") {
  MarkerMesh markers;
  markers.add_line({0, 0, 0}, {5, 0, 0}, 0.3, kColor);
  const auto mesh = markers.take("marks");
  // The middle of three corners lies two thirds of the height, sqrt(3) / 2 * width, below the upper one.
  const double rounding_m = std::ldexp(0.25, -24);  // of a float32 below 0.25, once
  CHECK(std::abs(mesh->bounds_max.z - 0.3 / std::sqrt(3.0)) <= rounding_m);
  CHECK(std::abs(mesh->bounds_min.z + 0.3 / std::sqrt(3.0) / 2) <= rounding_m);
}

TEST_CASE("an arrow ends at its tip, and its head takes no more than half of it") {
  for (const double width_m : {0.01, 0.5}) {
    MarkerMesh markers;
    markers.add_arrow({0, 1, 0}, {0, 1, 2}, width_m, kColor);
    const auto mesh = markers.take("marks");
    check_common(*mesh);
    CHECK(is_closed(*mesh));
    CHECK(mesh->bounds_min.z == 0);
    CHECK(mesh->bounds_max.z == 2);
    CHECK(volume_m3(*mesh) > 0);
    float neck = 2;  // the lowest corner that is outside the shaft's radius
    for (const glm::vec3& p : mesh->positions) {
      if (std::hypot(p.x, p.y - 1) > width_m) neck = std::min(neck, p.z);
    }
    CHECK(neck < 2);
    CHECK(neck >= 1);
  }
}

TEST_CASE("an empty marker has an empty mesh") {
  MarkerMesh markers;
  markers.add_point({1, 2, 3}, 0, kColor);
  markers.add_line({1, 2, 3}, {4, 5, 6}, 0, kColor);
  markers.add_line({1, 2, 3}, {1, 2, 3}, 1, kColor);
  markers.add_arrow({1, 2, 3}, {1, 2, 3}, 1, kColor);
  markers.add_arrow({1, 2, 3}, {4, 5, 6}, 0, kColor);
  CHECK(markers.take("marks")->positions.empty());
  markers.add_point({1, 2, 3}, 1, kColor);
  CHECK(markers.take("marks")->indices.size() == 24);
  CHECK(markers.take("marks")->indices.empty());
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
