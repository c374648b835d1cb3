// The element mimic_joint: which value it follows, its units and its errors.
#include <doctest/doctest.h>

#include <string>

#include <simvis/node.h>
#include <simvis/pose.h>
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("elements");

namespace simvis {
namespace {

BuiltScene build_joints(const std::string& xml) { return build_scene(parse_commands(xml, "s.xml", "")); }

std::string pair(const std::string& leader, const std::string& follower) {
  return "<element type='joint' name='A' insert_at='ROOT' " + leader +
         "/><element type='mimic_joint' name='B' insert_at='ROOT' leader='A' " + follower + "/>";
}

// The matrix of the follower after the leader has got `value` in the same way as in a step.
glm::dmat4 followed(BuiltScene& built, double value) {
  built.parameters.set(built.parameters.index("A", "value"), value);
  for (const std::size_t i : built.parameters.drain_changed_elements()) {
    const ElementDescriptor& element = built.parameters.elements()[i];
    built.elements[i]->update(built.parameters.values().subspan(element.first_value, element.parameters.size()));
  }
  return dynamic_cast<const Transform&>(*built.scene.find_node("B")).matrix();
}

TEST_CASE("a mimic joint follows its leader's value from the start and after every change") {
  BuiltScene built = build_joints(pair("value='20'", "multiplier='-2' offset='10' axis='0 0 3'"));
  CHECK(dynamic_cast<const Transform&>(*built.scene.find_node("B")).matrix() ==
        matrix_from_degrees({0, 0, 0}, 0, 0, -30));
  CHECK(followed(built, 50) == matrix_from_degrees({0, 0, 0}, 0, 0, -90));
  CHECK(followed(built, 5) == glm::dmat4(1));
  CHECK(built.parameters.elements().at(1).parameters.empty());
}

TEST_CASE(
    "several followers of different kinds: the multiplier converts the unit of the leader to that of the follower") {
  BuiltScene built = build_joints(pair("", "kind='prismatic' multiplier='0.125' axis='0 0 -1'"));
  CHECK(followed(built, 4)[3] == glm::dvec4(0, 0, -0.5, 1));  // 4 deg at 0.125 m/deg
  built =
      build_joints(pair("kind='prismatic'", "multiplier='180' axis='1 0 0'") +
                   "<element type='mimic_joint' name='C' insert_at='ROOT' leader='A' multiplier='2' axis='0 1 0'/>");
  CHECK(followed(built, 0.5) == matrix_from_degrees({0, 0, 0}, 90, 0, 0));  // 0.5 m at 180 deg/m
  CHECK(dynamic_cast<const Transform&>(*built.scene.find_node("C")).matrix() ==
        matrix_from_degrees({0, 0, 0}, 0, 1, 0));
}

TEST_CASE("mistakes in a mimic joint") {
  CHECK(contains(error_of([] { build_joints("<element type='mimic_joint' name='B' insert_at='ROOT'/>"); }),
                 "\"leader\""));
  CHECK(contains(error_of([] { build_joints(pair("", "").substr(pair("", "").find("/>") + 2)); }),
                 "s.xml:1:55: error: there is no element \"A\""));
  CHECK(contains(error_of([] {
                   build_joints("<element type='pose' name='A' insert_at='ROOT'/>" +
                                pair("", "").substr(pair("", "").find("/>") + 2));
                 }),
                 "\"A\" is not allowed, expected the name of an element of type joint"));
  CHECK(contains(error_of([] { build_joints(pair("", "axis='0 0 0'")); }), "expected a vector that is not zero"));
}

TEST_CASE("a removed mimic joint no longer follows") {
  BuiltScene built = build_joints("<element type='joint' name='A' insert_at='ROOT'/>");
  const auto add = [&](const std::string& xml) {
    SceneBuilder(built, {}).execute(parse_commands(xml, "more.xml", ""));
  };
  const std::string follower = "<element type='mimic_joint' name='B' insert_at='ROOT' leader='A'/>";
  CHECK(contains(error_of([&] { add(follower + "<element type='pose' name='B' insert_at='ROOT'/>"); }), "\"B\""));
  CHECK(built.scene.find_node("B") == nullptr);
  add(follower);
  CHECK(followed(built, 90) == matrix_from_degrees({0, 0, 0}, 0, 0, 90));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
