// Whole worlds of SDF that stand, fall, slide and swing, against closed formulas.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <glm/trigonometric.hpp>

#include "tests/support/moving_scene.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

const std::string kSeen = "<visual name='v'><geometry><box><size>0.1 0.1 0.1</size></box></geometry></visual>";
const std::string kSdfFloor =
    "<model name='floor'><static>1</static><link name='l'>" + kSeen +
    "<collision name='c'><geometry><plane><normal>0 0 1</normal><size>1 1</size></plane></geometry>"
    "<surface><bounce><restitution_coefficient>1</restitution_coefficient></bounce></surface></collision>"
    "</link></model>";

// A link of 2 kg with the inertia of a cube of 1 m, which all shapes here resemble.
std::string sdf_link(const std::string& collisions, const std::string& more = "") {
  return "<link name='l'><inertial><mass>2</mass><inertia><ixx>0.33</ixx><iyy>0.33</iyy><izz>0.33</izz></inertia>"
         "</inertial>" +
         kSeen + collisions + more + "</link>";
}
std::string sdf_collision(const std::string& shape, const std::string& more = "") {
  return "<collision name='c'><geometry>" + shape + "</geometry>" + more + "</collision>";
}
std::string sdf_body(const std::string& name, const std::string& pose, const std::string& link) {
  return "<model name='" + name + "'><pose>" + pose + "</pose>" + link + "</model>";
}
std::string sliding(const std::string& mu) {
  return "<surface><friction><ode><mu>" + mu + "</mu></ode></friction></surface>";
}
const std::string kCube = "<box><size>1 1 1</size></box>";

MovingScene world_scene(const std::string& world, const std::string& attributes = "",
                        const std::string& physics = "world='W'") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "w.world") << "<sdf version='1.9'><world name='w'>\n" + world + "</world></sdf>";
  return MovingScene(
      "<part name='W' insert_at='ROOT' file='w.world'/>\n"
      "<element type='physics' name='PHYSICS' insert_at='ROOT' " +
          physics + "/>\n<element type='models' name='BODIES' insert_at='W' " + attributes + "/>",
      folder.path());
}

bool warns(MovingScene& scene, const char* what) {
  const std::vector<std::string> warnings = (*scene).scene.warnings();
  return std::ranges::any_of(warnings, [&](const std::string& each) { return contains(each, what); });
}

TEST_CASE("shapes of a world stand on its plane") {
  MovingScene scene = world_scene(
      kSdfFloor + sdf_body("box", "0 0 0.5 0 0 0", sdf_link(sdf_collision(kCube))) +
      sdf_body("cylinder", "3 0 0.5 0 0 0",
               sdf_link(sdf_collision("<cylinder><radius>0.5</radius><length>1</length></cylinder>"))) +
      sdf_body("sphere", "6 0 0.5 0 0 0", sdf_link(sdf_collision("<sphere><radius>0.5</radius></sphere>"))) +
      sdf_body("capsule", "9 0 0.5 0 1.5707963267948966 0",
               sdf_link(sdf_collision("<capsule><radius>0.5</radius><length>1</length></capsule>"))) +
      sdf_body("cone", "12 0 0.5 0 0 0",
               sdf_link(sdf_collision("<cone><radius>0.5</radius><length>1</length></cone>"))) +
      sdf_body("ellipsoid", "15 0 0.5 0 0 0",
               sdf_link(sdf_collision("<ellipsoid><radii>0.7 0.6 0.5</radii></ellipsoid>"))) +
      sdf_body("prism", "18 0 0 0 0 0",
               sdf_link(sdf_collision("<polyline><point>-0.5 -0.5</point><point>0.5 -0.5</point><point>0 0.5</point>"
                                      "<height>1</height></polyline>"))));
  CHECK((*scene).scene.warnings().empty());
  std::vector<glm::dvec3> start;
  const char* const names[] = {"box", "cylinder", "sphere", "capsule", "cone", "ellipsoid", "prism"};
  for (const char* name : names) start.push_back(scene.position(std::string(name) + "/l"));
  scene.run(0, 2, 0.1);
  // Contacts rest at an overlap of less than 0.1 mm; the round shapes of meshes are flat to 0.28 % of their radius.
  constexpr double kRest_m = 1e-4, kFlat = 0.0028;
  for (std::size_t i = 0; i < std::size(names); ++i) {
    CAPTURE(names[i]);
    const glm::dvec3 moved = scene.position(std::string(names[i]) + "/l") - start[i];
    CHECK(std::abs(moved.z) < kRest_m + kFlat * 0.7);
    CHECK(glm::length(glm::dvec2(moved)) < 1e-3);
  }
}

TEST_CASE("gravity, step and iterations of a world hold where the scene gives none") {
  const std::string moon =
      "<physics type='ode'><max_step_size>0.004</max_step_size></physics>"
      "<gravity>0 0 -1.62</gravity>" +
      sdf_body("ball", "0 0 9 0 0 0", sdf_link(""));
  constexpr double kRounding_m = 1e-11;
  MovingScene file = world_scene(moon);
  file.go_to(2);
  CHECK(std::abs(file.position("ball/l").z - (9 - 1.62 * 2 * (2 + 0.004) / 2)) < kRounding_m);
  CHECK(std::abs(file.get("BODIES", "z_ball/l") - (file.position("ball/l").z - 9)) < kRounding_m);
  MovingScene own = world_scene(moon, "", "world='W' gravity='0 0 -5' step='1'");
  own.go_to(1);
  CHECK(std::abs(own.position("ball/l").z - (9 - 5 * 1.001 / 2)) < kRounding_m);
}

TEST_CASE("each collision has its own friction") {
  // Gravity leans by 30 degrees. A second collision, which touches nothing, has another friction.
  const double lean = glm::radians(30.0), g_sin = kGravity_m_s2 * std::sin(lean),
               g_cos = kGravity_m_s2 * std::cos(lean);
  char gravity[96];
  std::snprintf(gravity, sizeof(gravity), "<gravity>%.17g 0 %.17g</gravity>", g_sin, -g_cos);
  const auto sled = [](const std::string& name, double y, const std::string& below, const std::string& above) {
    return sdf_body(
        name, "0 " + format_number(y) + " 0.1 0 0 0",
        sdf_link("<collision name='a'><pose>0 0 0.5 0 0 0</pose><geometry><box><size>0.1 0.1 0.1</size></box>"
                 "</geometry>" +
                 sliding(above) + "</collision>" +
                 sdf_collision("<box><size>0.8 0.8 0.2</size></box>", sliding(below))));
  };
  const std::string world =
      gravity + kSdfFloor + sled("ice", 0, "0", "1") + sled("wood", 3, "0.3", "1") + sled("rubber", 6, "0.6", "0");
  MovingScene scene = world_scene(world);
  scene.go_to(1);
  CHECK(scene.position("ice/l").x == doctest::Approx(g_sin * (1 + kStep_s) / 2).epsilon(1e-6));
  // As of the box on a slope in bodies_test.cpp.
  CHECK(std::abs(scene.position("wood/l").x - (g_sin - 0.3 * g_cos) * (1 + kStep_s) / 2) < 10 * kStep_s * 0.3 * g_cos);
  CHECK(std::abs(scene.position("rubber/l").x) < 1e-3);
  MovingScene gripping = world_scene(world, "friction='1'");
  gripping.go_to(1);
  CHECK(std::abs(gripping.position("ice/l").x) < 1e-3);
}

TEST_CASE("a restitution of the file bounces") {
  MovingScene scene =
      world_scene(kSdfFloor + sdf_body("ball", "0 0 1.1 0 0 0",
                                       sdf_link(sdf_collision("<sphere><radius>0.1</radius></sphere>",
                                                              "<surface><bounce><restitution_coefficient>0.8"
                                                              "</restitution_coefficient></bounce></surface>"))),
                  "", "");
  const double fall_s = std::sqrt(2 / kGravity_m_s2), speed = kGravity_m_s2 * fall_s;
  double highest = 0;
  for (double t = 1.1 * fall_s; t < 2.6 * fall_s; t += kStep_s) {
    scene.go_to(t);
    highest = std::max(highest, scene.position("ball/l").z - 0.1);
  }
  CHECK(std::abs(highest - 0.64) < 2 * (1 + 0.64) * speed * kStep_s);  // see bodies_test.cpp
}

TEST_CASE("a spring of a joint that the world holds swings with its period") {
  // 2 kg on 50 N/m that hang from the world: z = -(m g / k) (1 - cos w t), w = sqrt(k / m).
  MovingScene scene = world_scene(
      "<model name='m'>" + sdf_link("") +
          "<joint name='j' type='prismatic'><parent>world</parent><child>l</child><axis><xyz>0 0 1</xyz><dynamics>"
          "<spring_stiffness>50</spring_stiffness></dynamics></axis></joint></model>",
      "", "");
  constexpr double kMass_kg = 2, kStiffness = 50;
  const double w = std::sqrt(kStiffness / kMass_kg), reach = kMass_kg * kGravity_m_s2 / kStiffness;
  for (const double t : {0.2, 0.7, 1.9}) {
    scene.go_to(t);
    // Semi-implicit steps: a phase of w h / 2, and (w h)^2 / 24 of the period.
    CHECK(std::abs(scene.get("m/j", "value") + reach * (1 - std::cos(w * t))) < reach * (w * kStep_s));
  }
}

TEST_CASE("a joint of a world holds a model at another one") {
  // A cube of 2 kg and 0.33 kg m^2 swings about a hinge 1 m beside its middle, at a static model or at one that flies.
  const std::string hinge =
      "<joint name='j' type='revolute'><parent>base::l</parent><child>bar::l</child><pose>-1 0 0 0 0 0</pose>"
      "<axis><xyz>0 1 0</xyz></axis></joint>";
  const std::string bar = sdf_body("bar", "1 0 3 0 0 0", sdf_link(""));
  MovingScene standing = world_scene(
      "<model name='base'><static>1</static><pose>0 0 3 0 0 0</pose>" + sdf_link("") + "</model>" + bar + hinge, "",
      "");
  CHECK((*standing).scene.warnings().empty());
  standing.go_to(0.3);
  // A quarter of the way, where the torque is still almost m g d: q = m g d t^2 / (2 I), less a tenth of q^3.
  const double inertia = 0.33 + 2, q = 2 * kGravity_m_s2 * 0.3 * 0.3 / (2 * inertia);
  CHECK(std::abs(glm::radians(standing.get("j", "value")) - q) < q * q * q / 10 + q * kStep_s / 0.3);
  CHECK(standing.position("base/l").z == 3);
  MovingScene falling = world_scene(sdf_body("base", "0 0 3 0 0 0", sdf_link("")) + bar + hinge, "", "");
  falling.go_to(0.5);
  const double fall_m = kGravity_m_s2 * 0.5 * (0.5 + kStep_s) / 2;
  for (const char* const link : {"base/l", "bar/l"}) CHECK(std::abs(falling.position(link).z - (3 - fall_m)) < 1e-9);
}

TEST_CASE("static models stand, links without weight float, and a world's model may lie in another") {
  MovingScene scene = world_scene(
      kSdfFloor + "<model name='hung'><static>true</static>" + sdf_body("inner", "0 0 5 0 0 0", sdf_link("")) +
          "</model>" + sdf_body("floats", "0 3 5 0 0 0", sdf_link("", "<gravity>false</gravity>")) +
          "<model name='outer'><pose>0 6 5 0 0 0</pose>" + sdf_body("inner", "0 0 1 0 0 0", sdf_link("")) + "</model>",
      "", "");
  scene.go_to(0.5);
  CHECK(scene.position("hung/inner/l").z == 5);
  CHECK(scene.position("floats/l").z == 5);
  CHECK(std::abs(scene.position("outer/inner/l").z - (6 - kGravity_m_s2 * 0.5 * (0.5 + kStep_s) / 2)) < 1e-9);
}

TEST_CASE("a mesh of a static model carries") {
  const TemporaryFolder folder;
  // Two triangles at the height 2.
  std::ofstream(folder.path() / "table.obj") << "v -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\nf 1 2 3\nf 1 3 4\n";
  std::ofstream(folder.path() / "w.sdf")
      << "<sdf version='1.9'><world name='w'><model name='table'><static>1</static>" +
             sdf_link(sdf_collision("<mesh><uri>table.obj</uri></mesh>")) + "</model>" +
             sdf_body("box", "0.1 0.2 2.55 0 0 0", sdf_link(sdf_collision(kCube))) + "</world></sdf>";
  MovingScene scene("<part name='W' insert_at='ROOT' file='w.sdf'/>" + kPhysics +
                        "<element type='models' name='BODIES' insert_at='W'/>",
                    folder.path());
  scene.run(0, 1, 0.1);
  CHECK(std::abs(scene.position("box/l").z - 2.5) < 1e-3);
}

TEST_CASE("a restart of a world gives the same bytes") {
  MovingScene scene = world_scene(kSdfFloor + sdf_body("a", "0 0 2 0 0 0", sdf_link(sdf_collision(kCube))) +
                                      sdf_body("b", "0.3 0 4 0 0.2 0", sdf_link(sdf_collision(kCube))),
                                  "", "");
  scene.run(0, 1, 0.1);
  std::vector<double> first = scene.values();
  scene.set("PHYSICS", "restarts", 1);
  scene.go_to(1.1);
  scene.run(1.1, 2.1, 0.1);
  std::vector<double> again = scene.values();
  again[1] = 0;
  CHECK(again == first);
  scene.set("BODIES", "z_a/l", 5);
  scene.go_to(2.101);
  CHECK(std::abs(scene.position("a/l").z - 7) < 1e-4);
}

TEST_CASE("each kind of content of a world that physics ignores gives a warning") {
  MovingScene scene =
      world_scene(sdf_body("a", "0 0 0 0 0 0",
                           sdf_link(sdf_collision("<plane><normal>0 0 1</normal></plane>") +
                                    sdf_collision("<mesh><uri>none.obj</uri></mesh>") +
                                    sdf_collision(kCube,
                                                  "<surface><friction><ode><mu>1</mu><mu2>0.5</mu2></ode></friction>"
                                                  "<contact><ode><kp>1e6</kp></ode></contact></surface>"))));
  CHECK(warns(scene, "plane that collides and is not static"));
  CHECK(warns(scene, "a collision of link \"l\" is left out"));
  CHECK(warns(scene, "second coefficient of friction"));
  CHECK(warns(scene, "<ode> of the <contact> of a surface"));
}

TEST_CASE("mistakes in worlds name their place") {
  const auto wrong = [](const std::string& world) { return error_of([&] { world_scene(world); }); };
  CHECK(
      contains(wrong("<model name='m'><link name='l'><inertial><mass>0</mass></inertial>" + kSeen + "</link></model>"),
               "w.world:2:18: error: link \"m/l\" moves and has no mass"));
  CHECK(contains(wrong("<physics><max_step_size>-1</max_step_size></physics>" + kSdfFloor),
                 "element <max_step_size> is -1 s, expected a step from"));
  CHECK(contains(error_of([] {
                   MovingScene(kPhysics +
                               "<part name='A' insert_at='ROOT' shape='box' size='1 1 1'/>"
                               "<element type='models' name='B' insert_at='A'/>");
                 }),
                 "expected the name of a part from a URDF, SDF or MJCF file"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
