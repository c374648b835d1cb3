// Which surfaces collide: masks of every format and shape, excluded and disabled pairs of links, against MuJoCo's rule.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include "elements/dynamics/world/engine_module.h"
#include "elements/sensed_physics.h"
#include "scenegraph/collision_mask.h"
#include "tests/support/moving_scene.h"
#include "tests/support/python_package.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

using NamePair = std::pair<std::string, std::string>;  // the lesser one first

// The elements whose bodies touch, by the last step or the start.
std::set<NamePair> touching_bodies(MovingScene& scene) {
  const auto physics_of_scene = find_physics((*scene).scene);
  const std::vector<DrawnBody> bodies = physics_of_scene->drawn_bodies();
  std::set<NamePair> pairs;
  for (const DrawnContact& contact : physics_of_scene->drawn_state().contacts) {
    pairs.insert(std::minmax(bodies.at(contact.a.value()).name, bodies.at(contact.b.value()).name));
  }
  return pairs;
}

constexpr int kMasks = 16;  // of bits 0 to 3
std::string masked_name(int category, int collides) {
  return "b" + std::to_string(category) + "_" + std::to_string(collides);
}

// A ball for each category and each mask of collisions. All overlap by less than a warning needs.
std::string masked_balls() {
  std::string text = "<mujoco><size memory='1G'/><option gravity='0 0 0'/><worldbody>";
  for (int category = 0; category < kMasks; ++category) {
    for (int collides = 0; collides < kMasks; ++collides) {
      text += "<body name='" + masked_name(category, collides) + "' pos='" +
              format_number(1e-6 * (category * kMasks + collides)) +
              " 0 0'><freejoint/><geom type='sphere' size='0.004' mass='1' contype='" + std::to_string(category) +
              "' conaffinity='" + std::to_string(collides) + "'/></body>";
    }
  }
  return text + "</worldbody></mujoco>";
}

TEST_CASE("geoms of MJCF collide by MuJoCo's rule, for all pairs of masks of four bits") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "m.xml") << masked_balls();
  MovingScene scene("<part name='M' insert_at='ROOT' file='m.xml'/>\n" + physics("world='M'") +
                        "<element type='models' name='BODIES' insert_at='M'/>",
                    folder.path());
  CHECK((*scene).scene.warnings().empty());
  const std::set<NamePair> pairs = touching_bodies(scene);
  std::size_t compared = 0, wrong = 0;
  for (int one = 0; one < kMasks * kMasks; ++one) {
    for (int other = one + 1; other < kMasks * kMasks; ++other, ++compared) {
      const int type1 = one / kMasks, affinity1 = one % kMasks, type2 = other / kMasks, affinity2 = other % kMasks;
      const bool collide = (type1 & affinity2) != 0 || (type2 & affinity1) != 0;
      wrong += collide != pairs.contains(std::minmax(masked_name(type1, affinity1), masked_name(type2, affinity2)));
    }
  }
  CHECK(compared == std::size_t{256 * 255 / 2});
  CHECK(wrong == 0);
  if (!has_python_module("mujoco")) return;
  const ProcessResult mujoco = Process({kToolsPython, "-c",
                                        "import sys, mujoco\n"
                                        "model = mujoco.MjModel.from_xml_path(sys.argv[1])\n"
                                        "data = mujoco.MjData(model)\n"
                                        "mujoco.mj_kinematics(model, data)\n"
                                        "mujoco.mj_comPos(model, data)\n"
                                        "mujoco.mj_collision(model, data)\n"
                                        "for each in data.contact:\n"
                                        "    print(*[model.body(model.geom_bodyid[g]).name for g in each.geom])\n",
                                        (folder.path() / "m.xml").string()})
                                   .wait();
  REQUIRE_MESSAGE(mujoco.exit_code == 0, mujoco.err);
  std::istringstream lines(mujoco.out);
  std::set<NamePair> theirs;
  for (std::string a, b; lines >> a >> b;) theirs.insert(std::minmax(a, b));
  CHECK(pairs == theirs);
}

// Shapes of every kind, of a body or of a link, above shapes of every kind, of which one may be one of several.
std::vector<std::pair<std::string, std::vector<CollisionShape>>> filtered_shapes() {
  const CollisionShape box{.kind = CollisionKind::box, .half_m = glm::dvec3(0.1)};
  CollisionShape hull = dynamics_engine()
                            .convex_hull(std::vector<glm::dvec3>{{-0.1, -0.1, -0.1},
                                                                 {0.1, -0.1, -0.1},
                                                                 {-0.1, 0.1, -0.1},
                                                                 {0.1, 0.1, -0.1},
                                                                 {-0.1, -0.1, 0.1},
                                                                 {0.1, -0.1, 0.1},
                                                                 {-0.1, 0.1, 0.1},
                                                                 {0.1, 0.1, 0.1}})
                            .value();
  CollisionShape above = box;
  above.body_from_shape[3] = {0, 0, 1, 1};
  return {{"box", {box}},
          {"sphere", {{.kind = CollisionKind::sphere, .half_m = glm::dvec3(0.1)}}},
          {"capsule", {{.kind = CollisionKind::capsule, .half_m = glm::dvec3(0.05)}}},
          {"cylinder", {{.kind = CollisionKind::cylinder, .half_m = glm::dvec3(0.1)}}},
          {"hull", {hull}},
          {"two boxes", {box, above}}};
}

std::vector<std::pair<std::string, std::vector<CollisionShape>>> filtering_floors() {
  CollisionShape box{.kind = CollisionKind::box, .half_m = {5, 5, 0.5}}, beside = box;
  box.body_from_shape[3] = {0, 0, -0.5, 1};
  beside.body_from_shape[3] = {20, 0, -0.5, 1};
  const CollisionShape mesh{.kind = CollisionKind::mesh,
                            .points = {{-5, -5, 0}, {5, -5, 0}, {5, 5, 0}, {-5, 5, 0}},
                            .triangles = {0, 1, 2, 0, 2, 3}};
  return {{"box", {box}}, {"plane", {{.kind = CollisionKind::plane}}}, {"mesh", {mesh}}, {"two boxes", {box, beside}}};
}

TEST_CASE("masks hold for every kind of shape, of bodies and links") {
  constexpr CollisionMask kOne{.category = 1, .collides = 2}, kMeeting{.category = 2, .collides = 4},
      kPassing{.category = 4, .collides = 8};
  constexpr int kSteps = 500;
  std::size_t tried = 0;
  for (const auto& [name_of_shape, shapes] : filtered_shapes()) {
    for (const auto& [name_of_floor, floor_shapes] : filtering_floors()) {
      const std::string shape_name(name_of_shape), floor_name(name_of_floor);
      for (const bool is_link : {false, true}) {
        for (const bool meets : {false, true}) {
          CAPTURE(shape_name);
          CAPTURE(floor_name);
          CAPTURE(is_link);
          CAPTURE(meets);
          const auto world =
              dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -10}, .step_s = kStep_s, .iterations = 50});
          BodyDesc ground{.kind = BodyKind::fixed, .shapes = floor_shapes};
          ground.surface.mask = kOne;
          const std::size_t floor = world->add_body(ground);
          glm::dmat4 pose(1.0);
          pose[3] = {0.013, 0.007, 0.3, 1};
          const MassProperties mass{.mass_kg = 1, .inertia_kg_m2 = glm::dmat3(0.01)};
          const SurfaceProperties surface{.mask = meets ? kMeeting : kPassing};
          std::size_t body = 0;
          if (is_link) {
            body = world->add_articulation(
                {.fixed_base = false, .world_from_base = pose, .mass = mass, .shapes = shapes, .surface = surface});
          } else {
            body = world->add_body({.world_from_body = pose, .mass = mass, .shapes = shapes, .surface = surface});
          }
          for (int i = 0; i < kSteps; ++i) REQUIRE_FALSE(world->step());
          const double z = world->state(body).world_from_body[3].z;
          // Semi-implicit steps fall by g t (t + h) / 2.
          const double time_s = kSteps * kStep_s, fallen = 0.3 - 5 * time_s * (time_s + kStep_s);
          if (!meets) CHECK(z == doctest::Approx(fallen).epsilon(1e-9));
          if (meets) CHECK(z > 0);
          CHECK(world->contacts().empty() == !meets);
          world->remove(floor);
          ++tried;
        }
      }
    }
  }
  CHECK(tried == std::size_t{6 * 4 * 2 * 2});
}

TEST_CASE("of a body with several shapes, each has its own mask") {
  // A table whose plate is not met, and whose legs are.
  const auto world = dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -10}, .step_s = kStep_s, .iterations = 50});
  CollisionShape plate{.kind = CollisionKind::box, .half_m = {0.5, 0.5, 0.05}}, leg = plate;
  plate.body_from_shape[3] = {0, 0, 1, 1};
  plate.surface = SurfaceProperties{.mask = {.category = 2, .collides = 2}};
  leg.body_from_shape[3] = {0, 0, 0.05, 1};
  world->add_body({.kind = BodyKind::fixed, .shapes = {plate, leg}});
  glm::dmat4 pose(1.0);
  pose[3] = {0, 0, 1.5, 1};
  const std::size_t ball = world->add_body({.world_from_body = pose,
                                            .mass = {.mass_kg = 1, .inertia_kg_m2 = glm::dmat3(0.004)},
                                            .shapes = {{.kind = CollisionKind::sphere, .half_m = glm::dvec3(0.1)}},
                                            .surface = {.mask = {.category = 1, .collides = 1}}});
  for (int i = 0; i < 2000; ++i) REQUIRE_FALSE(world->step());
  CHECK(std::abs(world->state(ball).world_from_body[3].z - 0.2) < 1e-3);
}

// Two fingers slide towards each other by 1 N along y; the right one holds a tip 0.3 m in front of it by a weld.
MovingScene welded_fingers(const std::string& contact) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "m.xml")
      << "<mujoco><option timestep='0.001'/><worldbody><body name='palm'><geom type='box' size='1 1 0.1'/>"
         "<body name='left' pos='0 -1 0.5'><joint name='l' type='slide' axis='0 1 0' damping='20'/>"
         "<geom type='box' size='0.1 0.1 0.1' mass='1'/></body>"
         "<body name='right' pos='0 1 0.5'><joint name='r' type='slide' axis='0 -1 0' damping='20'/>"
         "<geom type='box' size='0.1 0.1 0.1' mass='1'/><body name='tip' pos='0 -0.3 0'>"
         "<geom type='box' size='0.1 0.1 0.1' mass='1'/></body></body></body></worldbody><actuator>"
         "<motor joint='l'/><motor joint='r'/></actuator>" +
             contact + "</mujoco>";
  MovingScene scene("<part name='M' insert_at='ROOT' file='m.xml'/>\n" + physics("world='M'") +
                        "<element type='models' name='BODIES' insert_at='M'/>",
                    folder.path());
  for (const char* target : {"target_l", "target_r"}) scene.set("BODIES", target, 10);
  scene.run(0, 4, 0.1);
  return scene;
}

TEST_CASE("an exclusion holds for the bodies that it names, not for what is welded to them") {
  // Left and right together go 2 m less the widths of what meets: with the tip first, 2 - 0.3 - 0.2; without, 2 - 0.2.
  const auto way = [](const std::string& pairs) {
    MovingScene scene = welded_fingers("<contact>" + pairs + "</contact>");
    return scene.get("l", "value") + scene.get("r", "value");
  };
  const std::string tip = "<exclude body1='left' body2='tip'/>", right = "<exclude body1='right' body2='left'/>";
  CHECK(std::abs(way(right) - 1.5) < 2e-3);
  CHECK(std::abs(way(tip) - 1.8) < 2e-3);
  CHECK(way(tip + right) > 2.5);
}

TEST_CASE("a body and what is welded to its parent stay apart, as a body and its parent") {
  // Two hinges between them do not make a body a grandchild. All geoms overlap; without gravity nothing may move.
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "m.xml")
      << "<mujoco><option gravity='0 0 0'/><worldbody><body name='base' pos='0 0 1'><freejoint/>"
         "<geom size='0.1' mass='1'/><body name='welded'><geom size='0.1' mass='1'/><body name='arm'>"
         "<joint name='a' axis='1 0 0'/><joint name='b' axis='0 1 0'/><geom size='0.1' mass='1'/>"
         "<body name='cap'><geom size='0.1' mass='1'/></body></body></body></body></worldbody></mujoco>";
  MovingScene scene("<part name='M' insert_at='ROOT' file='m.xml'/>\n" + physics("world='M'") +
                        "<element type='models' name='BODIES' insert_at='M'/>",
                    folder.path());
  CHECK((*scene).scene.warnings().empty());
  CHECK(touching_bodies(scene).empty());
}

TEST_CASE("a mask that cannot be read is an error with its place") {
  struct Row {
    const char *text, *seen;
  };
  for (const Row& row : {Row{"two", "\"two\""}, Row{"1.5", "\"1.5\""}, Row{"4294967296", "\"4294967296\""},
                         Row{"0x", "\"0x\""}, Row{"1 2", "\"1 2\""}, Row{"-2147483649", "\"-2147483649\""}}) {
    CAPTURE(row.text);
    CHECK_FALSE(parse_bitmask(row.text));
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "m.xml")
        << "<mujoco><worldbody>\n<geom size='1' contype='" << row.text << "'/></worldbody></mujoco>";
    const std::string error = error_of([&] {
      MovingScene("<part name='M' insert_at='ROOT' file='m.xml'/>\n" + physics("world='M'") +
                      "<element type='models' name='BODIES' insert_at='M'/>",
                  folder.path());
    });
    CHECK(contains(error, "m.xml:2:"));
    CHECK(contains(error, std::string("has contype ") + row.seen + ", expected a whole number"));
  }
  for (const auto& [written, value] : std::vector<std::pair<std::string, std::uint32_t>>{{"0", 0},
                                                                                         {" 7 ", 7},
                                                                                         {"-1", 0xFFFFFFFF},
                                                                                         {"4294967295", 0xFFFFFFFF},
                                                                                         {"0xfF", 255},
                                                                                         {"-2147483648", 1u << 31}}) {
    const std::string text = written;
    CAPTURE(text);
    CHECK(parse_bitmask(text) == value);
  }
}

// A cube of 1 m that falls from 1 m above a floor, both with a text of <surface>.
MovingScene masked_world(const std::string& floor, const std::string& cube) {
  const TemporaryFolder folder;
  const auto link = [](const std::string& surface) {
    return "<link name='l'><visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual>\n"
           "<collision name='c'><geometry><box><size>1 1 1</size></box></geometry><surface><contact>" +
           surface + "</contact></surface></collision></link>";
  };
  std::ofstream(folder.path() / "w.sdf")
      << "<sdf version='1.9'><world name='w'><model name='floor'><static>1</static>" + link(floor) +
             "</model><model name='cube'><pose>0 0 2 0 0 0</pose>" + link(cube) + "</model></world></sdf>";
  MovingScene scene("<part name='W' insert_at='ROOT' file='w.sdf'/>\n" + physics("world='W'") +
                        "<element type='models' name='BODIES' insert_at='W'/>",
                    folder.path());
  scene.run(0, 1, 0.1);
  return scene;
}

TEST_CASE("SDF has masks by <collide_bitmask> and <category_bitmask>") {
  struct Row {
    const char *floor, *cube;
    bool collide;
  };
  const std::vector<Row> rows = {
      {"", "", true},
      {"<collide_bitmask>1</collide_bitmask>", "", true},
      {"<collide_bitmask>1</collide_bitmask>", "<collide_bitmask>2</collide_bitmask>", false},
      {"<collide_bitmask>0x03</collide_bitmask>", "<collide_bitmask>2</collide_bitmask>", true},
      {"<collide_bitmask>0</collide_bitmask>", "", false},
      {"<category_bitmask>4</category_bitmask><collide_bitmask>1</collide_bitmask>",
       "<collide_bitmask>2</collide_bitmask>", false},
      {"<category_bitmask>4</category_bitmask><collide_bitmask>1</collide_bitmask>",
       "<category_bitmask>2</category_bitmask><collide_bitmask>4</collide_bitmask>", true}};
  for (const Row& row : rows) {
    CAPTURE(row.floor);
    CAPTURE(row.cube);
    MovingScene scene = masked_world(row.floor, row.cube);
    CHECK((scene.position("cube/l").z > 0.9) == row.collide);
    CHECK((scene.position("cube/l").z < 0) == !row.collide);
  }
  MovingScene wrong = masked_world("<collide_bitmask>all</collide_bitmask>", "");
  CHECK(std::ranges::any_of((*wrong).scene.warnings(), [](const std::string& warning) {
    return contains(warning, "w.sdf:2:") &&
           contains(warning, "<collide_bitmask> is \"all\", expected a whole number") &&
           contains(warning, "a collision of link \"l\" is left out");
  }));
}

TEST_CASE("bodies of a scene have masks, each with its own kind of element") {
  struct Row {
    const char *floor, *body;
    bool collide;
  };
  for (const Row& row :
       {Row{"", "", true}, Row{"collide_bitmask='1'", "", true},
        Row{"collide_bitmask='1'", "collide_bitmask='2'", false}, Row{"collide_bitmask='0'", "", false},
        Row{"category_bitmask='8' collide_bitmask='0'", "collide_bitmask='12'", true},
        Row{"category_bitmask='8' collide_bitmask='0'", "collide_bitmask='7'", false}}) {
    CAPTURE(row.floor);
    CAPTURE(row.body);
    for (const std::string element : {"body", "vehicle"}) {
      CAPTURE(element);
      const bool is_vehicle = element == "vehicle";
      MovingScene scene(kPhysics + ground(row.floor) +
                        "<part name='B' insert_at='ROOT' shape='box' size='0.4 0.2 0.2' pose_offset='0 0 0.3 0 0 0'/>\n"
                        "<element type='" +
                        element + "' name='E' insert_at='B' mass='1' " +
                        (is_vehicle ? "wheel_radius='0.05' track='0.3' clearance='0.02' " : "") + row.body + "/>");
      scene.run(0, 1, 0.1);
      CHECK((scene.position("B").z > -0.1) == row.collide);
      CHECK((scene.position("B").z < -1) == !row.collide);
    }
  }
  CHECK(contains(error_of([] { MovingScene(kPhysics + ground("collide_bitmask='4294967296'")); }), "4294967295"));
  CHECK(contains(error_of([] { MovingScene(kPhysics + ground("collide_bitmask='-1'")); }), "collide_bitmask"));
}

// Two fingers at a palm that overlap when both have gone 0.4 m; the tip of the right one is in front of it.
const char* const kFingersUrdf = R"(<robot name="hand">
<link name="palm">
<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="left"><visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="right"><visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tip"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
<joint name="l" type="prismatic"><parent link="palm"/><child link="left"/><origin xyz="0 -1 0"/><axis xyz="0 1 0"/>
<limit lower="-5" upper="5" effort="50" velocity="1"/></joint>
<joint name="r" type="prismatic"><parent link="palm"/><child link="right"/><origin xyz="0 1 0"/><axis xyz="0 -1 0"/>
<limit lower="-5" upper="5" effort="50" velocity="1"/></joint>
<joint name="weld" type="fixed"><parent link="right"/><child link="tip"/><origin xyz="0 -0.3 0"/></joint>
</robot>)";

MovingScene srdf_scene(const std::string& srdf, const std::string& element = "robot",
                       const std::string& attribute = "srdf='hand.srdf'") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "hand.urdf") << kFingersUrdf;
  std::ofstream(folder.path() / "hand.srdf") << srdf;
  const std::string control = element == "robot" ? "control='velocity' " : "";
  MovingScene scene(kPhysics +
                        "<part name='R' insert_at='ROOT' file='hand.urdf' pose_offset='0 0 2 0 0 0'/>\n"
                        "<element type='" +
                        element + "' name='HAND' insert_at='R' " + control + attribute + "/>",
                    folder.path());
  return scene;
}

// How far both fingers go together before they meet; without a meeting 3 m.
double finger_way(const std::string& srdf, const std::string& attribute = "srdf='hand.srdf'") {
  MovingScene scene = srdf_scene(srdf, "robot", attribute);
  scene.set("HAND", "target_l", 0.5);
  scene.set("HAND", "target_r", 0.5);
  scene.run(0, 3, 0.1);
  return scene.get("l", "value") + scene.get("r", "value");
}

TEST_CASE("links of a URDF robot collide except for the pairs that its SRDF disables") {
  const auto robot = [](const std::string& content) { return "<robot name='hand'>\n" + content + "</robot>"; };
  const std::string left_tip = "<disable_collisions link1='tip' link2='left' reason='Never'/>",
                    left_right = "<disable_collisions link1='left' link2='right' reason='Never'/>";
  constexpr double kMeeting_m = 5e-3;  // two drives of 50 N press against each other
  CHECK(finger_way("", "") > 2.9);     // without an SRDF no links of a robot collide
  CHECK(std::abs(finger_way(robot("")) - 1.5) < kMeeting_m);
  CHECK(std::abs(finger_way(robot(left_right)) - 1.5) < kMeeting_m);
  CHECK(std::abs(finger_way(robot(left_tip)) - 1.8) < kMeeting_m);
  CHECK(finger_way(robot(left_tip + left_right)) > 2.9);
  const std::string none = "<disable_default_collisions link='left'/>";
  CHECK(finger_way(robot(none)) > 2.9);
  CHECK(std::abs(finger_way(robot(none + "<enable_collisions link1='right' link2='left'/>")) - 1.8) < kMeeting_m);
}

TEST_CASE("an SRDF file with mistakes is an error, and an unknown link a warning, each with its place") {
  const auto error = [](const std::string& srdf, const std::string& element) {
    return error_of([&] { srdf_scene(srdf, element); });
  };
  for (const std::string element : {"robot", "models"}) {
    CAPTURE(element);
    CHECK(contains(error("<sdf/>", element), "hand.srdf:1:2: error: element <sdf> is the root, expected <robot>"));
    CHECK(contains(error("<robot>\n<disable_collisions link1='left'/></robot>", element),
                   "hand.srdf:2:2: error: element <disable_collisions> has no attribute \"link2\""));
    CHECK(contains(error("<robot>", element), "hand.srdf:1:"));
    CHECK(contains(error_of([&] { srdf_scene("", element, "srdf='absent.srdf'"); }), "s.xml:3:"));
    MovingScene scene = srdf_scene("<robot>\n<disable_collisions link1='leftt' link2='right'/></robot>", element);
    CHECK(std::ranges::any_of((*scene).scene.warnings(), [](const std::string& warning) {
      return contains(warning, "hand.srdf:2:2: element <disable_collisions> names the link \"leftt\"") &&
             contains(warning, "did you mean \"left\"?; it is left out");
    }));
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
