// The place of a mount without its scale, shear and mirroring.
#include "simvis/mount_frame.h"

#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <initializer_list>
#include <limits>

#include <simvis/pose.h>

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

// A few roundings of 2^-53 each on numbers of size 1 (directions) or 10 (positions).
constexpr double kRounding = 1e-14;

double largest_difference(const glm::dmat4& a, const glm::dmat4& b) {
  double largest = 0;
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) largest = std::max(largest, std::abs(a[c][r] - b[c][r]));
  }
  return largest;
}

const glm::dmat4 kMountPose = to_matrix({.position_m = {1, -2, 3}, .roll_rad = 0.3, .pitch_rad = -0.7, .yaw_rad = 2});

TEST_CASE("a rigid frame stays unchanged, and scale is removed") {
  glm::dmat4 frame;
  REQUIRE(rigid_mount_frame(kMountPose, frame));
  CHECK(largest_difference(frame, kMountPose) < kRounding);
  for (const glm::dvec3 scale : {glm::dvec3(3), glm::dvec3(1e-200, 1e200, 5), glm::dvec3(0.1, 0, 7)}) {
    REQUIRE(rigid_mount_frame(glm::scale(kMountPose, scale), frame));
    CHECK(largest_difference(frame, kMountPose) < kRounding);
  }
}

TEST_CASE("shear keeps the direction of x") {
  glm::dmat4 sheared = kMountPose;
  sheared[2] += 0.8 * sheared[0];  // z leans forward
  sheared[1] += 0.5 * sheared[0];
  glm::dmat4 frame;
  REQUIRE(rigid_mount_frame(sheared, frame));
  CHECK(largest_difference(frame, kMountPose) < kRounding);
}

TEST_CASE("a mirrored mount keeps its forward and up directions, right-handed") {
  const glm::dmat4 mirrored = glm::scale(kMountPose, glm::dvec3(1, -1, 1));
  glm::dmat4 frame;
  REQUIRE(rigid_mount_frame(mirrored, frame));
  CHECK(largest_difference(frame, kMountPose) < kRounding);

  const glm::dmat4 turned = glm::scale(glm::dmat4(1), glm::dvec3(-1, -1, -1));
  REQUIRE(rigid_mount_frame(turned, frame));
  CHECK(glm::dvec3(frame[0]) == glm::dvec3(-1, 0, 0));
  CHECK(glm::dvec3(frame[1]) == glm::dvec3(0, 1, 0));
  CHECK(glm::dvec3(frame[2]) == glm::dvec3(0, 0, -1));
  CHECK(glm::determinant(frame) == doctest::Approx(1));
}

TEST_CASE("a mount without a direction is refused") {
  glm::dmat4 frame;
  CHECK_FALSE(rigid_mount_frame(glm::scale(kMountPose, glm::dvec3(0, 1, 1)), frame));
  CHECK_FALSE(rigid_mount_frame(glm::scale(kMountPose, glm::dvec3(1, 1, 0)), frame));
  glm::dmat4 flat = kMountPose;
  flat[2] = flat[0];
  CHECK_FALSE(rigid_mount_frame(flat, frame));
  glm::dmat4 infinite = kMountPose;
  infinite[3][1] = std::numeric_limits<double>::infinity();
  CHECK_FALSE(rigid_mount_frame(infinite, frame));
  infinite = kMountPose;
  infinite[0][0] = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(rigid_mount_frame(infinite, frame));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
