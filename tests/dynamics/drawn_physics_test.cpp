// What people see of physics: bodies, links and joints, ellipsoids of inertia, contacts.
#include <doctest/doctest.h>

#include <cmath>

#include "elements/sensed_physics.h"
#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// The solver stops at a remainder: forces at rest differ by this share, as in force_sensors_test.cpp.
constexpr double kSolverShare = 1e-3;
// Vertices of meshes are float32: half of their last digit, as a share. Shapes and masses follow from the vertices.
constexpr double kVertexRounding = 0x1p-24;
// Rounding of a chain of a dozen operations in double, as a share.
constexpr double kPoseRounding = 1e-12;

TEST_CASE("a box on the floor: its solid ellipsoid, its shape, and contacts that carry it") {
  MovingScene scene(kPhysics + ground() +
                    body("BOX", "shape='box' size='0.2 0.4 0.6' pose_offset='1 2 0.3 0 0 90'", "mass='3' shape='box'"));
  scene.run(0, 1, 0.1);
  const auto physics = find_physics((*scene).scene);
  const std::vector<DrawnBody> bodies = physics->drawn_bodies();
  const DrawnPhysics state = physics->drawn_state();
  REQUIRE(bodies.size() == 2);
  REQUIRE(state.world_from_body.size() == 2);
  CHECK(bodies[0].motion == DrawnBody::Motion::fixed);
  CHECK(bodies[0].mass_kg == 0);
  const DrawnBody& box = bodies[1];
  CHECK(box.motion == DrawnBody::Motion::dynamic);
  CHECK(box.element == "BOX_BODY");
  CHECK(box.name == "BOX");
  CHECK(box.mass_kg == 3);
  CHECK_FALSE(box.joint);
  REQUIRE(box.shapes.size() == 1);
  CHECK(box.shapes[0].kind == DrawnShape::Kind::box);
  CHECK(glm::length(box.shapes[0].half_m - glm::dvec3(0.1, 0.2, 0.3)) <
        kVertexRounding * glm::length(glm::dvec3(0.1, 0.2, 0.3)) + kPoseRounding);
  // m / 12 (b^2 + c^2) of a box with these edges is m / 5 (y^2 + z^2) of an ellipsoid with x = a / 2 sqrt(5 / 3).
  const glm::dmat3 spread = box.axes * glm::dmat3(box.half_m.x, 0, 0, 0, box.half_m.y, 0, 0, 0, box.half_m.z);
  for (int i = 0; i < 3; ++i) {
    const double along_m = glm::length(glm::transpose(spread)[i]);
    const double expected_m = 0.1 * (i + 1) * std::sqrt(5.0 / 3);
    CHECK(std::abs(along_m - expected_m) < (kVertexRounding + kPoseRounding) * expected_m);
  }
  CHECK(glm::length(glm::dvec3(state.world_from_body[1][3]) - scene.position("BOX")) < kPoseRounding);
  double force_n = 0;
  for (const DrawnContact& each : state.contacts) {
    force_n += each.contact.force_n;
    REQUIRE(each.a);
    REQUIRE(each.b);
    CHECK(*each.a + *each.b == 1);
    CHECK(std::abs(each.contact.normal.z - (*each.a == 1 ? 1 : -1)) < kSolverShare);
  }
  CHECK(std::abs(force_n - 3 * kGravity_m_s2) < kSolverShare * 3 * kGravity_m_s2);
}

TEST_CASE("a vehicle is its body and its wheels, each with its joint and its place") {
  MovingScene scene(kPhysics + ground() +
                    "<part name='CAR' insert_at='ROOT' shape='box' size='0.4 0.2 0.1' pose_offset='0 0 0 0 0 0'/>"
                    "<element type='vehicle' name='DRIVE' insert_at='CAR' mass='10' wheel_radius='0.1' track='0.4'/>");
  const std::vector<DrawnBody> bodies = find_physics((*scene).scene)->drawn_bodies();
  const DrawnPhysics state = find_physics((*scene).scene)->drawn_state();
  REQUIRE(bodies.size() == 5);  // floor, body, two wheels, caster
  REQUIRE(state.world_from_body.size() == 5);
  REQUIRE(bodies[2].joint);
  CHECK(bodies[2].joint->kind == DrawnJoint::Kind::revolute);
  CHECK(bodies[2].joint->axis == glm::dvec3(0, 1, 0));
  REQUIRE(bodies[4].joint);
  CHECK(bodies[4].joint->kind == DrawnJoint::Kind::fixed);
  const double track_m = glm::length(glm::dvec3(state.world_from_body[2][3] - state.world_from_body[3][3]));
  CHECK(std::abs(track_m - 0.4) < kPoseRounding);
}

TEST_CASE("before the first step there is nothing to draw") {
  BuiltScene built = build_scene(parse_commands(kPhysics + ground(), "s.xml", ""));
  CHECK(find_physics(built.scene)->drawn_bodies().empty());
  CHECK(find_physics(built.scene)->drawn_state().world_from_body.empty());
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
