// simvis-run --export and --page: the files appear, and a browser shows the page.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "program/live/page_recording.h"
#include "simvis/built_scene.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("live");

namespace simvis {
namespace {

const std::string kScene =
    "<simvis><part file=\"" SIMVIS_SOURCE_DIR
    "/scenes/marvin/robot.glb\" name=\"ROBOT\" insert_at=\"ROOT\"/>"
    "<element type=\"pose\" name=\"MOVE\" insert_at=\"ROBOT\"/>"
    "<sensor type=\"laser_scanner\" name=\"SCAN\" insert_at=\"ROBOT\" samples=\"5\" pose_offset=\"0.4 0 0.2 0 0 0\"/>"
    "<part name=\"WALL\" insert_at=\"ROOT\" shape=\"box\" size=\"0.1 4 2\" pose_offset=\"3 0 0 0 0 0\"/>"
    "<part name=\"CRATE_1\" insert_at=\"ROOT\" shape=\"box\" size=\"0.6 0.6 0.6\" pose_offset=\"0.3 1 1.4 0 0 0\"/>"
    "<part name=\"CRATE_2\" insert_at=\"ROOT\" shape=\"box\" size=\"0.4 0.4 0.4\" pose_offset=\"0.3 -1 1.4 0 0 0\"/>"
    "<element type=\"label\" name=\"L\" insert_at=\"ROOT\" parts=\"CRATE_?\" class=\"crate\" class_id=\"1\"/>"
    "<sensor type=\"camera\" name=\"CAM\" insert_at=\"ROOT\" width=\"32\" height=\"24\" outputs=\"color boxes "
    "silhouettes\" "
    "pose_offset=\"-3 0 1 0 0 0\"/></simvis>";

struct RecordedRun {
  RecordedRun() {
    write_text(folder / "s.xml", kScene);
    write_text(folder / "t.csv", "time_s,MOVE.x\n0,0\n1,0.5\n2,0\n");
    result = run_simvis({(folder / "s.xml").string(), "--trajectory", (folder / "t.csv").string(), "--rate", "1",
                         "--frames", "3", "--out", (folder / "out").string(), "--export",
                         (folder / "views/s.glb").string(), "--page", (folder / "views/s.html").string()});
  }
  TemporaryFolder folder;
  ProcessResult result;
};

/// Writes the page of the same run by a program that adds a warning to its last frame, as the runs of tests do.
void write_page_with_warning(const RecordedRun& run, const std::filesystem::path& file) {
  SimulationDesc desc;
  desc.rate_hz = 1;
  Simulation simulation = Simulation::load(run.folder / "s.xml", desc);
  read_all_content(simulation);
  const Trajectory trajectory(run.folder / "t.csv", simulation.parameters());
  live::PageRecording page(file);
  for (int frame = 0; frame < 3; ++frame) {
    trajectory.apply(frame, simulation.parameters());
    if (frame == 2) simulation.warn("at 2 s: MOVE has moved");
    simulation.step();
    page.add(simulation, *simulation.last_frame());
  }
  page.finish();
}

TEST_CASE("a run writes the scene and the page beside its results, and a browser shows it") {
  const RecordedRun run;
  INFO(run.result.err);
  REQUIRE(run.result.exit_code == 0);
  CHECK(run.result.out.find("views/s.glb, ") != std::string::npos);
  CHECK(read_text(run.folder / "views/s.glb").starts_with("glTF"));
  const std::string page = read_text(run.folder / "views/s.html");
  CHECK(page.find("id=\"frame-1\"") != std::string::npos);
  CHECK(page.find("src=\"") == std::string::npos);  // it loads nothing
  CHECK(page.find("href=\"http") == std::string::npos);
  write_page_with_warning(run, run.folder / "warned.html");
  // Debian's Python has Debian's packages.
  const ProcessResult browser = Process({"/usr/bin/python3", SIMVIS_SOURCE_DIR "/tests/live/browse_page.py",
                                         (run.folder / "warned.html").string(), (run.folder / "out").string()})
                                    .wait(std::chrono::seconds(250));
  INFO(browser.out << browser.err);
  if (browser.exit_code == test::kSkippedExitCode) return test::skip(browser.out);
  CHECK(browser.exit_code == 0);
}

TEST_CASE("the same run writes the same page and scene, whatever it takes and prints") {
  const TemporaryFolder folder;
  write_text(folder / "s.xml", kScene);
  const auto written = [&](const std::vector<std::string>& more) {
    const TemporaryFolder out;
    std::vector<std::string> options{(folder / "s.xml").string(),
                                     "--frames",
                                     "2",
                                     "--out",
                                     (out / "o").string(),
                                     "--page",
                                     (out / "p.html").string(),
                                     "--export",
                                     (out / "e.glb").string()};
    options.insert(options.end(), more.begin(), more.end());
    const ProcessResult result = run_simvis(options);
    INFO(result.err);
    CHECK(result.exit_code == 0);
    return read_text(out / "p.html") + read_text(out / "e.glb");
  };
  const std::string first = written({});
  CHECK(first.size() > 100'000);
  CHECK((written({}) == first));
  CHECK((written({"--threads", "1"}) == first));
  CHECK((written({"--explain"}) == first));
}

TEST_CASE("a run that fails leaves no page") {
  const TemporaryFolder folder;
  write_text(folder / "s.xml", "<simvis><nonsense/></simvis>");
  CHECK(run_simvis(
            {(folder / "s.xml").string(), "--page", (folder / "s.html").string(), "--out", (folder / "out").string()})
            .exit_code == 2);
  CHECK(files_below(folder.path()) == std::vector<std::string>{"s.xml"});
}

}  // namespace
}  // namespace simvis
