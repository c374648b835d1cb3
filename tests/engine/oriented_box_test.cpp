// The box of a mesh in another frame.
#include "engine/draw/oriented_box.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenegraph/primitive_meshes.h"

TEST_SUITE_BEGIN("engine");

namespace simvis::test {
namespace {

constexpr double kBoxRounding_m = 1e-15;  // some units of the last place of lengths up to 1 m

// Whether a box holds the corners of a mesh and is no longer along any of its axes than they are.
void check_box(const OrientedBox& box, const Mesh& mesh, const glm::dmat4& frame_from_mesh) {
  const glm::dmat3 axes(glm::mat3_cast(box.orientation));
  glm::dvec3 most(0);
  for (const glm::vec3& position : mesh.positions) {
    const glm::dvec3 at(frame_from_mesh * glm::dvec4(position, 1));
    most = glm::max(most, glm::abs(glm::transpose(axes) * (at - box.centre_m)));
  }
  for (int i = 0; i < 3; ++i) CHECK(std::abs(2 * most[i] - box.size_m[i]) <= kBoxRounding_m);
  CHECK(std::abs(glm::length(box.orientation) - 1) <= kBoxRounding_m);
}

}  // namespace

TEST_CASE("a mesh that is flattened has a box of finite numbers") {
  const Mesh mesh = box_mesh({0.5, 0.25, 1});
  for (const std::array<double, 3>& scale :
       {std::array<double, 3>{1, 1, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}}) {
    CAPTURE(scale[0] * 100 + scale[1] * 10 + scale[2]);
    const glm::dmat4 turn(glm::dmat3(0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1));
    glm::dmat4 stretch(1);
    for (int i = 0; i < 3; ++i) stretch[i][i] = scale[static_cast<std::size_t>(i)];
    check_box(oriented_box(mesh.bounds_min, mesh.bounds_max, turn * stretch), mesh, turn * stretch);
    CHECK(oriented_box(mesh.bounds_min, mesh.bounds_max, turn * stretch).size_m.z <= 1 + kBoxRounding_m);
  }
  // Sheared until the second axis lies on the first one.
  const glm::dmat4 sheared(1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
  check_box(oriented_box(mesh.bounds_min, mesh.bounds_max, sheared), mesh, sheared);
}

}  // namespace simvis::test

TEST_SUITE_END();
