// Orientations: quaternions and look_at.
#include "simvis/look_at.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include <simvis/pose.h>
#include "scenegraph/flattener.h"
#include "simvis/live_scene.h"
#include "simvis/mount_frame.h"
#include "simvis/tracked_parts.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

// A dozen operations in double on coordinates of up to 10 m.
constexpr double kRounding_m = 1e-14;

BuiltScene build(const std::string& xml) { return build_scene(parse_commands(xml, "s.xml", "")); }
std::string refused(const std::string& xml) {
  return error_of([&] { build(xml); });
}
std::string scanner(const std::string& attributes) {
  return "<sensor type='laser_scanner' name='S' samples='1' " + attributes + "/>";
}

glm::dmat4 sensor_frame(const BuiltScene& built) {
  Flattener flattener(built.scene.root());
  flattener.update();
  glm::dmat4 mount, frame;
  REQUIRE(flattener.find_mount(*built.sensors.at(0).mount, mount));
  REQUIRE(rigid_mount_frame(mount, frame));
  return frame;
}

void check_looks(const std::string& xml, const glm::dvec3& from, const glm::dvec3& at) {
  CAPTURE(xml);
  const glm::dmat4 frame = sensor_frame(build(xml));
  const glm::dvec3 x(frame[0]), y(frame[1]), z(frame[2]);
  CHECK(glm::length(glm::dvec3(frame[3]) - from) < kRounding_m);
  CHECK(glm::length(x - glm::normalize(at - from)) < kRounding_m);
  CHECK(std::abs(y.z) < kRounding_m);  // the horizon is level
  CHECK(z.z > 0);
}

TEST_CASE("a sensor looks at a point of the frame in which it stands") {
  check_looks(scanner("insert_at='ROOT' pose_offset='1 2 3' look_at='4 -1 0'"), {1, 2, 3}, {4, -1, 0});
  check_looks(scanner("insert_at='ROOT' look_at='-1 0 0'"), {0, 0, 0}, {-1, 0, 0});
  const std::string frame = "<part name='F' insert_at='ROOT' pose_offset='5 0 1 20 0 90'/>";
  const glm::dmat4 world = matrix_from_degrees({5, 0, 1}, 20, 0, 90);
  check_looks(frame + scanner("insert_at='F' pose_offset='1 0 2' look_at='3 3 0'"), world * glm::dvec4(1, 0, 2, 1),
              world * glm::dvec4(3, 3, 0, 1));
}

TEST_CASE("a link is looked at and tracked by its path, too") {
  const TemporaryFolder folder;
  write_text(folder / "r.urdf",
             "<robot name='r'><link name='base'/><link name='hand'/><joint name='j' type='fixed'>"
             "<parent link='base'/><child link='hand'/><origin xyz='1 2 3'/></joint></robot>");
  for (const std::string at : {"hand", "R/hand"}) {
    CAPTURE(at);
    BuiltScene built = build_scene(parse_commands(
        "<part name='R' insert_at='ROOT' file='r.urdf'/>" + scanner("insert_at='ROOT' look_at='" + at + "'"), "s.xml",
        folder.path()));
    CHECK(glm::length(glm::dvec3(sensor_frame(built)[0]) - glm::normalize(glm::dvec3(1, 2, 3))) < kRounding_m);
    TrackedParts tracked;
    tracked.track(at, built.scene);
    Flattener flattener(built.scene.root());
    flattener.update();
    glm::dmat4 pose;
    REQUIRE(tracked.pose(at, flattener, pose));
    CHECK(glm::length(glm::dvec3(pose[3]) - glm::dvec3(1, 2, 3)) < kRounding_m);
  }
}

TEST_CASE("a sensor looks at a part as it stands when the command is executed") {
  check_looks(
      "<part name='T' insert_at='ROOT' pose_offset='3 0 0 0 0 0'/><element type='pose' name='P' insert_at='T' "
      "y='4'/>" +
          scanner("insert_at='ROOT' pose_offset='0 0 2' look_at='T'"),
      {0, 0, 2}, {3, 4, 0});
  check_looks(
      "<part name='T' insert_at='ROOT' pose_offset='3 1 1 0 0 0'/>" + scanner("insert_at='T' pose_offset='2 0 0' "
                                                                              "look_at='ROOT'"),
      {5, 1, 1}, {0, 0, 0});
}

TEST_CASE("scale and mirroring do not change where a sensor looks") {
  const std::string xml = scanner("insert_at='ROOT' pose_offset='1 1 0' look_at='3 2 0.5'");
  const BuiltScene built = build(xml);
  CHECK(glm::determinant(glm::dmat3(sensor_frame(built))) == doctest::Approx(1).epsilon(1e-14));
}

TEST_CASE("mistakes in look_at") {
  CHECK(contains(refused(scanner("insert_at='ROOT' look_at='0 0 0'")), "is where the sensor stands"));
  CHECK(contains(refused(scanner("insert_at='ROOT' look_at='ROOT'")), "is where the sensor stands"));
  CHECK(contains(refused(scanner("insert_at='ROOT' look_at='0 0 5'")), "straight above or below the sensor"));
  CHECK(contains(refused(scanner("insert_at='ROOT' look_at='1e300 1e300 0'")), "is where the sensor stands"));
  CHECK(contains(refused(scanner("insert_at='ROOT' look_at='ROTO'")),
                 "s.xml:1:68: error: attribute \"look_at\": there is no part or link \"ROTO\", did you mean \"ROOT\"?, "
                 "expected"));
  CHECK(contains(refused(scanner("insert_at='ROOT' look_at='1 0 0' pose_offset='0 0 0 0 0 0'")),
                 "three finite numbers x y z (m), since \"look_at\" gives the orientation"));
  CHECK(contains(refused(scanner("insert_at='ROOT' look_at='1 0 0' quaternion='1 0 0 0'")), "expected one of them"));
  CHECK(contains(refused("<part name='A' insert_at='ROOT' look_at='1 0 0'/>"), "unknown attribute \"look_at\""));
}

TEST_CASE("a quaternion is the orientation of a part or a sensor") {
  const double c = std::cos(0.3), s = std::sin(0.3);  // 0.6 rad about z
  const auto text = [](double value) { return format_number(value); };
  const glm::dmat4 part =
      build("<part name='A' insert_at='ROOT' pose_offset='1 2 3' quaternion='" + text(c) + " 0 0 " + text(s) + "'/>")
          .scene.world_from_point("A")
          .value();
  CHECK(part[3] == glm::dvec4(1, 2, 3, 1));
  CHECK(glm::length(part[0] - glm::dvec4(std::cos(0.6), std::sin(0.6), 0, 0)) < kRounding_m);
  // A quarter turn about y, written with three decimals: forward points down, and the frame is rigid.
  const glm::dmat4 sensor = sensor_frame(build(scanner("insert_at='ROOT' quaternion='0.707 0 0.707 0'")));
  CHECK(glm::length(sensor[0] - glm::dvec4(0, 0, -1, 0)) < kRounding_m);
  CHECK(glm::length(sensor[0]) == doctest::Approx(1).epsilon(1e-14));
}

TEST_CASE("mistakes in quaternions") {
  const auto wrong = [](const std::string& quaternion) {
    return refused("<part name='A' insert_at='ROOT' quaternion='" + quaternion + "'/>");
  };
  CHECK(contains(wrong("1 1 0 0"),
                 "s.xml:1:33: error: attribute \"quaternion\": \"1 1 0 0\" is not allowed, expected w x "
                 "y z of length 1 within 0.001, and this has length 1.414"));
  CHECK(contains(wrong("1.002 0 0 0"), "length 1.002"));
  CHECK(wrong("1.0009 0 0 0") == "nothing was thrown");
  for (const char* text : {"", "0 0 0 0", "1 0 0", "1 0 0 0 0", "1 0 0 nan", "0 0 0 1e300"}) {
    CAPTURE(text);
    CHECK(contains(wrong(text), "s.xml:1:33: error: attribute \"quaternion\""));
  }
  CHECK(contains(refused("<part name='A' insert_at='ROOT' quaternion='1 0 0 0' pose_offset='1 2 3 0 0 0'/>"),
                 "three finite numbers x y z (m), since \"quaternion\" gives the orientation"));
}

}  // namespace
}  // namespace simvis
