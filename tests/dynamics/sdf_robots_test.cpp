// SDF models as robots of physics, against the same ones as URDF.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>

#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// The pendulum of arm_urdf.h. The bar's frame is its middle, so that the joint has a place of its own; the hook has
// neither <inertial> nor mass that matters, because the model is fixed there.
const std::string kSdfPendulum = R"(<sdf version='1.7'><model name='p'>
  <link name='base'><visual name='v'><geometry><box><size>0.1 0.1 0.1</size></box></geometry></visual></link>
  <link name='bar'><pose>0.5 0 0 0 0 0.3</pose>
    <inertial><pose relative_to='swing'>0.5 0 0 0 0 0</pose><mass>1</mass><inertia><ixx>0.08333333333333333</ixx>
      <iyy>0.08333333333333333</iyy><izz>0.08333333333333333</izz></inertia></inertial>
    <visual name='v'><geometry><box><size>1 0.02 0.02</size></box></geometry></visual>
    <collision name='c'><geometry><box><size>0.1 0.02 0.02</size></box></geometry></collision></link>
  <joint name='swing' type='continuous'><pose relative_to='base'/><parent>base</parent><child>bar</child>
    <axis><xyz>0 1 0</xyz></axis></joint></model></sdf>)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  REQUIRE(contains(text, from));
  return text.replace(text.find(from), from.size(), to);
}

MovingScene sdf_scene(const std::string& text, const std::string& name, const std::string& attributes) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / name) << text;
  return MovingScene(kPhysics + "<part name='R' insert_at='ROOT' file='" + name +
                         "' pose_offset='0 0 2 0 0 0'/>\n<element type='robot' name='ROBOT' insert_at='R' " +
                         attributes + "/>",
                     folder.path());
}

TEST_CASE("a model of SDF swings as the same one of URDF") {
  MovingScene sdf = sdf_scene(kSdfPendulum, "p.sdf", "control='none'"),
              urdf = sdf_scene(kPendulum, "p.urdf", "control='none'");
  for (const double t : {0.3, 0.7, 1.1}) {
    sdf.go_to(t);
    urdf.go_to(t);
    CHECK(std::abs(urdf.get("swing", "value")) > 10);
    // The same motion from other frames: the rounding of a thousand steps.
    CHECK(std::abs(sdf.get("swing", "value") - urdf.get("swing", "value")) < 1e-8);
  }
  // The bar's middle is where the joint has it.
  const glm::dmat4 bar = sdf.pose("bar");
  CHECK(std::abs(glm::length(glm::dvec3(bar[3]) - glm::dvec3(0, 0, 2)) - 0.5) < 1e-9);
}

TEST_CASE("limits, efforts and speeds of SDF hold") {
  const std::string driven =
      replaced(replaced(kSdfPendulum, "continuous", "revolute"), "</axis>",
               "<limit><lower>-1</lower><upper>1</upper><effort>50</effort><velocity>2</velocity></limit></axis>");
  MovingScene scene = sdf_scene(driven, "p.sdf", "");
  scene.set("ROBOT", "target_swing", 30);
  scene.go_to(0.1);
  CHECK(scene.get("swing", "value") <= glm::degrees(2 * 0.1) + 0.2);  // 2 rad/s, and one step
  scene.go_to(2);
  // What gravity does in one step is what is left of the distance: g h / gain over the bar's length.
  CHECK(std::abs(scene.get("swing", "value") - 30) < glm::degrees(kGravity_m_s2 * kStep_s / 20));
}

TEST_CASE("each kind of SDF content that physics ignores gives a warning") {
  MovingScene scene = sdf_scene(
      replaced(replaced(kSdfPendulum, "</geometry></collision>",
                        "</geometry><surface><friction><torsional><coefficient>1</coefficient></torsional></friction>"
                        "</surface></collision>"),
               "</axis>", "<dynamics><spring_stiffness>3</spring_stiffness></dynamics></axis>"),
      "p.sdf", "control='none'");
  const std::vector<std::string> warnings = (*scene).scene.warnings();
  const auto has = [&](const char* what) {
    return std::ranges::any_of(warnings, [&](const std::string& each) { return contains(each, what); });
  };
  CHECK(has("link \"base\" has no <inertial>; it has what SDF gives it"));
  CHECK(has("torsional friction"));
}

TEST_CASE("mistakes in SDF models name their place") {
  const auto wrong = [](const std::string& text) {
    return error_of([&] { sdf_scene(text, "p.sdf", "control='none'"); });
  };
  CHECK(contains(wrong(replaced(kSdfPendulum, "continuous", "ball")), "has the type \"ball\", which physics does not"));
  CHECK(contains(wrong(replaced(kSdfPendulum, "<mass>1", "<mass>-1")), "element <mass> is -1, expected at least 0"));
  CHECK(contains(wrong(replaced(kSdfPendulum, "<mass>1", "<mass>inf")), "element <mass> is inf, expected at least 0"));
  CHECK(contains(wrong(replaced(kSdfPendulum, "</model>", "<link name='loose'/></model>")),
                 "\"loose\" is not joined with \"base\""));
  CHECK(contains(wrong(replaced(kSdfPendulum, "</model>", "</model><model name='second'><link name='l'/></model>")),
                 "expected a file with one model"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
