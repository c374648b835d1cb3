// The element physics: time, restarts, the same bytes, and errors.
#include <doctest/doctest.h>

#include <fstream>
#include <limits>

#include <simvis/simulation.h>
#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// Boxes that fall onto each other and roll away.
std::string tumble() {
  std::string xml = kPhysics + ground();
  for (int i = 0; i < 6; ++i) {
    xml += body("B" + std::to_string(i),
                "shape='box' size='0.3 0.2 0.1' pose_offset='" + format_number(0.04 * i) + " " +
                    format_number(0.03 * (i % 3)) + " " + format_number(0.2 + 0.3 * i) + " 10 " +
                    std::to_string(20 * i) + " 0'",
                "mass='1'");
  }
  return xml;
}

TEST_CASE("the same scene gives the same bytes, whatever the frames") {
  MovingScene a(tumble()), b(tumble());
  a.run(0, 1.2, 0.04);
  b.run(0, 1.2, 0.3);
  CHECK(a.values() == b.values());
  CHECK(a.position("B5").z < 1);  // it has moved
}

TEST_CASE("a restart puts all back to the start, and the same follows") {
  MovingScene scene(tumble());
  const std::vector<double> start = scene.values();
  scene.run(0, 0.8, 0.04);
  std::vector<double> first = scene.values();
  scene.set("PHYSICS", "restarts", 1);
  scene.go_to(0.84);
  std::vector<double> again = scene.values();
  again[1] = 0;  // the count itself
  CHECK(again == start);
  scene.run(0.84, 1.64, 0.04);
  again = scene.values();
  again[1] = 0;
  CHECK(again == first);
}

TEST_CASE("physics that does not run holds all bodies, and time passes") {
  MovingScene scene(kPhysics + body("BALL", "shape='sphere' radius='0.1'", "mass='1'"));
  scene.go_to(0.1);
  scene.set("PHYSICS", "running", 0);
  const double held = scene.position("BALL").z;
  scene.go_to(5);
  CHECK(scene.position("BALL").z == held);
  scene.set("PHYSICS", "running", 1);
  scene.go_to(5.1);
  CHECK(std::abs(scene.position("BALL").z + kGravity_m_s2 * 0.2 * (0.2 + kStep_s) / 2) < 1e-12);
}

TEST_CASE("a body may come and go while the scene runs") {
  MovingScene scene(kPhysics + ground());
  scene.go_to(1);
  SceneBuilder builder(*scene, {});
  builder.execute(
      parse_commands(body("LATE", "shape='box' size='1 1 1' pose_offset='0 0 3 0 0 0'", "mass='1'"), "l.xml", ""));
  scene.go_to(1.5);
  const double fallen = scene.position("LATE").z;
  CHECK(fallen < 2.5);
  CHECK(fallen > 1);
}

std::string wrong(const std::string& commands) {
  return error_of([&] { MovingScene scene(commands); });
}

TEST_CASE("bodies that overlap at the start give a warning") {
  const std::string box = "shape='box' size='1 1 1' pose_offset='0 0 ";
  MovingScene apart(kPhysics + ground() + body("A", box + "0.5 0 0 0'", "mass='1'"));
  CHECK((*apart).scene.warnings().empty());
  MovingScene within(kPhysics + ground() + body("A", box + "0.4 0 0 0'", "mass='1'"));
  const std::vector<std::string> warnings = (*within).scene.warnings();
  REQUIRE(warnings.size() == 1);
  CHECK(contains(warnings[0], "\"GROUND_BODY\""));
  CHECK(contains(warnings[0], "overlap at the start"));
}

TEST_CASE("mistakes name their place") {
  const std::string box = "shape='box' size='1 1 1'";
  CHECK(contains(wrong(body("A", box, "mass='1'")), "s.xml:2:2: error: the scene has no physics yet"));
  CHECK(contains(wrong(kPhysics + kPhysics), "\"PHYSICS\""));
  CHECK(contains(wrong(kPhysics + "<element type='physics' name='P2' insert_at='ROOT'/>"),
                 "s.xml:2:2: error: the scene has physics already, by element \"PHYSICS\""));
  CHECK(contains(wrong(kPhysics + body("A", box, "mass='-2'")), "s.xml:3:50: error: attribute \"mass\": -2"));
  CHECK(contains(wrong(kPhysics + body("A", box, "")), "has neither \"mass\" nor \"density\""));
  CHECK(contains(wrong(kPhysics + body("A", box, "mass='1' density='1'")), "has both \"mass\" and \"density\""));
  CHECK(contains(wrong(kPhysics + body("A", box, "mass='1' shape='mesh'")), "\"mesh\" is not allowed for a dynamic"));
  CHECK(contains(wrong(kPhysics + body("A", "shape='plane' size='1 1'", "mass='1'")), "has no volume"));
  CHECK(contains(wrong(kPhysics + body("A", box, "kind='static' mass='1'")), "not allowed for a static body"));
  CHECK(contains(wrong(kPhysics + body("A", "", "mass='1'")), "has no surface"));
  CHECK(contains(wrong(kPhysics + "<element type='body' name='B' insert_at='ROOT' mass='1'/>"),
                 "expected the name of a part"));
  CHECK(contains(wrong(kPhysics + "<part name='A' insert_at='ROOT' " + box +
                       "/><element type='pose' name='P' insert_at='A'/>"
                       "<element type='body' name='B' insert_at='A' mass='1'/>"),
                 "element \"B\" and element \"P\" both move \"A\""));
  CHECK(contains(wrong(kPhysics + body("A", box, "mass='1'") + "<element type='pose' name='P' insert_at='A'/>"),
                 "element \"A_BODY\" and element \"P\" both move \"A\""));
  CHECK(
      contains(wrong(kPhysics + body("A", box, "mass='1'") + "<element type='body' name='B' insert_at='A' mass='1'/>"),
               "both move \"A\""));
  CHECK(contains(wrong(kPhysics + "<part name='A' insert_at='ROOT' " + box +
                       "/><element type='scale' name='S' insert_at='A' x='2'/>"
                       "<element type='body' name='B' insert_at='A' mass='1'/>"),
                 "element"));
}

TEST_CASE("bodies that explode end the run with their name and the time, and no value becomes NaN") {
  // Gravity of a thousand g makes 10,000 m/s after one second.
  MovingScene scene(physics("gravity='0 0 -10000'") + body("A", "shape='box' size='1 1 1'", "mass='1'"));
  scene.go_to(0.9);
  const std::vector<double> before = scene.values();
  for (int tried = 0; tried < 2; ++tried) {
    try {
      scene.go_to(1.5);
      FAIL("expected an Error");
    } catch (const InputError&) {
      FAIL("simvis-run would exit with 2");
    } catch (const Error& error) {
      CHECK(contains(error.what(), "s.xml:3:2: error: element \"A_BODY\" has exploded at 1.001 s"));
    }
  }
  CHECK(scene.values() == before);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
