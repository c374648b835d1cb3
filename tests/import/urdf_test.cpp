// URDF robots as parts: links, joints and visuals compared with the numbers in the file, and all errors.
#include <doctest/doctest.h>

#include <array>
#include <clocale>
#include <cmath>
#include <locale>
#include <numbers>
#include <string>

#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "engine/base/srgb.h"
#include "scenegraph/flattener.h"
#include "scenegraph/primitive_meshes.h"
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

constexpr const char* kLimit =
    R"(<limit lower="-1.5707963267948966" upper="3.141592653589793" effort="1" velocity="1"/>)";
constexpr const char* kBox = R"(<visual><geometry><box size="1 2 3"/></geometry></visual>)";

std::string error(const std::string& content) {
  return error_of([&] { UrdfScene scene(content); });
}

// Products of a few matrices of numbers near 1, each converted from a quaternion: about 30 roundings of half an ulp.
constexpr double kRoundings = 30 * 0x1p-53;

void check_near(const glm::dmat4& a, const glm::dmat4& b) {
  double worst = 0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) worst = std::max(worst, std::abs(a[column][row] - b[column][row]));
  }
  CHECK(worst <= kRoundings);
}

}  // namespace

TEST_CASE("joints: kinds, axes, limits in degrees, and initial values within them") {
  UrdfScene scene(link_xml("base") + link_xml("a") + link_xml("b") + link_xml("c") + link_xml("d") + link_xml("e") +
                  joint_xml("turn", "revolute", "base", "a", std::string(R"(<axis xyz="0 0 2"/>)") + kLimit) +
                  joint_xml("spin", "continuous", "a", "b", R"(<axis xyz="0 1 0"/>)") +
                  joint_xml("slide", "prismatic", "b", "c",
                            R"(<axis xyz="1 0 0"/><limit lower="0.25" upper="0.5" effort="1" velocity="1"/>)") +
                  joint_xml("weld", "fixed", "c", "d") + joint_xml("free", "floating", "d", "e"));
  const Parameters& parameters = scene.built().parameters;
  REQUIRE(parameters.elements().size() == 4);
  CHECK(parameters.elements()[0].name == "turn");
  CHECK(parameters.elements()[0].parameters[0].min == -90);
  CHECK(parameters.elements()[0].parameters[0].max == 180);
  CHECK(parameters.values()[parameters.index("turn", "value")] == 0);
  CHECK(parameters.elements()[1].parameters[0].min == -kMaxCoordinate_m);
  CHECK(parameters.elements()[2].parameters[0].unit == "m");
  CHECK(parameters.values()[parameters.index("slide", "value")] == 0.25);
  CHECK(parameters.elements()[3].type == "pose");
  CHECK(scene.built().scene.has_insertion_point("base"));
  CHECK(scene.built().scene.has_insertion_point("e"));
}

TEST_CASE("an arm of nested joints is placed by the product of its matrices and moves with its values") {
  const std::string first = R"(<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/><axis xyz="0 0 1"/>)";
  const std::string second = R"(<origin xyz="0 0 0.5" rpy="-0.4 0 0"/><axis xyz="0 1 0"/>)";
  UrdfScene scene(
      link_xml("base", kBox) + link_xml("a", kBox) +
      link_xml("b",
               R"(<visual><origin xyz="0 0 1" rpy="0 0 0.5"/><geometry><sphere radius="1"/></geometry></visual>)") +
      joint_xml("j1", "continuous", "base", "a", first) + joint_xml("j2", "continuous", "a", "b", second));
  const auto pose = [](const glm::dvec3& at, double roll, double pitch, double yaw) {
    return to_matrix({.position_m = at, .roll_rad = roll, .pitch_rad = pitch, .yaw_rad = yaw});
  };
  const auto expected_a = [&](double j1) {
    return pose({1, 2, 3}, 0.1, 0.2, 0.3) * matrix_from_degrees({0, 0, 0}, 0, 0, j1);
  };
  const auto expected_b = [&](double j1, double j2) {
    return expected_a(j1) * pose({0, 0, 0.5}, -0.4, 0, 0) * matrix_from_degrees({0, 0, 0}, 0, j2, 0) *
           pose({0, 0, 1}, 0, 0, 0.5);
  };
  CHECK(scene.place(0) == glm::dmat4(1));
  check_near(scene.place(1), expected_a(0));
  check_near(scene.place(2), expected_b(0, 0));
  scene.set("j1", 35);
  scene.set("j2", -110);
  CHECK(scene.place(0) == glm::dmat4(1));
  check_near(scene.place(1), expected_a(35));
  check_near(scene.place(2), expected_b(35, -110));
}

TEST_CASE("parts inserted at a link move with it; two robots of one file do not conflict") {
  UrdfScene scene(
      link_xml("base") + link_xml("hand") + joint_xml("j", "continuous", "base", "hand", R"(<axis xyz="0 0 1"/>)"),
      "<part file='r.urdf' name='R2' insert_at='ROBOT/hand' pose_offset='1 0 0 0 0 0'/>"
      "<part file='r.urdf' name='R3' insert_at='R2/hand' pose_offset='1 0 0 0 0 0'/>"
      "<sensor type='camera' name='CAM' insert_at='R3/hand'/>");
  scene.set("ROBOT/j", 90);
  scene.set("R2/j", -90);
  Flattener flattener(scene.built().scene.root());
  flattener.update();
  glm::dmat4 world{0.0};
  REQUIRE(flattener.find_mount(*scene.built().sensors.at(0).mount, world));
  check_near(world, matrix_from_degrees({1, 1, 0}, 0, 0, 0));
}

TEST_CASE("mimic joints: radians become degrees, kinds are mixed, chains of mimics are followed to their end") {
  const std::string x = R"(<axis xyz="1 0 0"/>)";
  UrdfScene scene(
      link_xml("base") + link_xml("a") + link_xml("b", kBox) + link_xml("c", kBox) + link_xml("d", kBox) +
      joint_xml("b", "revolute", "base", "b",
                x + kLimit + R"(<mimic joint="a" multiplier="-2" offset="1.5707963267948966"/>)") +
      joint_xml("a", "continuous", "base", "a", x) +
      joint_xml("c", "prismatic", "base", "c",
                x + R"(<limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="a" multiplier="0.5"/>)") +
      joint_xml("d", "revolute", "base", "d", x + kLimit + R"(<mimic joint="b" multiplier="3"/>)"));
  scene.set("a", 20);
  check_near(scene.place(0), matrix_from_degrees({0, 0, 0}, 90 - 2 * 20, 0, 0));
  check_near(scene.place(1), matrix_from_degrees({0.5 * 20 * std::numbers::pi / 180, 0, 0}, 0, 0, 0));
  check_near(scene.place(2), matrix_from_degrees({0, 0, 0}, 3 * (90 - 2 * 20), 0, 0));
}

TEST_CASE("planar and floating joints") {
  UrdfScene scene(link_xml("base") + link_xml("a", kBox) + link_xml("b", kBox) +
                  joint_xml("p", "planar", "base", "a", R"(<axis xyz="0 0 1"/>)") +
                  joint_xml("q", "floating", "base", "b"));
  scene.set("p_X", 1);
  scene.set("p_Y", 2);
  scene.set("p_TURN", 30);
  scene.set("q", 4, "z");
  scene.set("q", 10, "pitch");
  check_near(scene.place(0), matrix_from_degrees({1, 2, 0}, 0, 0, 30));
  check_near(scene.place(1), matrix_from_degrees({0, 0, 4}, 0, 10, 0));
}

TEST_CASE("solids: triangles, bounds, and surfaces within the error of their flat sides") {
  UrdfScene scene(link_xml("base", std::string(kBox) +
                                       R"(<visual><geometry><cylinder radius="0.5" length="2"/></geometry></visual>)"
                                       R"(<visual><geometry><sphere radius="2"/></geometry></visual>)"
                                       R"(<collision><geometry><sphere radius="9"/></geometry></collision>)"));
  const DrawList& list = scene.list();
  REQUIRE(list.items.size() == 3);
  const auto surface = [&](std::size_t i) {
    const Mesh& mesh = *list.meshes[list.items[i].mesh];
    double total = 0;
    for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
      std::array<glm::dvec3, 3> p;
      glm::dvec3 normals{0};
      for (std::size_t c = 0; c < 3; ++c) {
        p[c] = mesh.positions[mesh.indices[k + c]];
        normals += glm::dvec3(mesh.attributes[mesh.indices[k + c]].normal);
      }
      const glm::dvec3 area = glm::cross(p[1] - p[0], p[2] - p[0]) / 2.0;
      CHECK(glm::length(area) > 0);
      CHECK(glm::dot(area, normals) > 0);             // normals point to the side that it runs counter-clockwise from
      CHECK(glm::dot(area, p[0] + p[1] + p[2]) > 0);  // and that is the outside
      total += glm::length(area);
    }
    return total;
  };
  CHECK(list.meshes[list.items[0].mesh]->bounds_max == glm::vec3(0.5, 1, 1.5));
  CHECK(surface(0) == 22);
  CHECK(list.meshes[list.items[1].mesh]->bounds_min == glm::vec3(-0.5, -0.5, -1));
  CHECK(list.meshes[list.items[2].mesh]->bounds_max.z == 2);
  // A polygon of n sides within a circle has sin(x)/x of its length and area, with x = pi / n and 2 pi / n. A sphere of
  // such rings has at least the square of that.
  const double x = 2 * std::numbers::pi / kSidesAround, least = std::sin(x) / x;
  const double cylinder = 2 * std::numbers::pi * 0.5 * (0.5 + 2), sphere = 4 * std::numbers::pi * 4;
  CHECK(surface(1) < cylinder);
  CHECK(surface(1) > cylinder * least);
  CHECK(surface(2) < sphere);
  CHECK(surface(2) > sphere * least * least);
}

TEST_CASE("materials: of a visual, by name for the whole robot, with a picture; those of a mesh come first") {
  TemporaryFolder folder;
  std::filesystem::create_directories(folder / "my_robot/urdf");
  std::filesystem::create_directories(folder / "my_robot/meshes");
  std::filesystem::create_directories(folder / "other/meshes");
  write_bytes(folder / "my_robot/meshes/dots.png", png(1, 1, 8, 2, {{255, 0, 0}}));
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  write_text(folder / "my_robot/meshes/bare.obj", triangle + "f 1 2 3\n");
  write_text(folder / "other/meshes/a.mtl", "newmtl m\nKd 0 1 0\n");
  write_text(folder / "other/meshes/own.obj", "mtllib a.mtl\nusemtl m\n" + triangle + "f 1 2 3\n");
  const auto visual = [](const std::string& geometry, const std::string& material) {
    return "<visual><geometry>" + geometry + "</geometry>" + material + "</visual>";
  };
  const std::string bare = R"(<mesh filename="package://my_robot/meshes/bare.obj" scale="2 -3 4"/>)";
  write_text(
      folder / "my_robot/urdf/r.urdf",
      robot(R"(<material name="glass"><color rgba="0.5 0 1 0.25"/></material>)" +
            link_xml("base",
                     visual(bare, R"(<material name="glass"/>)") +
                         visual(R"(<mesh filename="package://other/meshes/own.obj"/>)", R"(<material name="glass"/>)") +
                         visual(R"(<mesh filename="../meshes/bare.obj"/>)",
                                R"(<material name="p"><texture filename="../meshes/dots.png"/></material>)") +
                         visual(R"(<box size="1 1 1"/>)", ""))));
  BuiltScene built =
      build_scene(parse_commands("<part file='my_robot/urdf/r.urdf' name='R' insert_at='ROOT'/>", "s", folder.path()));
  built.scene.read_pictures();
  Flattener flattener(built.scene.root());
  const DrawList& list = flattener.update();
  REQUIRE(list.items.size() == 4);
  const auto material = [&](std::size_t i) { return *list.materials[list.items[i].material]; };
  CHECK(material(0).base_color == glm::vec4(linear_from_srgb(0.5), 0, 1, 0.25));
  CHECK(material(0).alpha_mode == AlphaMode::blend);
  glm::dmat4 scaled{1.0};
  scaled[0][0] = 2;
  scaled[1][1] = -3;
  scaled[2][2] = 4;
  CHECK(list.world_from_node[list.items[0].transform] == scaled);
  CHECK(material(1).base_color == glm::vec4(0, 1, 0, 1));
  REQUIRE(material(2).base_color_texture != nullptr);
  CHECK(material(2).base_color == glm::vec4(1));
  CHECK(list.items[0].mesh == list.items[2].mesh);
  CHECK(material(3).base_color == glm::vec4(1));
}

TEST_CASE("errors in robots name the place of the joint or link") {
  const std::string two = link_xml("a") + link_xml("b");
  CHECK(contains(error("<link name=\"a\">"), "r.urdf:3:18: malformed XML"));
  CHECK(contains(error(""), "has no link"));
  CHECK(contains(error(two), "r.urdf:4:2: link \"b\" has no joint above it, as link \"a\" has none"));
  CHECK(contains(error("<link name=\"a\"><visual>\n<origin xyz=\"0 1\"/><geometry><sphere radius=\"1\"/></geometry>"
                       "</visual></link>"),
                 "r.urdf:4:2: origin has xyz \"0 1\", expected 3 finite numbers"));
  CHECK(contains(error("<link name=\"a\"><visual>\n<geometry><sphere radius=\"big\"/></geometry></visual></link>"),
                 "r.urdf:4:12: sphere has radius \"big\", expected 1 finite number"));
  CHECK(contains(error(two + joint_xml("j", "fixed", "a", "b") + joint_xml("k", "fixed", "b", "a")),
                 "has a joint above each of its links, expected a root"));
  CHECK(contains(error(link_xml("r") + two + joint_xml("j", "fixed", "a", "b") + joint_xml("k", "fixed", "b", "a")),
                 "r.urdf:4:2: link \"a\" is in a cycle of joints"));
  CHECK(contains(error(link_xml("c") + two + joint_xml("j", "fixed", "c", "a") + joint_xml("k", "fixed", "c", "b") +
                       joint_xml("l", "fixed", "a", "b")),
                 "link \"b\" has two joints above it"));
  CHECK(contains(error(two + joint_xml("j", "fixed", "a", "c")),
                 "r.urdf:5:2: joint \"j\" has the child link \"c\", which is not there"));
  CHECK(contains(
      error(two + joint_xml("j", "hinge", "a", "b")),
      "joint \"j\" has the type \"hinge\", expected fixed, revolute, continuous, prismatic, floating or planar"));
  CHECK(contains(error(two + joint_xml("j", "continuous", "a", "b", R"(<axis xyz="0 0 0"/>)")),
                 "r.urdf:5:2: joint \"j\" has the axis 0 0 0"));
  CHECK(contains(error(two + joint_xml("j", "continuous", "a", "b", R"(<axis xyz="0 x 0"/>)")),
                 "axis has xyz \"0 x 0\", expected 3 finite numbers"));
  CHECK(contains(error(two + joint_xml("j", "continuous", "a", "b", R"(<origin xyz="1e300 0 0"/>)")),
                 "has an origin that is not allowed"));
}

TEST_CASE("what a robot lacks, or has twice, is told at its place") {
  const std::string two = link_xml("a") + link_xml("b"), fixed = joint_xml("j", "fixed", "a", "b");
  const auto looks = [](const std::string& visual) { return link_xml("a", "<visual>" + visual + "</visual>"); };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"<link/>", "3:2: link has an empty name"},
      {link_xml(" "), "3:2: link \" \" has an empty name"},
      {two + joint_xml("", "fixed", "a", "b"), "5:2: joint has an empty name"},
      {link_xml("a") + link_xml("a"), "4:2: link \"a\" is there twice"},
      {two + fixed + fixed, "6:2: joint \"j\" is there twice"},
      {two + joint_xml("j", "fixed", "a", ""), "5:2: joint \"j\" has no child link"},
      {two + joint_xml("j", "fixed", "x", "b"), "5:2: joint \"j\" has the parent link \"x\", which is not there"},
      {two + joint_xml("j", "fixed", "a", "a"), "3:2: link \"a\" is in a cycle of joints"},
      {two + joint_xml("j", "", "a", "b"), "5:2: joint \"j\" has the type \"\", expected"},
      {two + joint_xml("j", "revolute", "a", "b", R"(<limit lower="x"/>)"), "limit has lower \"x\", expected 1 finite"},
      {two + joint_xml("j", "continuous", "a", "b", "<mimic/>"), "mimic names no joint"},
      {looks(R"(<origin xyz="1 nan 3"/><geometry><box size="1 1 1"/></geometry>)"), "origin has xyz \"1 nan 3\""},
      {looks(R"(<origin rpy=""/><geometry><box size="1 1 1"/></geometry>)"), "origin has rpy \"\", expected 3"},
      {looks("<geometry><box/></geometry>"), "box has size \"\", expected 3 finite numbers"},
      {looks(R"(<geometry><cylinder radius="1"/></geometry>)"), "cylinder has length \"\", expected 1 finite number"}};
  for (const auto& [content, expected] : cases) {
    CAPTURE(content);
    CHECK(contains(error(content), expected));
  }
  const auto whole = [](const std::string& text) {
    return error_of([&] {
      const TemporaryFolder folder;
      write_text(folder / "r.urdf", text);
      ContentPool pool;
      import_part(folder / "r.urdf", pool);
    });
  };
  CHECK(contains(whole("<model/>"), "r.urdf:1:2: error: the element <model> is no robot, expected <robot>"));
  CHECK(contains(whole("<robot name='r' version='1.1'/>"), "r.urdf:1:2: error: robot \"r\" is of version \"1.1\""));
}

TEST_CASE("numbers with signs, tabs and line breaks") {
  UrdfScene scene(link_xml("a",
                           "<visual><origin xyz=\"+1&#9;-.5&#10;+1e2\"/><geometry><box size=\"1 1 1\"/></geometry>"
                           "</visual>"));
  CHECK(scene.place(0)[3] == glm::dvec4(1, -0.5, 100, 1));
  CHECK(contains(error(link_xml("a",
                                "<visual><origin xyz=\"+-1 0 0\"/><geometry><box size=\"1 1 1\"/></geometry>"
                                "</visual>")),
                 "origin has xyz \"+-1 0 0\""));
}

TEST_CASE("errors in mimics") {
  const auto mimics = [](const std::string& of_b, const std::string& of_c) {
    const auto mimic = [](const std::string& leader) {
      return R"(<axis xyz="1 0 0"/>)" + (leader.empty() ? "" : "<mimic joint=\"" + leader + "\"/>");
    };
    return error(link_xml("a") + link_xml("b") + link_xml("c") + joint_xml("jb", "continuous", "a", "b", mimic(of_b)) +
                 joint_xml("jc", "continuous", "a", "c", mimic(of_c)));
  };
  CHECK(contains(mimics("jc", "jb"), "joint \"jb\" mimics itself in a circle"));
  CHECK(contains(error(link_xml("a") + link_xml("b") + link_xml("c") + joint_xml("jb", "fixed", "a", "b") +
                       joint_xml("jc", "continuous", "a", "c", R"(<mimic joint="jb"/>)")),
                 "joint \"jc\" mimics joint \"jb\", which is not revolute, continuous or prismatic"));
}

TEST_CASE("a decimal comma in the locale of the process changes nothing") {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const std::string c_before = std::setlocale(LC_NUMERIC, nullptr);
  for (const char* name : {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_NUMERIC, name) != nullptr) break;
  }
  UrdfScene scene(link_xml("base") + link_xml("a", kBox) +
                  joint_xml("j", "fixed", "base", "a", R"(<origin xyz="1.5 -0.25 1e-3"/>)"));
  const glm::dmat4 place = scene.place(0);
  std::setlocale(LC_NUMERIC, c_before.c_str());
  std::locale::global(before);
  CHECK(place[3] == glm::dvec4(1.5, -0.25, 1e-3, 1));
}

TEST_CASE("truncated robots and robots with changed letters are loaded or refused") {
  constexpr int kFiles = 400;
  const std::string whole = robot(
      link_xml("base", kBox) + link_xml("a", kBox) + joint_xml("j", "revolute", "base", "a", kLimit) + link_xml("b") +
      joint_xml("k", "continuous", "a", "b", R"(<axis xyz="1 0 0"/><mimic joint="j" multiplier="2"/>)"));
  TemporaryFolder folder;
  std::uint64_t state = 7;
  const auto random_below = [&state](std::uint64_t end) {  // Knuth's MMIX generator: the same files everywhere
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (state >> 33) % end;
  };
  int loaded = 0;
  for (int i = 0; i < kFiles; ++i) {
    CAPTURE(i);
    std::string text = whole;
    if (i % 4 == 0) text.resize(random_below(text.size()));
    for (int flips = 0; i % 4 != 0 && flips < 1 + i % 3; ++flips) {
      text[random_below(text.size())] = static_cast<char>(' ' + random_below(95));
    }
    std::filesystem::remove(folder / "r.urdf");
    write_text(folder / "r.urdf", text);
    try {
      ContentPool pool;
      const PartContent content = find_part_importer("r.urdf")({.file = folder / "r.urdf"}, pool);
      REQUIRE(content.root != nullptr);
      ++loaded;
    } catch (const InputError& refused) {
      REQUIRE(std::string(refused.what()).starts_with((folder / "r.urdf").string()));
    }
  }
  MESSAGE(loaded << " of " << kFiles << " loaded");
  CHECK(loaded > 0);
  CHECK(loaded < kFiles / 2);
}

TEST_SUITE_END();
