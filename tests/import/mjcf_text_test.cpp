// Texts of MJCF that are no XML, and that MuJoCo reads: its parser ends at a closing tag behind the root.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/mjcf_scene.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

const std::string kBall = mjcf_world("<geom size='1'/>");

}  // namespace

TEST_CASE("a root that is closed twice is read up to the second tag, with one warning") {
  // MjcfScene writes the second </mujoco>; what is behind the first one is no XML, as MuJoCo allows.
  for (const std::string behind : {"</mujoco>", "</mujoco>\n<!-- twice -->\n", "</mujoco></mujoco>"}) {
    MjcfScene scene(kBall + behind);
    CHECK(scene.list().items.size() == 1);
    REQUIRE(scene.warnings().size() == 1);
    const std::string warning = scene.warnings()[0];
    CHECK(contains(warning, "tag </mujoco> closes nothing; it is left out, with what is behind it"));
    const std::size_t line = behind.find('\n') == std::string::npos ? 1 : 3;
    CHECK(warning.starts_with(std::to_string(line) + ":"));
  }
  MjcfScene rest(kBall + "</mujoco></other>garbage & <");
  CHECK(rest.list().items.size() == 1);
  REQUIRE(rest.warnings().size() == 1);
  CHECK(contains(rest.warnings()[0], "tag </other> closes nothing"));
}

TEST_CASE("an included file that is closed twice is one warning at its own place") {
  MjcfScene scene("<include file='more.xml'/>", {{"more.xml", "<mujoco>" + kBall + "</mujoco>\n</mujoco>"}});
  CHECK(scene.list().items.size() == 1);
  REQUIRE(scene.warnings().size() == 1);
  CHECK(contains(scene.warnings()[0], "more.xml:2:1: tag </mujoco> closes nothing"));
}

TEST_CASE("tags that close nothing elsewhere, and other texts that are no XML, are errors") {
  CHECK(contains(mjcf_error("<worldbody></body><geom size='1'/></worldbody>"), "malformed XML"));
  CHECK(contains(mjcf_error(kBall + "</mujoco><!-- open "), "malformed XML"));
  CHECK(contains(mjcf_error("<worldbody><geom size='1'></worldbody></mujoco>"), "malformed XML"));
}

TEST_CASE("with --strict a root that is closed twice is an error") {
  const TemporaryFolder folder;
  write_text(folder / "m.xml", "<mujoco>" + kBall + "</mujoco></mujoco>");
  SimulationDesc strict;
  strict.strict = true;
  const std::string error = error_of([&] {
    Simulation::from_string("<simvis><part name='M' insert_at='ROOT' file='m.xml'/></simvis>", strict, folder.path());
  });
  CHECK(contains(error, "tag </mujoco> closes nothing"));
  CHECK(contains(error, "(a warning, which is an error here)"));
}

TEST_SUITE_END();
