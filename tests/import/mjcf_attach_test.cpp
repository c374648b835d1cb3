// MJCF models that are put together from others, joints in frames, and meshes by vertices alone.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include "import/mesh/convex_hull.h"
#include "scenegraph/primitive_meshes.h"
#include "tests/support/mjcf_scene.h"
#include "tests/support/python_package.h"
#include "tests/support/random_numbers.h"

TEST_SUITE_BEGIN("import");

namespace simvis::test {
namespace {

// In radians, with defaults and assets of its own, whose names the model around has too.
const char* const kKid =
    "<mujoco model='kid'><compiler angle='radian'/><default><geom rgba='1 0 0 1' size='0.1'/></default>"
    "<asset><material name='paint' rgba='0 1 0 1'/></asset>"
    "<worldbody><geom size='0.3'/><frame pos='0 0 1'><body name='a' pos='1 0 0' euler='0 0 1.5707963267948966'>"
    "<joint name='j' axis='0 1 0' range='-1 1'/><geom material='paint' rgba='0.5 0.5 0.5 1'/>"
    "<body name='b' pos='0 0 1'><joint name='k'/><geom/><site name='s'/></body></body></frame>"
    "<body name='c'><joint name='l'/><geom/></body></worldbody>"
    "<equality><joint joint1='k' joint2='j' polycoef='0 2'/></equality></mujoco>";

}  // namespace

// The places and names are those that MuJoCo 4.0 gives this model.
TEST_CASE("attached models bring bodies or all of their world, with their own units, defaults and assets") {
  MjcfScene scene(
      "<asset><model name='child' file='kid.xml'/><material name='paint' rgba='0 0 1 1'/></asset>" +
          mjcf_world("<frame pos='5 0 0' euler='0 0 90'><attach model='child' body='a' prefix='p_'/></frame>"
                     "<body name='B' pos='0 9 0'><attach model='child' prefix='q_'/></body><geom material='paint' "
                     "size='1'/>"),
      {{"kid.xml", kKid}});
  CHECK(scene.warnings().empty());
  check_place(scene.point("p_a"), {-1, 0, 0}, {0, -1, 0}, {5, 1, 0});
  check_place(scene.point("p_b"), {-1, 0, 0}, {0, -1, 0}, {5, 1, 1});
  check_place(scene.point("q_a"), {0, 1, 0}, {-1, 0, 0}, {1, 9, 1});
  check_place(scene.point("q_s"), {0, 1, 0}, {-1, 0, 0}, {1, 9, 2});
  check_place(scene.point("q_c"), {1, 0, 0}, {0, 1, 0}, {0, 9, 0});
  REQUIRE(scene.list().items.size() == 7);
  CHECK(scene.mesh(0).positions == sphere_mesh(0.1).positions);
  CHECK(scene.material(0).base_color == glm::vec4(0, 1, 0, 1));
  CHECK(scene.material(1).base_color == glm::vec4(1, 0, 0, 1));
  CHECK(scene.material(6).base_color == glm::vec4(0, 0, 1, 1));
  // The equality of each copy couples its own joints, and limits are those of radians.
  scene.set("q_j", 30);
  check_place(scene.point("p_b"), {-1, 0, 0}, {0, -1, 0}, {5, 1, 1});
  const double quarter = glm::radians(30.0), half = glm::radians(60.0);
  // q_a turns about its y, which is -x; then q_b about its z by twice the angle.
  const glm::dmat4 b = scene.point("q_b");
  CHECK(glm::length(glm::dvec3(b[3]) - glm::dvec3(1, 9 + std::sin(quarter), 1 + std::cos(quarter))) < kMjcfPlace);
  CHECK(std::abs(b[0].x - -std::sin(half)) < kMjcfPlace);
  CHECK_THROWS_AS(scene.set("p_j", 58), InputError);
}

TEST_CASE("a model asset without a name has that of its model, and models attach further ones") {
  MjcfScene scene("<asset><model file='sub/mid.xml'/></asset>" +
                      mjcf_world("<attach model='mid' prefix='m_'/><replicate count='2' offset='0 3 0'>"
                                 "<attach model='mid' body='arm' prefix='r_'/></replicate>"),
                  {{"sub/mid.xml",
                    "<mujoco model='mid'><asset><model name='kid' file='kid.xml'/></asset><worldbody><body name='arm' "
                    "pos='2 0 0'><attach model='kid' body='c' prefix='k_'/></body></worldbody></mujoco>"},
                   {"sub/kid.xml", kKid}});
  CHECK(scene.warnings().empty());
  check_place(scene.point("m_k_c"), {1, 0, 0}, {0, 1, 0}, {2, 0, 0});
  check_place(scene.point("r_k_c1"), {1, 0, 0}, {0, 1, 0}, {2, 3, 0});
  scene.set("m_k_l", 90);
  check_place(scene.point("m_k_c"), {0, 1, 0}, {-1, 0, 0}, {2, 0, 0});
}

TEST_CASE("attachments that name nothing are refused with their place") {
  const auto error = [](const std::string& attach, const std::string& asset = "<model name='k' file='kid.xml'/>") {
    return mjcf_error("<asset>" + asset + "</asset>" + mjcf_world(attach), {{"kid.xml", kKid}});
  };
  CHECK(
      contains(error("<attach model='x' prefix='p'/>"), "element <attach> names the model \"x\", which is not there"));
  CHECK(
      contains(error("<attach model='k' body='x' prefix='p'/>"), "names the body \"x\", which kid.xml does not have"));
  CHECK(contains(error("<attach model='k' prefix='p'/>", "<model name='k' file='no.xml'/>"),
                 "element <model> names a file that is not there: \"no.xml\""));
  CHECK(contains(error("<attach model='k' prefix='p'/>", "<model name='k' file='m.xml'/>"), "attach itself"));
  // Each model attaches the next one ten times.
  std::map<std::string, std::string> files;
  for (int i = 1; i <= 7; ++i) {
    std::string ten;
    for (int k = 0; k < 10; ++k) ten += "<attach model='n' prefix='" + std::to_string(k) + "'/>";
    files["n" + std::to_string(i) + ".xml"] = i == 7
                                                  ? "<mujoco><worldbody><site/></worldbody></mujoco>"
                                                  : "<mujoco><asset><model name='n' file='n" + std::to_string(i + 1) +
                                                        ".xml'/></asset><worldbody>" + ten + "</worldbody></mujoco>";
  }
  CHECK(contains(
      mjcf_error("<asset><model name='n' file='n1.xml'/></asset>" + mjcf_world("<attach model='n' prefix='x'/>"),
                 files),
      "is one of more than 10000 attachments"));
}

// The anchor and the axis are those that MuJoCo 4.0 gives this model.
TEST_CASE("joints in frames belong to the body around") {
  MjcfScene scene(
      mjcf_world("<body name='x'><frame pos='1 0 0' euler='0 0 90'><joint name='j' axis='1 0 0' "
                 "pos='0.5 0 0'/><geom size='1'/></frame></body>"));
  CHECK(scene.warnings().empty());
  scene.set("j", 90);
  // About y through (1, 0.5, 0).
  check_place(scene.point("x"), {0, 0, -1}, {0, 1, 0}, {1, 0, 1});
}

// The conversion to radians and back rounds twice: 60 degrees become 59.99999999999999.
TEST_CASE("limits in degrees come back as the degrees that a file says") {
  for (const std::string range : {"-33 37", "-90 60", "0.1 179.3"}) {
    CAPTURE(range);
    MjcfScene scene(mjcf_world("<body><joint name='j' range='" + range + "'/><geom size='1'/></body>"));
    const auto [low, high] = scene.limits("j");
    CHECK(format_number(low) + " " + format_number(high) == range);
    CHECK(scene.value("j", "value") == std::max(low, 0.0));
  }
}

namespace {

double volume_of(const std::vector<glm::dvec3>& points, const std::vector<std::uint32_t>& hull) {
  double volume = 0;
  for (std::size_t i = 0; i < hull.size(); i += 3) {
    volume += glm::dot(points[hull[i]], glm::cross(points[hull[i + 1]], points[hull[i + 2]])) / 6;
  }
  return volume;
}

// How far a point lies outside of a face at most, and whether each edge has one triangle on each side.
std::pair<double, bool> check_hull(const std::vector<glm::dvec3>& points, const std::vector<std::uint32_t>& hull) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  double outside = 0;
  for (std::size_t i = 0; i < hull.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) edges.insert({hull[i + k], hull[i + (k + 1) % 3]});
    const glm::dvec3 across = glm::cross(points[hull[i + 1]] - points[hull[i]], points[hull[i + 2]] - points[hull[i]]);
    if (!(glm::length(across) > 0)) continue;
    for (const glm::dvec3& point : points) {
      outside = std::max(outside, glm::dot(glm::normalize(across), point - points[hull[i]]));
    }
  }
  bool is_closed = edges.size() == hull.size();
  for (const auto& [from, to] : edges) is_closed = is_closed && edges.contains({to, from});
  return {outside, is_closed};
}

constexpr double kHullTolerance = 1e-10;  // of the size, see convex_hull.h

// From 0 to 1.
glm::dvec3 random_point(Random& random) {
  constexpr std::uint64_t kSteps = std::uint64_t{1} << 40;
  const auto next = [&] { return static_cast<double>(random.below(kSteps)) / kSteps; };
  const double x = next(), y = next(), z = next();
  return {x, y, z};
}

}  // namespace

TEST_CASE("a convex hull is closed, holds all points and has the volume of the shape") {
  // The corners of a cube twice, and points on its sides, edges and within.
  std::vector<glm::dvec3> cube;
  for (int i = 0; i < 125; ++i) cube.emplace_back(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
  cube.insert(cube.end(), cube.begin(), cube.begin() + 30);
  const std::vector<std::uint32_t> hull = convex_hull(cube).value();
  CHECK(volume_of(cube, hull) == doctest::Approx(64).epsilon(1e-12));
  CHECK(check_hull(cube, hull).first < 7 * kHullTolerance);
  CHECK(check_hull(cube, hull).second);

  std::vector<glm::dvec3> ball;
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    ball.push_back(glm::normalize(random_point(random) - 0.5) + glm::dvec3(1e3, 0, 0));
  }
  const std::vector<std::uint32_t> round = convex_hull(ball).value();
  CHECK(round.size() == 3 * (2 * ball.size() - 4));  // every point is a corner: Euler
  CHECK(check_hull(ball, round).first < 2 * kHullTolerance);
  CHECK(check_hull(ball, round).second);

  CHECK(convex_hull(std::vector<glm::dvec3>(5, glm::dvec3(1))).value().empty());
  std::vector<glm::dvec3> flat;
  for (int i = 0; i < 20; ++i) flat.emplace_back(i % 4, i / 4, 0.5 * (i % 4));
  CHECK(convex_hull(flat).value().empty());
}

// Each point of one circle sees all faces at the other one, so that the work grows with the square of their number.
TEST_CASE("a convex hull that takes too much work is given up") {
  std::vector<glm::dvec3> circles;
  constexpr int kPoints = 4000;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * std::numbers::pi * i / kPoints, c = std::cos(angle), s = std::sin(angle);
    circles.push_back(i % 2 == 0 ? glm::dvec3(2, c, s) : glm::dvec3(c, s, 0));
  }
  CHECK(convex_hull(circles).has_value());
  CHECK_FALSE(convex_hull(circles, std::size_t{kPoints} * kPoints / 16).has_value());
}

namespace {

const char* const kMassScript = "import sys, mujoco\nprint(mujoco.MjModel.from_xml_path(sys.argv[1]).body_mass[1])";

}  // namespace

TEST_CASE("vertices without faces are their convex hull, as in MuJoCo") {
  const std::string shown = mjcf_world("<body name='b'><freejoint/><geom type='mesh' mesh='m' density='1'/></body>");
  // A file of vertices alone is their hull, too.
  MjcfScene file("<asset><mesh name='m' file='m.obj'/></asset>" + shown,
                 {{"m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 2\nv 0.1 0.1 0.1\n"}});
  CHECK(file.mesh(0).indices.size() == 4 * 3);
  CHECK(file.mesh(0).bounds_max == glm::vec3(1, 1, 2));
  CHECK(contains(mjcf_error("<asset><mesh name='m' file='m.obj'/></asset>" + shown,
                            {{"m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n"}}),
                 "has no \"face\", and vertices that lie in one plane"));
  MjcfScene tetrahedron("<asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 2 0.1 0.1 0.1'/></asset>" + shown);
  CHECK(tetrahedron.warnings().empty());
  CHECK(tetrahedron.mesh(0).indices.size() == 12);
  CHECK(tetrahedron.mesh(0).bounds_max == glm::vec3(1, 1, 2));
  CHECK(contains(mjcf_error("<asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 1 1 0'/></asset>" + shown),
                 "vertices that lie in one plane"));
  if (!has_python_module("mujoco")) return;
  std::vector<glm::dvec3> points;
  std::string vertices;
  Random random(11);
  for (int i = 0; i < 300; ++i) {
    points.push_back(random_point(random) * glm::dvec3(1, 2, 3));
    for (int k = 0; k < 3; ++k) vertices += format_number(points.back()[k]) + " ";
  }
  const TemporaryFolder folder;
  write_text(folder / "m.xml",
             "<mujoco><asset><mesh name='m' vertex='" + vertices + "'/></asset>" + shown + "</mujoco>");
  const ProcessResult mujoco = Process({kToolsPython, "-c", kMassScript, (folder / "m.xml").string()}).wait();
  REQUIRE_MESSAGE(mujoco.exit_code == 0, mujoco.err);
  constexpr double kFloatCorners = 1e-6;  // MuJoCo holds corners as floats: 6e-8 of 3 m, on both sides of three axes
  CHECK(volume_of(points, convex_hull(points).value()) ==
        doctest::Approx(std::stod(mujoco.out)).epsilon(kFloatCorners));
}

}  // namespace simvis::test

TEST_SUITE_END();
