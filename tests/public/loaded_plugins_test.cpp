// The plug-ins that a program has loaded, and the evidence of a test that uses their types.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <simvis/plugin.h>
#include <simvis/testing.h>
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("public");

namespace simvis::test_kit {
namespace {

TEST_CASE("types of a plug-in that the test has loaded are in the evidence") {
  const std::string file = tested_build() + "/lib/libsimvis_example_plugin.so";
  CHECK(std::ranges::count(loaded_plugins(), file) == 0);
  for (int i = 0; i < 2; ++i) load_plugin(file);
  CHECK(std::ranges::count(loaded_plugins(), file) == 1);
  CHECK_THROWS_AS(load_plugin(tested_build() + "/lib/no_plugin.so"), InputError);
  CHECK(loaded_plugins().size() == 1);

  const TemporaryFolder folder;
  write_text(folder / "ring.xml",
             "<simvis><sensor type='ring_lidar' name='RING' insert_at='ROOT' beams='8'/></simvis>");
  ::setenv("SIMVIS_RUN", (tested_build() + "/bin/simvis-run").c_str(), 1);
  Run run(folder / "ring.xml", {.limit_s = 1, .simulation = {}, .evidence = folder / "evidence", .name = "ring"});
  REQUIRE(run.step());
  const Verdict failed = run.check(range_near(run.sim().scan("RING"), 3, 5));
  CHECK_MESSAGE(contains(failed.text, "failure.html#frame=0&select=beam:RING:3"), failed.text);
  CHECK(contains(read_text(folder / "evidence/ring/failure.html"), "RING"));
  CHECK(std::filesystem::exists(folder / "evidence/ring/run/RING.csv"));
}

}  // namespace
}  // namespace simvis::test_kit

TEST_SUITE_END();
