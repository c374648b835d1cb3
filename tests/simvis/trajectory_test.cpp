// Trajectory files: values between rows, and where each mistake is reported.
#include <simvis/trajectory.h>

#include <doctest/doctest.h>

#include <cmath>
#include <glm/glm.hpp>

#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

struct TrajectoryStage {
  TrajectoryStage() {
    const AttributeSpec x{.name = "x", .default_value = "0", .unit = "m", .live = true};
    const AttributeSpec h{.name = "h", .default_value = "0", .unit = "m", .min = 0, .max = 3, .live = true};
    const double values[] = {0, 0};
    parameters.add_element({.name = "P", .type = "t", .insertion_point = "ROOT", .parameters = {x, h}}, values);
  }
  Trajectory read(std::string_view text) const {
    write_text(folder / "t.csv", text);
    return Trajectory(folder / "t.csv", parameters);
  }
  // The message, with the folder's name left out.
  std::string error(std::string_view text) const {
    const std::string message = error_of([&] { read(text); });
    const std::string prefix = folder.path().string() + "/";
    return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
  }
  TemporaryFolder folder;
  Parameters parameters;
};

TEST_CASE("values are linear between rows, and constant before the first and after the last") {
  TrajectoryStage stage;
  for (const char* text :
       {"time_s,P.h,P.x\n1,0,10\n3,2,20\n4,3,-4\n", "\xef\xbb\xbftime_s, P.h ,P.x\r\n1,0,10\r\n3 ,2, 20\r\n4,3,-4",
        "time_s,P.h,P.x\r1,0,10\r3,2,20\r4,3,-4\r\r"}) {
    const Trajectory trajectory = stage.read(text);
    const auto at = [&](double time_s) {
      trajectory.apply(time_s, stage.parameters);
      return std::vector<double>(stage.parameters.values().begin(), stage.parameters.values().end());
    };
    CHECK(at(-5) == std::vector<double>{10, 0});
    CHECK(at(1) == std::vector<double>{10, 0});
    CHECK(at(1.5) == std::vector<double>{12.5, 0.5});
    CHECK(at(3) == std::vector<double>{20, 2});
    CHECK(at(3.5) == std::vector<double>{8, 2.5});
    CHECK(at(4) == std::vector<double>{-4, 3});
    CHECK(at(1e9) == std::vector<double>{-4, 3});
  }
}

TEST_CASE("a single row is valid at all times") {
  TrajectoryStage stage;
  const Trajectory trajectory = stage.read("time_s,P.x\n2,5\n");
  for (const double time_s : {0.0, 2.0, 3.0}) {
    trajectory.apply(time_s, stage.parameters);
    CHECK(stage.parameters.values()[0] == 5);
  }
}

TEST_CASE("blank lines and comments are skipped") {
  TrajectoryStage stage;
  const Trajectory trajectory =
      stage.read("# a drive\n\n  \ntime_s,P.x\n0,1\n\n # half, way, there\n\t\n2,3\r\n\r\n#\n");
  trajectory.apply(1, stage.parameters);
  CHECK(stage.parameters.values()[0] == 2);
  CHECK(trajectory.end_s() == 2);
}

TEST_CASE("angles of full turns take the short way, others do not") {
  TrajectoryStage stage;
  const AttributeSpec turn{.name = "turn", .default_value = "0", .unit = "deg", .live = true, .full_turn = true};
  const AttributeSpec joint{.name = "joint", .default_value = "0", .unit = "deg", .live = true};
  stage.parameters.add_element({.name = "A", .type = "t", .insertion_point = "ROOT", .parameters = {turn, joint}},
                               std::vector<double>{0, 0});
  const Trajectory trajectory =
      stage.read("time_s,A.turn,A.joint\n0,350,350\n1,10,10\n2,170,170\n3,-170,-170\n4,-30,-30\n");
  const auto at = [&](double time_s) {
    trajectory.apply(time_s, stage.parameters);
    return std::vector<double>(stage.parameters.values().begin() + 2, stage.parameters.values().end());
  };
  CHECK(at(0) == std::vector<double>{350, 350});
  CHECK(at(0.5) == std::vector<double>{360, 180});
  CHECK(at(1) == std::vector<double>{10, 10});
  CHECK(at(1.5) == std::vector<double>{90, 90});
  CHECK(at(2.5) == std::vector<double>{180, 0});
  CHECK(at(3.5) == std::vector<double>{-100, -100});
  CHECK(at(4) == std::vector<double>{-30, -30});
  CHECK(trajectory.warnings().empty());

  const Trajectory whirl = stage.read("time_s,A.turn,A.joint\n0,0,0\n1,360,720\n2,-30,0\n");
  REQUIRE(whirl.warnings().size() == 1);
  CHECK(contains(whirl.warnings()[0], "t.csv:3:3: A.turn changes by 360 deg from row to row"));
}

// Products of a few factors of at most 1, and an arc tangent, in double.
constexpr double kAngleTolerance_deg = 1e-12;

struct PoseStage : TrajectoryStage {
  PoseStage() {
    std::vector<AttributeSpec> specs;
    for (const char* name : {"roll", "pitch", "yaw"}) {
      specs.push_back({.name = name, .default_value = "0", .unit = "deg", .live = true, .full_turn = true});
    }
    parameters.add_element({.name = "R", .type = "pose", .insertion_point = "ROOT", .parameters = specs},
                           std::vector<double>{0, 0, 0});
  }
  void check(const Trajectory& trajectory, double time_s, double roll, double pitch, double yaw) {
    trajectory.apply(time_s, parameters);
    const double expected[] = {roll, pitch, yaw};
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(std::abs(parameters.values()[i + 2] - expected[i]) <= kAngleTolerance_deg);
    }
  }
};

// cos(45 degrees), cos(22.5 degrees) and sin(22.5 degrees): half angles of turns by 90 and 45 degrees.
TEST_CASE("an orientation as quaternion turns about one axis, the short way") {
  PoseStage stage;
  const std::string head = "time_s,R.qw,P.x,R.qx,R.qy,R.qz\n";
  const Trajectory yaw = stage.read(head + "0,1,0,0,0,0\n1,0.7071067811865476,2,0,0,0.7071067811865476\n");
  stage.check(yaw, 0, 0, 0, 0);
  stage.check(yaw, 0.5, 0, 0, 45);
  CHECK(stage.parameters.values()[0] == 1);
  stage.check(yaw, 2, 0, 0, 90);
  CHECK(yaw.parameters().size() == 4);
  // The negative quaternion is the same orientation, so the way is the same.
  const Trajectory other = stage.read(head + "0,1,0,0,0,0\n1,-0.7071067811865476,2,0,0,-0.7071067811865476\n");
  stage.check(other, 0.5, 0, 0, 45);
  // From a turn about x to one about y: half way lies the mean, scaled to length 1.
  const Trajectory tilt = stage.read(head +
                                     "0,0.7071067811865476,0,0.7071067811865476,0,0\n"
                                     "1,0.7071067811865476,0,0,0.7071067811865476,0\n");
  stage.check(tilt, 0, 90, 0, 0);
  // q = (w, x, y, z) = (2, 1, 1, 0) / sqrt(6), and roll, pitch, yaw of its matrix.
  stage.check(tilt, 0.5, glm::degrees(std::atan2(2.0, 1.0)), glm::degrees(std::asin(2.0 / 3)),
              glm::degrees(std::atan2(1.0, 2.0)));
  // Three decimals.
  stage.check(stage.read("time_s,R.qx,R.qy,R.qz,R.qw\n0,0,0,0.707,0.707\n"), 0, 0, 0, 90);
}

TEST_CASE("an orientation turns the element that has the name now") {
  struct Replaced : PoseStage {
    Replaced() {
      const ElementDescriptor removed = parameters.elements().back();
      parameters.mark_removed(1, true);
      parameters.add_element({.name = "R", .type = "pose", .insertion_point = "ROOT", .parameters = removed.parameters},
                             std::vector<double>{0, 0, 0});
    }
  };
  Replaced stage;
  stage.read("time_s,R.qx,R.qy,R.qz,R.qw\n0,0,0,0.707,0.707\n").apply(0, stage.parameters);
  CHECK(std::abs(stage.parameters.values()[stage.parameters.index("R", "yaw")] - 90) <= kAngleTolerance_deg);
}

TEST_CASE("errors of quaternion columns") {
  const PoseStage stage;
  CHECK(stage.error("time_s,R.qx,R.qy,R.qw\n0,0,0,1\n") ==
        "t.csv:1:8: error: column \"R.qx\", expected all of qx, qy, qz and qw");
  CHECK(stage.error("time_s,R.yaw,R.qx,R.qy,R.qz,R.qw\n0,0,0,0,0,1\n") ==
        "t.csv:1:14: error: column \"R.qx\": column \"R.yaw\" gives the orientation too, expected angles or a "
        "quaternion");
  CHECK(contains(stage.error("time_s,R.qx,R.qx\n0,0,0\n"), "\"R.qx\" is given twice"));
  CHECK(stage.error("time_s,R.qx,R.qy,R.qz,R.qw\n0,0,0,0,1\n1,0,0,0,0.5\n") ==
        "t.csv:3:3: error: the quaternion has length 0.5, expected 1");
  CHECK(contains(stage.error("time_s,P.qx\n0,0\n"), "element \"P\" has no parameter \"qx\""));
}

TEST_CASE("errors are reported at their place") {
  const TrajectoryStage stage;
  CHECK(stage.error("") == "t.csv:1:1: error: no header, expected \"time_s,ELEMENT.PARAM,...\"");
  CHECK(contains(stage.error("time_s,P.x\n"), "error: no rows, expected at least one"));
  CHECK(stage.error("time,P.x\n0,1") == "t.csv:1:1: error: column \"time\", expected \"time_s\" first");
  CHECK(stage.error("time_s,Px\n0,1") == "t.csv:1:8: error: column \"Px\", expected ELEMENT.PARAM");
  CHECK(stage.error("time_s,P.x,P.hh\n0,1,1") ==
        "t.csv:1:12: error: column \"P.hh\": element \"P\" has no parameter \"hh\" (expected one of: x, h)");
  CHECK(contains(stage.error("time_s,Q.x\n0,1"), "t.csv:1:8: error: column \"Q.x\": there is no element \"Q\""));
  CHECK(stage.error("time_s,P.x,P.x\n0,1,1") == "t.csv:1:12: error: column \"P.x\" is given twice, expected once");
  CHECK(stage.error("time_s,P.x\n0,1\n1,2,3\n") == "t.csv:3:1: error: 3 cells, expected 2 as in the header");
  CHECK(stage.error("time_s,P.x\n\n# x\n0\n") == "t.csv:4:1: error: 1 cells, expected 2 as in the header");
  CHECK(contains(stage.error("# only comments\n"), "error: no header"));
  CHECK(stage.error("time_s,P.x\n0,\n") == "t.csv:2:3: error: empty cell, expected a finite number");
  CHECK(stage.error("time_s,P.x\n0,abc\n") == "t.csv:2:3: error: \"abc\" is not allowed, expected a finite number");
  CHECK(contains(stage.error("time_s,P.x\nnan,1\n"), "t.csv:2:1: error: \"nan\" is not allowed"));
  CHECK(stage.error("time_s,P.x\n0,1\n0,2\n") == "t.csv:3:1: error: time 0 is not allowed, expected one after 0 (s)");
  CHECK(stage.error("time_s,P.h\n0,3.5\n") ==
        "t.csv:2:3: error: P.h: 3.5 is not allowed, expected a number from 0 to 3 (m)");
  CHECK(contains(error_of([&] { Trajectory(stage.folder / "none.csv", stage.parameters); }),
                 "none.csv: error: cannot be read: No such file or directory"));
}

TEST_CASE("times beyond the clock are refused, and angles of any size give angles") {
  TrajectoryStage stage;
  for (const std::string time : {"1e300", "-1e300", "9.3e9", "9223372037"}) {
    CHECK(contains(stage.error("time_s,P.x\n" + time + ",1\n"), "t.csv:2:1: error: time "));
    CHECK(contains(stage.error("time_s,P.x\n" + time + ",1\n"), "is not allowed, expected -9e+09 to 9e+09 (s)"));
  }
  for (const std::string time : {"inf", "nan", "1e999", "0x10"}) {
    CHECK(contains(stage.error("time_s,P.x\n" + time + ",1\n"), "expected a finite number"));
  }
  const Trajectory close = stage.read("time_s,P.x\n-9e9,0\n0,1\n5e-324,2\n9e9,3\n");
  close.apply(5e-324, stage.parameters);
  CHECK(stage.parameters.values()[0] == 2);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
