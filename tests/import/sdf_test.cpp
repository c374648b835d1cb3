// Worlds and models in SDF: shapes, frames, files that include others, joints.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/pose.h>
#include "engine/base/srgb.h"
#include "scenegraph/primitive_meshes.h"
#include "tests/support/error_of.h"
#include "tests/support/sdf_scene.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

// Products of at most ten rotations and places of at most 10 m in double: ten times 10 m x 2^-52 and some.
constexpr double kChain_m = 1e-13;

constexpr double kQuarter = std::numbers::pi / 2;

glm::dmat4 pose(double x, double y, double z, double roll = 0, double pitch = 0, double yaw = 0) {
  return to_matrix({.position_m = {x, y, z}, .roll_rad = roll, .pitch_rad = pitch, .yaw_rad = yaw});
}

void check_same(const glm::dmat4& seen, const glm::dmat4& expected) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      CAPTURE(column);
      CAPTURE(row);
      CHECK(std::abs(seen[column][row] - expected[column][row]) <= kChain_m);
    }
  }
}

}  // namespace

TEST_CASE("every shape of SDF becomes the mesh of its sizes at its pose") {
  const std::vector<std::pair<std::string, Mesh>> cases = {
      {"<box><size>1 2 3</size></box>", box_mesh({1, 2, 3})},
      {"<sphere><radius>0.5</radius></sphere>", sphere_mesh(0.5)},
      {"<cylinder><radius>0.5</radius><length>2</length></cylinder>", cylinder_mesh(0.5, 2)},
      {"<capsule><radius>0.5</radius><length>2</length></capsule>", capsule_mesh(0.5, 2)},
      {"<cone><radius>0.5</radius><length>2</length></cone>", cone_mesh(0.5, 2)},
      {"<plane><normal>0 0 1</normal><size>3 4</size></plane>", plane_mesh({3, 4})}};
  for (const auto& [shape, mesh] : cases) {
    CAPTURE(shape);
    SdfScene scene(sdf_world("<model name='m'><pose>1 0 0 0 0 0</pose><link name='l'><pose>0 2 0 0 0 0</pose>" +
                             sdf_visual(shape, "<pose>0 0 3 0 0 0.5</pose>") + "</link></model>"));
    CHECK(scene.warnings().empty());
    REQUIRE(scene.list().items.size() == 1);
    CHECK(scene.mesh(0).positions == mesh.positions);
    check_same(scene.place(0), pose(1, 2, 3, 0, 0, 0.5));
  }
}

TEST_CASE("an ellipsoid is a sphere with three radii") {
  SdfScene scene(sdf_world("<model name='m'><link name='l'>" +
                           sdf_visual("<ellipsoid><radii>1 2 3</radii></ellipsoid>") + "</link></model>"));
  CHECK(scene.place(0) == glm::scale(glm::dmat4(1), glm::dvec3(1, 2, 3)));
  CHECK(scene.mesh(0).positions == sphere_mesh(1).positions);
}

TEST_CASE("a plane faces along its normal") {
  for (const glm::dvec3& normal : {glm::dvec3(1, 0, 0), {0, -2, 0}, {0, 0, -1}, {1, 2, -2}}) {
    const std::string text = std::to_string(normal.x) + " " + std::to_string(normal.y) + " " + std::to_string(normal.z);
    SdfScene scene(sdf_world("<model name='m'><link name='l'>" +
                             sdf_visual("<plane><normal>" + text + "</normal><size>2 2</size></plane>") +
                             "</link></model>"));
    const glm::dmat4 place = scene.place(0);
    CHECK(glm::length(glm::dvec3(place[2]) - glm::normalize(normal)) <= kChain_m);
    CHECK(is_rigid(place, kChain_m));
  }
}

TEST_CASE("models, links and joints are insertion points and elements under their models' names") {
  const std::string model =
      "<model name='NAME'><pose>X 0 0 0 0 0</pose><link name='base'/><link name='arm'/>"
      "<joint name='turn' type='revolute'><parent>base</parent><child>arm</child></joint></model>";
  const auto named = [&](std::string name, const std::string& x) {
    std::string text = model;
    text.replace(text.find("NAME"), 4, name);
    return text.replace(text.find("X"), 1, x);
  };
  SdfScene world(sdf_world(named("a", "1") + named("b", "2")));
  CHECK(world.warnings().empty());
  for (const char* name : {"a", "a/base", "a/arm"}) check_same(world.point(name), pose(1, 0, 0));
  check_same(world.point("b/arm"), pose(2, 0, 0));
  CHECK(world.value("a/turn", "value") == 0);
  CHECK(world.value("b/turn", "value") == 0);

  SdfScene single(sdf_model(named("a", "1")));
  check_same(single.point("arm"), pose(1, 0, 0));
  CHECK(single.value("turn", "value") == 0);
  CHECK(!single.built().scene.has_insertion_point("a"));
}

TEST_CASE("two insertions of a file have names of their own, and a part may be called like one of its models") {
  const std::string text = sdf_world("<model name='W'><link name='l'>" + sdf_box("1 1 1") + "</link></model>");
  SdfScene scene(text);
  CHECK(scene.built().scene.has_insertion_point("W/W/l"));
  SdfScene twice(text, {}, "<part file='w.sdf' name='V' insert_at='ROOT' pose_offset='5 0 0 0 0 0'/>");
  CHECK(twice.built().scene.has_insertion_point("W/W/l"));
  check_same(twice.point("V/W/l"), pose(5, 0, 0));
}

TEST_CASE("poses are relative to links, frames, joints and models, in any order") {
  // r = Rz(90 degrees); each pose is named by its letter.
  const glm::dmat4 model = pose(1, 2, 3, 0, 0, kQuarter), f = pose(0, 0, 1, kQuarter), l = pose(1, 0, 0),
                   g = pose(0, 1, 0, 0, kQuarter), v = pose(0, 0, 2);
  SdfScene scene(
      sdf_world("<frame name='wf'><pose>1 2 3 0 0 1.5707963267948966</pose></frame>"
                "<model name='m'><pose relative_to='wf'/>"
                "<link name='b'><pose relative_to='g'/>" +
                sdf_box("1 1 1", "<pose relative_to='f'>0 0 2 0 0 0</pose>") +
                "</link>"
                "<frame name='g' attached_to='l'><pose>0 1 0 0 1.5707963267948966 0</pose></frame>"
                "<link name='l'><pose relative_to='f'>1 0 0 0 0 0</pose></link>"
                "<frame name='f'><pose>0 0 1 1.5707963267948966 0 0</pose></frame>"
                "<link name='j2'><pose relative_to='j'/></link>"
                "<joint name='j' type='fixed'><pose degrees='true'>0 0 0 0 0 90</pose><parent>l</parent>"
                "<child>b</child></joint></model>"));
  CHECK(scene.warnings().empty());
  check_same(scene.point("m/l"), model * f * l);
  check_same(scene.point("m/b"), model * f * l * g);
  check_same(scene.point("m/j2"), model * f * l * g * pose(0, 0, 0, 0, 0, kQuarter));
  REQUIRE(scene.list().items.size() == 1);
  check_same(scene.place(0), model * f * v);
}

TEST_CASE("a placement frame is what the pose of a model places") {
  SdfScene scene(
      sdf_world("<model name='m' placement_frame='top'><pose>5 0 0 0 0 1.5707963267948966</pose>"
                "<link name='l'/><frame name='top'><pose>0 0 2 0 0 0</pose></frame></model>"));
  check_same(scene.point("m/l"), pose(5, 0, 0, 0, 0, kQuarter) * pose(0, 0, -2));
}

TEST_CASE("quaternions and models within models") {
  SdfScene scene(
      sdf_world("<model name='m'><pose>1 0 0 0 0 0</pose><link name='l'/><model name='n'>"
                "<pose rotation_format='quat_xyzw'>0 1 0 0 0 0.7071067811865476 0.7071067811865476</pose>"
                "<link name='k'><pose>1 0 0 0 0 0</pose></link></model>"
                "<link name='after'><pose relative_to='n::k'>0 0 1 0 0 0</pose></link></model>"));
  const glm::dmat4 k = pose(1, 1, 0, 0, 0, kQuarter) * pose(1, 0, 0);
  check_same(scene.point("m/n/k"), k);
  check_same(scene.point("m/after"), k * pose(0, 0, 1));
}

TEST_CASE("an included model has the include's name and pose") {
  const SdfTestFiles files = {
      {"models/cube/model.config", "<model><sdf version='1.5'>old.sdf</sdf><sdf version='1.6'>model.sdf</sdf></model>"},
      {"models/cube/model.sdf",
       sdf_model("<model name='cube'><pose>9 9 9 0 0 0</pose><link name='l'>" + sdf_box("1 2 3") + "</link></model>")},
      {"models/cube/old.sdf", sdf_model("<model name='old'/>")},
      {"models/sun/model.sdf", sdf_model("<light name='sun' type='directional'/>")}};
  SdfScene scene(sdf_world("<include><uri>model://cube</uri><name>a</name><pose>1 0 0 0 0 0</pose></include>"
                           "<include><uri>model://cube/model.sdf</uri></include>"
                           "<include><uri>models/cube</uri><name>c</name><pose>3 0 0 0 0 0</pose></include>"
                           "<include><uri>model://sun</uri><name>star</name></include>"),
                 files);
  CHECK(scene.warnings().empty());
  check_same(scene.point("a/l"), pose(1, 0, 0));
  check_same(scene.point("cube/l"), pose(9, 9, 9));
  check_same(scene.point("c/l"), pose(3, 0, 0));
  CHECK(scene.list().items.size() == 3);
  CHECK(scene.value("star", "elevation") == 90);
}

TEST_CASE("a merged include gives its names to the model around it") {
  const SdfTestFiles files = {{"models/arm/model.sdf", sdf_model("<model name='arm'><link name='hand'>"
                                                                 "<pose>1 0 0 0 0 0</pose></link></model>")}};
  SdfScene scene(sdf_world("<model name='m'><include merge='true'><uri>model://arm</uri><pose>0 0 2 0 0 0</pose>"
                           "</include><link name='l'><pose relative_to='hand'>0 1 0 0 0 0</pose></link></model>"),
                 files);
  check_same(scene.point("m/hand"), pose(1, 0, 2));
  check_same(scene.point("m/l"), pose(1, 1, 2));
}

TEST_CASE("joints turn and slide what follows them about their own axes") {
  SdfScene scene(
      sdf_world("<model name='m'><link name='base'/>"
                "<link name='arm'><pose>1 0 0 0 0 0</pose>" +
                sdf_box("1 1 1") +
                "</link><link name='tip'><pose>3 0 0 0 0 0</pose></link>"
                // Its frame is 1 m behind the arm, so that the arm turns about the model's origin.
                "<joint name='turn' type='revolute'><pose>-1 0 0 0 0 0</pose><parent>base</parent><child>arm</child>"
                "<axis><xyz>0 0 2</xyz><limit><lower>-3.1</lower><upper>3.1</upper></limit></axis></joint>"
                "<joint name='slide' type='prismatic'><parent>arm</parent><child>tip</child>"
                "<axis><xyz>0 1 0</xyz><limit><lower>0.5</lower><upper>2</upper></limit></axis></joint></model>"));
  REQUIRE(scene.warnings().size() == 1);
  CHECK(scene.warnings().front().find("cannot start at 0 m, outside of its limits 0.5 and 2 m") != std::string::npos);
  CHECK(scene.value("m/slide", "value") == 0.5);  // the limit nearest to 0
  scene.set("m/slide", 2);
  scene.set("m/turn", 90);
  check_same(scene.place(0), pose(0, 1, 0, 0, 0, kQuarter));
  check_same(scene.point("m/tip"), pose(0, 0, 0, 0, 0, kQuarter) * pose(3, 2, 0));
  CHECK_THROWS_AS(scene.set("m/turn", 180), InputError);  // 3.1 rad is 177.6 degrees
}

TEST_CASE("an axis stands in the frame that the file names") {
  const auto tip_of = [](const std::string& xyz, const std::string& version) {
    SdfScene scene(
        sdf_world("<model name='m'><link name='a'/><link name='b'><pose>0 0 0 0 0 1.5707963267948966</pose>"
                  "</link><frame name='f'><pose>0 0 0 0 1.5707963267948966 0</pose></frame>"
                  "<joint name='j' type='prismatic'><parent>a</parent><child>b</child><axis>" +
                      xyz + "</axis></joint></model>",
                  version));
    scene.set("m/j", 1);
    return glm::dvec3(scene.point("m/b")[3]);
  };
  const std::vector<std::tuple<std::string, std::string, glm::dvec3>> cases = {
      {"<xyz>1 0 0</xyz>", "1.9", {0, 1, 0}},
      {"<xyz expressed_in='__model__'>1 0 0</xyz>", "1.9", {1, 0, 0}},
      {"<xyz expressed_in='f'>1 0 0</xyz>", "1.9", {0, 0, -1}},
      {"<xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame>", "1.6", {1, 0, 0}},
      {"<xyz>1 0 0</xyz>", "1.4", {1, 0, 0}}};  // before 1.5: the model's frame
  for (const auto& [xyz, version, expected] : cases) {
    CAPTURE(xyz);
    CAPTURE(version);
    CHECK(glm::length(tip_of(xyz, version) - expected) <= kChain_m);
  }
}

TEST_CASE("a part's pose moves the whole world, and elements move a model") {
  SdfScene scene(
      sdf_world("<model name='m'><pose>1 0 0 0 0 0</pose><link name='l'>" + sdf_box("1 1 1") + "</link></model>"), {},
      "<element type='pose' name='P' insert_at='m' z='3'/>", "pose_offset='0 7 0 0 0 0' opacity='0.25'");
  check_same(scene.place(0), pose(1, 7, 3));
  CHECK(scene.material(0).opacity == 0.25f);
}
