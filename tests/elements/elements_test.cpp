// Tables of all registered elements, and the kinematics of pose and joint.
#include <simvis/element.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <simvis/pose.h>
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/stub_part.h"

TEST_SUITE_BEGIN("elements");

namespace simvis {
namespace {

BuiltScene build(const std::string& attributes) {
  return build_scene(parse_commands("<element name='E' insert_at='ROOT' " + attributes + "/>", "s.xml", ""));
}
std::string error(const std::string& attributes) {
  return error_of([&] { build(attributes); });
}

// The attributes that an element of the type requires.
std::string needs(std::string_view type) {
  if (type == "laser_beams" || type == "point_cloud") return " scanner='S'";
  if (type == "graph") return " nodes='1 2 3, 4 5 6'";
  if (type == "trail" || type == "material") return " part='R'";
  if (type == "color_temperature") return " light='LIGHT'";
  return "";
}

// The scene of an element with only what it needs: a part R, a light LIGHT in front of it, and a scanner S.
BuiltScene build_alone(std::string_view type) {
  TemporaryFolder folder;
  write_text(folder / "part.stub", "triangle 1");
  return build_scene(parse_commands(
      "<part file='part.stub' name='R' insert_at='ROOT'/><element type='light' name='LIGHT' insert_at='ROOT'/>"
      "<element name='E' insert_at='R' type='" +
          std::string(type) + "'" + needs(type) + "/><sensor type='laser_scanner' name='S' insert_at='ROOT'/>",
      "s.xml", folder.path()));
}

// Changes one parameter in the same way as a step.
void change(BuiltScene& built, std::string_view parameter, double value) {
  built.parameters.set(built.parameters.index("E", parameter), value);
  for (const std::size_t i : built.parameters.drain_changed_elements()) {
    const ElementDescriptor& element = built.parameters.elements()[i];
    built.elements[i]->update(built.parameters.values().subspan(element.first_value, element.parameters.size()));
  }
}

// The matrix of the element's transform after a change of one parameter.
glm::dmat4 moved(BuiltScene& built, std::string_view parameter, double value) {
  change(built, parameter, value);
  return dynamic_cast<const Transform&>(*built.scene.root()->children().at(0)).matrix();
}
glm::dmat4 matrix(const std::string& attributes) {
  const BuiltScene built = build(attributes);
  return dynamic_cast<const Transform&>(*built.scene.root()->children().at(0)).matrix();
}

TEST_CASE("pose and joint are registered, and types are sorted by name") {
  const std::vector<const ElementType*> types = element_types();
  CHECK(std::ranges::is_sorted(types, {}, &ElementType::name));
  REQUIRE(find_element_type("pose") != nullptr);
  REQUIRE(find_element_type("joint") != nullptr);
  CHECK(find_element_type("nothing") == nullptr);
  CHECK(find_element_type("pose")->name == "pose");
}

// Angles of any size are allowed. Every other parameter has limits, so that no picture overflows.
bool has_limits(const AttributeSpec& row) {
  const bool angle = row.unit == "deg";
  return angle || (std::isfinite(row.min) && std::isfinite(row.max));
}

TEST_CASE("the table of every element has descriptions, and its defaults are legal") {
  for (const ElementType* type : element_types()) {
    CAPTURE(std::string(type->name));
    CHECK_FALSE(type->summary.empty());
    CHECK(check_table(type->attributes).empty());
    for (const AttributeSpec& row : type->attributes) {
      CAPTURE(std::string(row.name));
      CHECK_FALSE(row.text.empty());
      if (!row.live) continue;
      double by_default = 0;
      REQUIRE(parse_number(row.default_value, by_default));
      CHECK(check_number(row, by_default).empty());
      CHECK(has_limits(row));
    }
  }
}

// Whether a command of the type needs no attributes of its own, no physics and no part of a robot's file:
// tests/dynamics and tests/messages have those that do.
bool stands_alone(const ElementType& type) {
  constexpr std::string_view kNeedModels[] = {"models", "robot", "robot_description"};
  if (std::ranges::find(kNeedModels, type.name) != std::end(kNeedModels)) return false;
  const std::string refused = error_of([&] { build_alone(type.name); });
  if (refused.find("the scene has no physics") != std::string::npos) return false;
  return std::ranges::none_of(type.attributes, [](const AttributeSpec& row) {
    return is_reference(row.kind) || (row.kind == AttributeKind::text && row.default_value.empty());
  });
}

TEST_CASE("each parameter of elements that need little can be set and read, and its limits hold") {
  for (const ElementType* type : element_types()) {
    if (!stands_alone(*type) && needs(type->name).empty()) continue;  // another test covers it
    CAPTURE(std::string(type->name));
    BuiltScene built = build_alone(type->name);
    REQUIRE(built.parameters.elements().size() == 2);
    const ElementDescriptor element = built.parameters.elements()[1];
    CHECK_FALSE(element.parameters.empty());
    // Rows of the table come first. An element may append its own rows.
    CHECK(std::ranges::is_partitioned(element.parameters, [&](const AttributeSpec& row) {
      return std::ranges::count(type->attributes, row.name, &AttributeSpec::name) == 1;
    }));
    for (std::size_t i = 0; i < element.parameters.size(); ++i) {
      const AttributeSpec& row = element.parameters[i];
      CAPTURE(std::string(row.name));
      const std::size_t index = built.parameters.index("E", row.name);
      CHECK(index == element.first_value + i);
      double by_default = 0;
      REQUIRE(parse_number(row.default_value, by_default));
      CHECK(built.parameters.values()[index] == by_default);
      const double low = std::max(row.min, -1e6), high = std::min(row.max, 1e6);
      for (const double part : {0.25, 0.5, 0.75}) {
        const double value = low + part * (high - low);
        change(built, row.name, value);
        CHECK(built.parameters.values()[index] == value);
      }
      const double kept = built.parameters.values()[index];
      // Without a limit, the next value beyond is infinity.
      const double infinity = std::numeric_limits<double>::infinity();
      const double refused[] = {std::nextafter(row.min, -infinity), std::nextafter(row.max, infinity), std::nan("")};
      for (const double beyond : refused) {
        CHECK(contains(error_of([&] { built.parameters.set(index, beyond); }), "E." + std::string(row.name) + ": "));
        CHECK(built.parameters.values()[index] == kept);
      }
    }
  }
}

TEST_CASE("the pose element") {
  CHECK(matrix("type='pose'") == glm::dmat4(1));
  CHECK(matrix("type='pose' x='1' y='2' z='3' roll='90' pitch='-90' yaw='180'") ==
        matrix_from_degrees({1, 2, 3}, 90, -90, 180));
  BuiltScene built = build("type='pose' x='1'");
  CHECK(moved(built, "yaw", 1e9) == matrix_from_degrees({1, 0, 0}, 0, 0, 280));
  CHECK(moved(built, "z", 7)[3] == glm::dvec4(1, 0, 7, 1));
}

TEST_CASE("a revolute joint turns about its axis by the right-hand rule") {
  const auto turned = [](const std::string& attributes, const glm::dvec3& v) {
    return glm::dvec3(matrix("type='joint' " + attributes) * glm::dvec4(v, 1));
  };
  const glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  CHECK(turned("value='90'", x) == y);
  CHECK(turned("value='90' axis='0 2 0'", x) == -z);
  CHECK(turned("value='-90' axis='0 1e200 0'", x) == z);
  CHECK(turned("value='90' axis='-1e-200 0 0'", y) == -z);
  CHECK(turned("value='180'", x) == -x);
  // A third of a rotation about the space diagonal: x to y to z. Sums of a few terms near 1: 8 half-ulps.
  CHECK(glm::length(turned("value='120' axis='1 1 1'", x) - y) < 8 * 1.2e-16);
  CHECK(glm::length(turned("value='120' axis='1 1 1'", y) - z) < 8 * 1.2e-16);
}

TEST_CASE("a prismatic joint slides along its axis") {
  BuiltScene built = build("type='joint' kind='prismatic' axis='0 0 -5' value='0.5'");
  CHECK(matrix("type='joint' kind='prismatic' axis='0 0 -5' value='0.5'")[3] == glm::dvec4(0, 0, -0.5, 1));
  CHECK(moved(built, "value", -2)[3] == glm::dvec4(0, 0, 2, 1));
  CHECK(built.parameters.spec(0).unit == "m");
}

TEST_CASE("the limits of a joint belong to it alone") {
  BuiltScene built = build("type='joint' lower='-30' upper='60' value='60'");
  CHECK(error_of([&] { built.parameters.set(0, 60.5); }) ==
        "E.value: 60.5 is not allowed, expected a number from -30 to 60 (deg)");
  CHECK(error_of([&] { built.parameters.set(0, -31); }) ==
        "E.value: -31 is not allowed, expected a number from -30 to 60 (deg)");
  CHECK(built.parameters.values()[0] == 60);
  built.parameters.set(0, -30);
  CHECK(built.parameters.values()[0] == -30);
  // The table of the type is unchanged.
  CHECK(find_element_type("joint")->attributes.back().max == kMaxCoordinate_m);
}

TEST_CASE("angles of full turns: those of poses, and of revolute joints without limits") {
  const auto full_turn = [](const std::string& attributes, std::string_view parameter) {
    const BuiltScene built = build(attributes);
    return built.parameters.spec(built.parameters.index("E", parameter)).full_turn;
  };
  for (const char* angle : {"roll", "pitch", "yaw"}) CHECK(full_turn("type='pose'", angle));
  CHECK_FALSE(full_turn("type='pose'", "x"));
  CHECK(full_turn("type='joint' axis='0 0 1'", "value"));
  CHECK_FALSE(full_turn("type='joint' axis='0 0 1' upper='170'", "value"));
  CHECK_FALSE(full_turn("type='joint' axis='0 0 1' kind='prismatic'", "value"));
  CHECK(full_turn("type='light'", "azimuth"));
  CHECK_FALSE(full_turn("type='light'", "elevation"));
}

TEST_CASE("mistakes in a joint") {
  CHECK(error("type='joint' axis='0 0 0'") ==
        "s.xml:1:49: error: attribute \"axis\": 0 0 0 is not allowed, expected a vector that is not zero");
  CHECK(contains(error("type='joint' lower='5' upper='4'"),
                 "s.xml:1:49: error: attribute \"lower\": 5 is not allowed, expected at most \"upper\", 4"));
  CHECK(error("type='joint' lower='-1' upper='1' value='2'") ==
        "s.xml:1:70: error: attribute \"value\": 2 is not allowed, expected a number from -1 to 1 (deg)");
  CHECK(contains(error("type='joint' kind='prismatic' lower='1'"),
                 "s.xml:1:2: error: attribute \"value\": 0 is not allowed, expected a number from 1 to"));
  CHECK(contains(error("type='joint' kind='ball'"), "\"ball\" is not allowed, expected one of: revolute, prismatic"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
