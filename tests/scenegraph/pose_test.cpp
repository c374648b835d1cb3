// Poses: rotations computed by hand, exact quarter turns, huge angles.
#include <simvis/pose.h>

#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scenegraph/language/pose_attribute.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

// A matrix element is a sum of at most two products of sines and cosines, each with an error of about one ulp: 8
// half-ulps of 1.
constexpr double kRounding = 8 * 1.2e-16;

double difference(const glm::dmat4& a, const glm::dmat4& b) {
  double largest = 0;
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) largest = std::max(largest, std::abs(a[c][r] - b[c][r]));
  }
  return largest;
}

glm::dvec3 turned(const glm::dvec3& v, double roll, double pitch, double yaw) {
  return glm::dmat3(matrix_from_degrees({}, roll, pitch, yaw)) * v;
}

TEST_CASE("quarter turns are exact and have the right direction") {
  const glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  CHECK(turned(x, 0, 0, 90) == y);
  CHECK(turned(y, 0, 0, 90) == -x);
  CHECK(turned(x, 0, 90, 0) == -z);
  CHECK(turned(z, 0, 90, 0) == x);
  CHECK(turned(x, 0, -90, 0) == z);
  CHECK(turned(y, 90, 0, 0) == z);
  CHECK(turned(z, 90, 0, 0) == -y);
  CHECK(turned(x, 0, 0, 180) == -x);
  // Roll comes first, yaw last: y rolls up to z, which yaw does not turn.
  CHECK(turned(y, 90, 0, 90) == z);
  CHECK(turned(y, 90, 90, 0) == x);
}

TEST_CASE("other angles equal the product of single rotations") {
  const double roll = 17, pitch = -40, yaw = 115, rad = glm::pi<double>() / 180;
  const auto c = [&](double d) { return std::cos(d * rad); };
  const auto s = [&](double d) { return std::sin(d * rad); };
  const glm::dmat4 rx{{1, 0, 0, 0}, {0, c(roll), s(roll), 0}, {0, -s(roll), c(roll), 0}, {0, 0, 0, 1}};
  const glm::dmat4 ry{{c(pitch), 0, -s(pitch), 0}, {0, 1, 0, 0}, {s(pitch), 0, c(pitch), 0}, {0, 0, 0, 1}};
  const glm::dmat4 rz{{c(yaw), s(yaw), 0, 0}, {-s(yaw), c(yaw), 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  glm::dmat4 expected = rz * ry * rx;
  expected[3] = {1, 2, 3, 1};
  CHECK(difference(matrix_from_degrees({1, 2, 3}, roll, pitch, yaw), expected) < kRounding);
  const Pose pose{.position_m = {1, 2, 3}, .roll_rad = roll * rad, .pitch_rad = pitch * rad, .yaw_rad = yaw * rad};
  CHECK(difference(to_matrix(pose), expected) < kRounding);
  CHECK(difference(rigid_inverse(expected) * expected, glm::dmat4(1)) < 4 * kRounding);
}

TEST_CASE("huge angles equal their remainder") {
  // 1e9 = 2777777 * 360 + 280
  CHECK(matrix_from_degrees({}, 0, 0, 1e9) == matrix_from_degrees({}, 0, 0, 280));
  CHECK(matrix_from_degrees({}, 0, 0, -1e9) == matrix_from_degrees({}, 0, 0, -280));
  CHECK(sincos_deg(360.0 * 1e12 + 90).sin == 1);
  CHECK(std::isfinite(sincos_deg(1e300).sin));
}

TEST_CASE("sine and cosine equal those of the library, and are exact at quarter turns") {
  for (int degrees = -720; degrees <= 720; ++degrees) {
    CAPTURE(degrees);
    const auto [sin, cos] = sincos_deg(degrees);
    const double reduced = std::remainder(degrees, 360) * (glm::pi<double>() / 180);
    // The argument of the library has an error of half an ulp of pi.
    CHECK(std::abs(sin - std::sin(reduced)) < 5e-16);
    CHECK(std::abs(cos - std::cos(reduced)) < 5e-16);
    if (degrees % 90 == 0) {
      CHECK(sin == std::round(sin));
      CHECK(cos == std::round(cos));
      CHECK_FALSE(((sin == 0 && std::signbit(sin)) || (cos == 0 && std::signbit(cos))));
    }
  }
}

TEST_CASE("the view of a sensor: right, down, forward") {
  const glm::dmat3 m(sensor_from_view());
  CHECK(m * glm::dvec3(1, 0, 0) == glm::dvec3(0, -1, 0));
  CHECK(m * glm::dvec3(0, 1, 0) == glm::dvec3(0, 0, -1));
  CHECK(m * glm::dvec3(0, 0, 1) == glm::dvec3(1, 0, 0));
  CHECK(glm::determinant(m) == 1);
}

TEST_CASE("the attribute pose_offset") {
  const auto offset = [](const std::string& attribute) {
    return pose_offset(parse_commands("<sensor " + attribute + "/>", "s.xml", "").at(0));
  };
  CHECK_FALSE(offset("").has_value());
  CHECK(offset("pose_offset=' 1 2\n3  0 0 90 '") == matrix_from_degrees({1, 2, 3}, 0, 0, 90));
  for (const char* text : {"", "1 2 3", "1 2 3 4 5 6 7", "1 2 3 4 5 nan", "1 2 3 4 5 inf", "1,2,3,4,5,6"}) {
    CAPTURE(text);
    CHECK(contains(error_of([&] { offset("pose_offset='" + std::string(text) + "'"); }),
                   "s.xml:1:9: error: attribute \"pose_offset\": \"" + std::string(text) +
                       "\" is not allowed, expected six finite numbers: x y z (m) roll pitch yaw (deg)"));
  }
  CHECK(
      contains(error_of([&] { offset("pose_offset='1e300 0 0 0 0 0'"); }), "expected x y z from -1e+15 to 1e+15 (m)"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
