// <simvis/test_run.h>: runs that are checked, and the evidence that a failing one leaves, by simvis-run.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include <simvis/testing.h>
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis::test_kit {
namespace {

// A scanner that a test moves towards a wall. At x it measures kWall_m - x.
constexpr double kWall_m = 4;
constexpr std::string_view kScene = R"(<simvis>
  <part shape="box" size="1 4 2" name="WALL" insert_at="ROOT" pose_offset="4.5 0 0 0 0 0"/>
  <part name="ROBOT" insert_at="ROOT"/>
  <element type="pose" name="MOVE" insert_at="ROBOT"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROBOT" samples="1" min_angle="0" max_angle="0"/>
</simvis>)";

/// A scene file, the folder of evidence, and the program that makes it.
struct Tested {
  Tested() {
    write_text(folder / "wall.xml", kScene);
    ::setenv("SIMVIS_RUN", simvis_run().c_str(), 1);
  }
  RunDesc desc(double limit_s) const {
    return {.limit_s = limit_s,
            .simulation = {.rate_hz = 8, .device = {}, .overrides = {}},
            .evidence = folder / "evidence",
            .name = "a test"};
  }
  TemporaryFolder folder;
};

bool says(const Verdict& verdict, std::string_view text) { return verdict.text.find(text) != std::string::npos; }

TEST_CASE("a run ends at its limit, and a passing one leaves nothing") {
  const Tested tested;
  Run run(tested.folder / "wall.xml", tested.desc(1));
  run.always([](const Simulation& sim) { return clear_of(sim.scan("SCAN"), 1); });
  int frames = 0;
  while (run.step()) ++frames;
  CHECK(frames == 9);  // at 0, 1/8, ... 1 s
  CHECK(run.result());
  CHECK(run.check(range_near(run.sim().scan("SCAN"), 0, kWall_m)));
  CHECK_FALSE(std::filesystem::exists(tested.folder / "evidence"));
}

TEST_CASE("a failing run stops, and leaves a page, a recording and a command that measure the same") {
  const Tested tested;
  Run run(tested.folder / "wall.xml", tested.desc(10));
  run.always([](const Simulation& sim) { return clear_of(sim.scan("SCAN"), 2); }, "keeps 2 m away");
  int frames = 0;
  for (double x = 0; run.step(); x += 0.3) {  // 0.3 is no sum of a few powers of two: all digits must come back
    ++frames;
    run.sim().set("MOVE", "x", x + 0.3);
  }
  // At frame k the robot is at 0.3 k, so that 4 - 0.3 k < 2 first at k = 7.
  CHECK(frames == 7);
  const Verdict& failed = run.result();
  CHECK_FALSE(failed);
  CHECK(says(failed, "at 0.875 s: keeps 2 m away: beam 0 measures 1."));
  const std::filesystem::path evidence = tested.folder / "evidence/a_test";
  CHECK(says(failed, (evidence / "failure.html").string() + "#frame=7&select=beam:SCAN:0\nrecording: "));
  CHECK(std::filesystem::file_size(evidence / "failure.html") > 0);
  CHECK(std::filesystem::file_size(evidence / "failure.mcap") > 0);
  // The page and the recording have it as a warning, and so has the run that wrote them.
  CHECK(read_text(evidence / "run/run.json").find("at 0.875 s: keeps 2 m away: beam 0") != std::string::npos);
  const Table measured = read_csv(evidence / "run/SCAN.csv");
  const auto column = std::ranges::find(measured.columns, "range_m") - measured.columns.begin();
  REQUIRE(measured.rows.size() == 8);
  CHECK(std::stof(measured.rows.back()[static_cast<std::size_t>(column)]) == run.sim().scan("SCAN").range_m[0]);
  CHECK(says(failed, "--again " + (evidence / "run/run.json").string()));
  CHECK(run_simvis({"--quiet", "--again", evidence / "run/run.json", "--out", evidence / "again"}).exit_code == 0);
  CHECK(read_text(evidence / "again/SCAN.csv") == read_text(evidence / "run/SCAN.csv"));
  CHECK_FALSE(run.step());  // it stays ended
}

TEST_CASE("a check that fails by itself leaves evidence once") {
  const Tested tested;
  Run run(tested.folder / "wall.xml", tested.desc(1));
  REQUIRE(run.step());
  const Verdict first = run.check(range_near(run.sim().scan("SCAN"), 0, 5));
  CHECK_FALSE(first);
  CHECK(says(first, "failure.html"));
  const Verdict second = run.check({false, "another"});
  CHECK(second.text == "another");
  CHECK(run.result().text == first.text);
}

TEST_CASE("each failure has a folder of its own") {
  const Tested tested;
  ::setenv("SIMVIS_RUN", "/bin/true", 1);
  for (const char* const folder : {"a_test", "a_test-2", "a_test-3"}) {
    Run run(tested.folder / "wall.xml", tested.desc(1));
    REQUIRE(run.step());
    CHECK(says(run.check({false, "it is wrong"}), (tested.folder / "evidence" / folder / "failure.html").string()));
    CHECK(std::filesystem::exists(tested.folder / "evidence" / folder / "values.csv"));
  }
}

TEST_CASE("the run is repeated on the device that was asked for") {
  const Tested tested;
  const std::filesystem::path program = tested.folder / "program", arguments = tested.folder / "arguments";
  write_text(program, "#!/bin/sh\necho \"$@\" > " + arguments.string() + "\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  ::setenv("SIMVIS_RUN", program.c_str(), 1);
  RunDesc desc = tested.desc(1);
  desc.simulation.device.select = "0";
  Run run(tested.folder / "wall.xml", desc);
  REQUIRE(run.step());
  run.check({false, "it is wrong"});
  CHECK(read_text(arguments).find("--device 0 ") != std::string::npos);
}

TEST_CASE("names that leave the folder of evidence, and no name of a scene, are refused") {
  const Tested tested;
  for (const char* const name : {".", ".."}) {
    RunDesc desc = tested.desc(1);
    desc.name = name;
    CHECK(contains(error_of([&] { Run run(tested.folder / "wall.xml", desc); }), "the name of the test is "));
  }
  CHECK(contains(error_of([] { Run run(""); }), "the name of the scene file is empty"));
}

TEST_CASE("an empty SIMVIS_EVIDENCE names no folder") {
  const Tested tested;
  ::setenv("SIMVIS_RUN", "/bin/true", 1);
  ::setenv("SIMVIS_EVIDENCE", "", 1);
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(tested.folder.path());
  RunDesc desc = tested.desc(1);
  desc.evidence.clear();
  Run run("wall.xml", desc);
  REQUIRE(run.step());
  CHECK(says(run.check({false, "it is wrong"}), "simvis-evidence/a_test/failure.html"));
  std::filesystem::current_path(before);
  ::unsetenv("SIMVIS_EVIDENCE");
}

TEST_CASE("a step that fails is no frame of the evidence") {
  const Tested tested;
  Run run(tested.folder / "wall.xml", tested.desc(10));
  REQUIRE(run.step());
  // Half a unit in the last place of a range above 64 m is 4e-6 m.
  run.sim().execute(R"(<sensor type="laser_scanner" name="FINE" insert_at="ROBOT" samples="2" min_angle="-1"
                               max_angle="1" range_max="500" method="hybrid" max_error_m="1e-6"/>)");
  run.sim().set("MOVE", "x", -100);
  for (int i = 0; i < 2; ++i) CHECK(contains(error_of([&] { run.step(); }), "cannot be kept by any method"));
  run.sim().set("MOVE", "x", 0);
  REQUIRE(run.step());
  run.check({false, "it is wrong"});
  CHECK(read_csv(tested.folder / "evidence/a_test/values.csv").rows.size() == 2);
}

TEST_CASE("what prevents evidence is said beside the failure") {
  const Tested tested;
  ::setenv("SIMVIS_RUN", "/there/is/no/such/program", 1);
  Run run(tested.folder / "wall.xml", tested.desc(1));
  REQUIRE(run.step());
  const Verdict failed = run.check({false, "it is wrong"});
  CHECK(says(failed, "it is wrong"));
  CHECK(
      says(failed,
           "no evidence: /there/is/no/such/program cannot be started: No such file or directory; SIMVIS_RUN names the "
           "program"));
}

TEST_CASE("a program that is not in the PATH, and one that fails, are told apart") {
  const Tested tested;
  const std::string path = std::getenv("PATH");
  const auto fault = [&](const char* program) {
    Run run(tested.folder / "wall.xml", tested.desc(1));
    REQUIRE(run.step());
    program == nullptr ? ::unsetenv("SIMVIS_RUN") : ::setenv("SIMVIS_RUN", program, 1);
    const std::string text = run.check({false, "it is wrong"}).text;
    return text.substr(text.find('\n') + 1);
  };
  ::setenv("PATH", tested.folder.path().c_str(), 1);
  CHECK(fault(nullptr) == "no evidence: simvis-run is not in the PATH; SIMVIS_RUN names the program");
  ::setenv("PATH", path.c_str(), 1);
  CHECK(contains(fault("false"), "no evidence: false ended with status 1, its message stands above; SIMVIS_RUN"));
  write_text(tested.folder / "killed", "#!/bin/sh\nkill -9 $$\n");
  std::filesystem::permissions(tested.folder / "killed", std::filesystem::perms::owner_all);
  CHECK(contains(fault((tested.folder / "killed").c_str()), "killed was ended by signal 9; SIMVIS_RUN"));
}

TEST_CASE("the page selects the beam that failed, of the scanner that has it") {
  const Tested tested;
  ::setenv("SIMVIS_RUN", "/bin/true", 1);
  std::string scene(kScene);
  scene.insert(scene.find("</simvis>"),
               "<sensor type='laser_scanner' name='REAR SIDE' insert_at='ROBOT' samples='3' vertical_samples='2' "
               "vertical_min_angle='-30' vertical_max_angle='0' min_angle='-90' max_angle='90'/>");
  write_text(tested.folder / "wall.xml", scene);
  const auto link = [&](const auto& check) {
    Run run(tested.folder / "wall.xml", tested.desc(1));
    REQUIRE(run.step());
    const std::string text = run.check(check(run.sim())).text;
    const std::size_t begin = text.find("#frame=");
    return text.substr(begin, text.find('\n', begin) - begin);
  };
  CHECK(link([](const Simulation& sim) { return clear_of(sim.scan("SCAN"), 9); }) == "#frame=0&select=beam:SCAN:0");
  // Beam 1 of the upper ring, the sixth, looks straight ahead; the others meet nothing or the wall farther away.
  CHECK(link([](const Simulation& sim) { return clear_of(sim.scan("REAR SIDE"), 9); }) ==
        "#frame=0&select=beam:REAR%20SIDE:4");
  CHECK(link([](const Simulation& sim) { return scans_near(sim.scan("SCAN"), Scan(1, 1)); }) == "#frame=0");
  CHECK(link([](const Simulation&) { return Verdict{false, "of no beam"}; }) == "#frame=0");
}

}  // namespace
}  // namespace simvis::test_kit

TEST_SUITE_END();
