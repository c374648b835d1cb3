// The element `frame_axes`: the directions of its arrows, and which sensors see it.
#include "elements/visualization/frame_axes.h"

#include <doctest/doctest.h>

#include <cmath>

#include <simvis/pose.h>
#include "tests/support/error_of.h"
#include "tests/support/people_view.h"

TEST_SUITE_BEGIN("elements");

namespace simvis {
namespace {

constexpr std::string_view kAxes = "<element type='frame_axes' name='E' insert_at='ROOT' length='2' width='0.1'/>";

// The extent of the corners of one colour along the axes of `world_from_frame`.
glm::dvec3 reach_of(const DrawList& list, const glm::dmat4& world_from_frame, int color) {
  glm::dvec3 reach{0};
  const DrawItem& item = list.items.at(0);
  const Mesh& mesh = *list.meshes[item.mesh];
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec4& c = mesh.attributes[i].color;
    if (c[color] < c[(color + 1) % 3] || c[color] < c[(color + 2) % 3]) continue;
    const glm::dvec3 local = rigid_inverse(world_from_frame) * glm::dvec4(world_corner(list, item, i), 1);
    reach = glm::max(reach, glm::abs(local));
  }
  return reach;
}

void check_arrows(const DrawList& list, const glm::dmat4& world_from_frame, double length_m, double width_m) {
  REQUIRE(list.items.size() == 1);
  // The transform and its inverse: corners are rounded in float32, and twice more in double where the frame is far from
  // the origin.
  const double world_m = glm::length(glm::dvec3(world_from_frame[3]));
  const double tolerance_m = 2 * corner_tolerance_m(length_m, world_m);
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 reach = reach_of(list, world_from_frame, axis);
    CHECK(std::abs(reach[axis] - length_m) < tolerance_m);
    for (const int other : {(axis + 1) % 3, (axis + 2) % 3}) {
      CHECK(reach[other] > width_m / 2);  // the head is thicker than the shaft
      CHECK(reach[other] < 2 * width_m);
    }
  }
}

TEST_CASE("x is red, y green and z blue, in the frame at the insertion point") {
  PeopleView view(kAxes);
  check_arrows(view.frame(), glm::dmat4(1), 2, 0.1);

  // A pose in front of the arrows moves them, and a pose inserted after them does not.
  PeopleView moved("<element type='pose' name='P' insert_at='ROOT' x='1e7' y='-2' roll='10' pitch='20' yaw='30'/>" +
                   std::string(kAxes) + "<element type='pose' name='Q' insert_at='ROOT' x='5'/>");
  check_arrows(moved.frame(), matrix_from_degrees({1e7, -2, 0}, 10, 20, 30), 2, 0.1);
  check_arrows(moved.frame_with("P", "yaw", 90), matrix_from_degrees({1e7, -2, 0}, 10, 20, 90), 2, 0.1);
}

TEST_CASE("each parameter of frame_axes") {
  PeopleView view(kAxes);
  check_arrows(view.frame_with("E", "length", 3), glm::dmat4(1), 3, 0.1);
  check_arrows(view.frame_with("E", "width", 0.25), glm::dmat4(1), 3, 0.25);
  CHECK(view.frame_with("E", "width", 0).meshes.at(0)->indices.empty());
  view.frame_with("E", "width", 0.1);
  CHECK(view.frame_with("E", "length", 0).meshes.at(0)->indices.empty());
  CHECK(view.people.update().materials.at(0)->unlit);
}

TEST_CASE("sensors see no arrows") {
  PeopleView view(kAxes), without("");
  CHECK(view.frame().items.size() == 1);
  CHECK(same_content(view.sensors.update(), without.sensors.update()));
}

TEST_CASE("mistakes in frame_axes") {
  const auto error = [](const std::string& attributes) {
    return error_of([&] { PeopleView view("<element type='frame_axes' name='E' " + attributes + "/>"); });
  };
  CHECK(contains(error("insert_at='ROOF'"), "s.xml:1:37: error: there is no insertion point \"ROOF\""));
  CHECK(contains(error("insert_at='ROOT' length='-1'"), "attribute \"length\": -1 is not allowed"));
  CHECK(contains(error("insert_at='ROOT' size='1'"), "unknown attribute \"size\""));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
