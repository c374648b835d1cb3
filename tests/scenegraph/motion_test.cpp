// Motion from differences of poses: constant screws, free fall, frames made again, things that appear.
#include "scenegraph/motion.h"

#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>

#include <simvis/node.h>
#include <simvis/pose.h>
#include "scenegraph/flattener.h"
#include "scenegraph/motion_path.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

constexpr double kU = 0x1p-53;
constexpr std::int64_t kStep_ns = 10'000'000;
constexpr double kStep_s = 0.01;

// A pose within `reach_m` of the origin, computed with some 30 roundings of sines, cosines and products. A velocity is
// the difference of two of them over a step, an acceleration the difference of two velocities over another one.
double velocity_tolerance(double reach_m) { return 2 * 30 * kU * reach_m / kStep_s; }
double acceleration_tolerance(double reach_m) { return 2 * velocity_tolerance(reach_m) / kStep_s; }

/// A body that screws about the z axis through `centre`: turns with `turn` rad/s and rises with `rise` m/s, and whose
/// own axes are tilted.
glm::dmat4 screw_pose(double seconds, const glm::dvec3& centre, double turn, double rise) {
  const glm::dmat4 start = matrix_from_degrees({1.5, 0, 0}, 20, -35, 50);
  glm::dmat4 pose = glm::translate(glm::dmat4(1), centre + glm::dvec3(0, 0, rise * seconds));
  return glm::rotate(pose, turn * seconds, {0, 0, 1}) * start;
}

double error(const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b); }

TEST_CASE("the motion of a constant screw is exact from the third frame on") {
  for (const double turn : {0.0, 1e-6, 0.7, -3.0, 40.0, 300.0}) {  // up to 172 degrees in a step
    for (const double reach : {2.0, 1000.0}) {
      CAPTURE(turn);
      CAPTURE(reach);
      const glm::dvec3 centre(reach, -reach / 3, 0);
      PoseHistory history;
      for (int frame = 0; frame < 5; ++frame) {
        const glm::dmat4 pose = screw_pose(frame * kStep_s, centre, turn, 0.25);
        history.add(frame * kStep_ns, pose);
        const Motion motion = history.motion();
        if (frame == 0) {
          CHECK(motion.velocity_mps == glm::dvec3(0));
          CHECK(motion.acceleration_mps2 == glm::dvec3(0));
          CHECK(motion.angular_velocity_radps == glm::dvec3(0));
          continue;
        }
        const glm::dvec3 arm = glm::dvec3(pose[3]) - centre, axis(0, 0, turn);
        const glm::dvec3 flat(arm.x, arm.y, 0);
        const double angular = 1 + std::abs(turn);  // the angle is multiplied by the arm and by itself
        CHECK(error(motion.angular_velocity_radps, axis) <= velocity_tolerance(1) * angular);
        CHECK(error(motion.velocity_mps, glm::cross(axis, arm) + glm::dvec3(0, 0, 0.25)) <=
              velocity_tolerance(reach + 2) * angular);
        CHECK(error(motion.acceleration_mps2, -turn * turn * flat) <=
              acceleration_tolerance(reach + 2) * angular * angular);
        CHECK(error(motion.angular_acceleration_radps2, glm::dvec3(0)) <= acceleration_tolerance(1) * angular);
      }
    }
  }
}

TEST_CASE("a pose between two poses lies on their screw, and what is fixed to a body stays fixed to it") {
  const glm::dmat4 fixed = matrix_from_degrees({0.7, -0.2, 0.4}, -15, 60, 100);
  for (const double turn : {0.0, 1e-6, 0.7, -3.0, 40.0, 300.0}) {  // up to 172 degrees from one to the other
    for (const double reach : {2.0, 1000.0}) {
      CAPTURE(turn);
      CAPTURE(reach);
      const auto body = [&](double share) { return screw_pose(share * kStep_s, {reach, -reach / 3, 0}, turn, 25); };
      // 30 roundings of each of the three poses, and of the angle, which counts once for each share of the way.
      const double angle = 1 + std::abs(turn) * kStep_s, tolerance_m = 3 * 30 * kU * (reach + 2) * angle;
      for (const double share : {0.0, 0.25, 0.6, 1.0, -0.5, 1.5}) {
        CAPTURE(share);
        const glm::dmat4 pose = pose_between(body(0), body(1), share);
        const glm::dmat4 of_fixed = pose_between(body(0) * fixed, body(1) * fixed, share);
        const glm::dmat4 placed = place_at(path_between(body(0) * fixed, body(1) * fixed), share - 1, body(1) * fixed);
        for (int i = 0; i < 4; ++i) {
          CHECK(glm::length(pose[i] - body(share)[i]) <= tolerance_m);
          CHECK(glm::length(of_fixed[i] - (body(share) * fixed)[i]) <= tolerance_m);
          CHECK(placed[i] == of_fixed[i]);
        }
      }
      CHECK(pose_between(body(0), body(1), 1) == body(1));
    }
  }
}

TEST_CASE("shares before the first piece multiply its screws by as many of its lengths") {
  // The first piece lasts a quarter of the time. One metre along x in it, none in the second.
  MotionPath path;
  path.pieces = {{.begin = -1, .end = -0.75, .joints = {{.way_m = {1, 0, 0}}}}, {.begin = -0.75, .end = 0}};
  for (const double share : {-1.0, -2.0, -3.0}) {
    CAPTURE(share);
    const double lengths = (-0.75 - share) / 0.25;
    CHECK(extrapolation(path, share) == lengths);  // quarters are exact
    CHECK(displacement(path, share, {0, 0, 0}).way_m == glm::dvec3(-lengths, 0, 0));
  }
  CHECK(extrapolation(path, -0.5) == 1);  // what lies between two measurements is no multiple of them
  CHECK(extrapolation(MotionPath{}, -3) == 1);
}

TEST_CASE("lengths that round grow with the distance to which an extrapolated piece moves a point") {
  // A slide along x, then a turn about z through the origin. The errors of the turn count at the end of the slide.
  constexpr double kTurn_rad = 1e-2, kTurnError_rad = 0x1p-40;  // far above the rounding of the path
  const glm::dvec3 point_m(0, 2, 0);
  for (const double piece : {0.5, 0.125, 0x1p-7, 0x1p-10}) {
    for (const double share : {-1.0, -2.0, -3.0}) {
      CAPTURE(piece);
      CAPTURE(share);
      const auto path = [&](double turn_rad) {
        MotionPath made;
        made.pieces = {
            {.begin = -1, .end = piece - 1, .joints = {{.way_m = {1, 0, 0}}, {.turn_rad = {0, 0, turn_rad}}}},
            {.begin = piece - 1, .end = 0}};
        return made;
      };
      const double parts = extrapolation(path(kTurn_rad), share);
      CHECK(parts == (piece - 1 - share) / piece);  // powers of two are exact
      const double arm_m = std::hypot(parts, 2);
      const double moved_m = error(displacement(path(kTurn_rad + kTurnError_rad), share, point_m).way_m,
                                   displacement(path(kTurn_rad), share, point_m).way_m);
      CHECK(moved_m == doctest::Approx(parts * kTurnError_rad * arm_m).epsilon(1e-2));
      const double bound_m = rounded_length_m(path(kTurn_rad), point_m, parts);
      CHECK(moved_m <= parts * kTurnError_rad * bound_m);
      CHECK(bound_m <= 4 * (arm_m + 2));  // two distances and a way
    }
  }
}

TEST_CASE("free fall: the acceleration is exact, the velocity is the mean of the last step") {
  const glm::dvec3 gravity(0, 0, -9.80665);
  PoseHistory history;
  for (int frame = 0; frame < 20; ++frame) {
    const double t = frame * kStep_s;
    history.add(frame * kStep_ns, glm::translate(glm::dmat4(1), glm::dvec3(3, 2, 5) + 0.5 * t * t * gravity));
  }
  const double middle_s = 19 * kStep_s - kStep_s / 2;
  CHECK(error(history.motion().velocity_mps, middle_s * gravity) <= velocity_tolerance(8));
  CHECK(error(history.motion().acceleration_mps2, gravity) <= acceleration_tolerance(8));
}

TEST_CASE("a frame that is made again replaces its pose, and a cleared history begins again") {
  const auto at = [](double x) { return glm::translate(glm::dmat4(1), {x, 0, 0}); };
  PoseHistory history;
  history.add(0, at(0));
  history.add(kStep_ns, at(5));
  history.add(kStep_ns, at(1));
  CHECK(history.motion().velocity_mps.x == doctest::Approx(100).epsilon(1e-12));
  history.clear();
  history.add(2 * kStep_ns, at(7));
  CHECK(history.motion().velocity_mps == glm::dvec3(0));
}

std::shared_ptr<Shape> small_shape() {
  auto mesh = std::make_shared<Mesh>();
  mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh->attributes.resize(3);
  mesh->indices = {0, 1, 2};
  compute_bounds(*mesh);
  return std::make_shared<Shape>(mesh);
}

TEST_CASE("the flattener says what stands at a watched insertion point") {
  const auto root = std::make_shared<Group>();
  const auto part = std::make_shared<Separator>(), inner = std::make_shared<Separator>();
  const auto point = std::make_shared<InsertionPoint>(), hidden = std::make_shared<InsertionPoint>();
  const auto off = std::make_shared<Switch>();
  root->add(small_shape());
  part->add(std::make_shared<Transform>(glm::translate(glm::dmat4(1), {1, 2, 3})));
  inner->add(small_shape());
  part->add(inner);
  part->add(point);
  part->add(small_shape());
  root->add(part);
  off->add(hidden);
  off->set_which(Switch::kNone);
  root->add(off);
  root->add(small_shape());
  Flattener flattener(root);
  flattener.update();
  CHECK(flattener.find_point(*point) == nullptr);
  flattener.watch({point.get(), hidden.get()});
  const DrawList& list = flattener.update();
  const Flattener::PointPlace* const place = flattener.find_point(*point);
  REQUIRE(place != nullptr);
  CHECK(place->first_item == 1);
  CHECK(place->end_item == 3);
  CHECK(list.world_from_node[place->transform][3] == glm::dvec4(1, 2, 3, 1));
  CHECK(flattener.find_point(*hidden) == nullptr);
  const std::uint64_t rebuilds = flattener.counters().rebuilds;
  flattener.watch({point.get(), hidden.get()});
  flattener.update();
  CHECK(flattener.counters().rebuilds == rebuilds);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
