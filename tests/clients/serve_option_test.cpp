// simvis-run --serve: the options, the ends of a run, and what its report says.
#include <doctest/doctest.h>
#include <signal.h>

#include <nlohmann/json.hpp>

#include <simvis_client/connection.h>
#include "tests/clients/shared_host.h"
#include "tests/support/run_process.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

using namespace simvis;
using client::Connection;

TEST_SUITE_BEGIN("clients");

namespace {

constexpr int kPatience_ms = 60'000;

/// A scene with a scanner, and a program that runs it.
struct ServedRun {
  explicit ServedRun(const std::string& test) : name(unique_name(test)) {
    write_wall_scene(folder.path(), R"(
      <element type="pose" name="MOVE" insert_at="ROOT"/>
      <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="1" min_angle="0" max_angle="0"/>)");
  }
  std::vector<std::string> command(std::vector<std::string> more) const {
    std::vector<std::string> all{tested_build() + "/bin/simvis-run", (folder.path() / "scene.xml").string(), "--out",
                                 (folder.path() / "out").string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  nlohmann::json report() const { return nlohmann::json::parse(read_text(folder.path() / "out" / "run.json")); }
  TemporaryFolder folder;
  std::string name;
};

}  // namespace

TEST_CASE("--serve goes on until it is interrupted: status 130, whole files, and a report") {
  const ServedRun run("cli");
  Process host(run.command({"--serve", run.name}));
  {
    Connection connection(run.name, "driver", kPatience_ms);
    REQUIRE(connection.wait_frame(2, kPatience_ms));
    connection.send("<sensor type='laser_scanner' name='EXTRA' insert_at='ROOT' samples='3'/>");
    connection.send("<part file='wall.gltf' name='NEAR' insert_at='ROOT'/>");
    connection.send("<remove name='SCAN'/>");
    const std::uint64_t frame = connection.frame();
    REQUIRE(connection.wait_frame(frame + 1, kPatience_ms));
    CHECK(connection.latest(connection.sensor("EXTRA")));
    CHECK_THROWS(connection.sensor("SCAN"));
  }
  host.send(SIGINT);
  const ProcessResult result = host.wait();
  CHECK(result.exit_code == 130);
  CHECK(result.out.starts_with("served as " + run.name + "\n"));
  CHECK(result.err.find("stopped by a signal (Interrupt) before frame ") != std::string::npos);
  const nlohmann::json report = run.report();
  CHECK(report.at("status") == "stopped");
  CHECK(report.at("frames_wanted").is_null());
  CHECK(report.at("served").at("name") == run.name);
  CHECK(report.at("served").at("allow").at(0) == run.folder.path().string());
  CHECK(report.at("sensors").at("SCAN").at("frames").get<int>() >= 2);
  CHECK_FALSE(report.at("sensors").contains("EXTRA"));
  CHECK_FALSE(std::filesystem::exists(run.folder.path() / "out" / "EXTRA.csv"));
  // The next run replaces the files of this one; --again cannot make it again.
  CHECK(Process(run.command({"--quiet"})).wait().exit_code == 0);
}

TEST_CASE("--lockstep: a client that is missing ends the run with status 1 and its name") {
  const ServedRun run("cli-lockstep");
  const ProcessResult result =
      Process(run.command({"--serve", run.name, "--lockstep", "left,right", "--lockstep-timeout", "0.2"})).wait();
  CHECK(result.exit_code == 1);
  CHECK(result.err.find("client \"left\" is not connected for frame 0 after 0.2 s") != std::string::npos);
}

TEST_CASE("--lockstep: frames are made with what the clients have set for them") {
  const ServedRun run("cli-steps");
  Process host(run.command({"--serve", run.name, "--lockstep", "driver", "--frames", "4", "--quiet"}));
  Connection driver(run.name, "driver", kPatience_ms);
  const std::int64_t x = driver.parameter("MOVE", "x");
  for (int frame = 0; frame < 4; ++frame) {
    driver.set(x, 0.5 * frame);
    driver.ready();
    if (frame < 3) REQUIRE(driver.wait_frame(static_cast<std::uint64_t>(frame), kPatience_ms));
  }
  CHECK(host.wait().exit_code == 0);
  const std::string csv = read_text(run.folder.path() / "out" / "SCAN.csv");
  for (const char* const range : {"\n0,", "\n1,", "\n2,", "\n3,", ",4,", ",3.5,", ",3,", ",2.5,"}) {
    CHECK(csv.find(range) != std::string::npos);
  }
  CHECK(run.report().at("served").at("lockstep") == nlohmann::json{"driver"});
}

TEST_CASE("--real-time keeps to the wall clock, makes every frame, and says when it cannot") {
  const ServedRun run("cli-real-time");
  const auto start = std::chrono::steady_clock::now();
  CHECK(Process(run.command({"--frames", "11", "--rate", "20", "--real-time", "2", "--quiet"})).wait().exit_code == 0);
  // Ten intervals of 25 ms. A busy machine may take longer, never less.
  CHECK(std::chrono::steady_clock::now() - start >= std::chrono::milliseconds(225));
  CHECK(run.report().at("real_time").at("factor") == 2);
  const ProcessResult late =
      Process(run.command({"--frames", "20000", "--rate", "1000", "--real-time", "1000", "--quiet"})).wait();
  CHECK(late.exit_code == 0);
  CHECK_MESSAGE(late.err.find("warning: --real-time 1000: the run is behind the wall clock by ") != std::string::npos,
                late.err);
  CHECK(run.report().at("frames") == 20000);
  CHECK(run.report().at("real_time").at("late_frames").get<int>() > 10000);
}

TEST_CASE("--serve: mistakes in its options") {
  const ServedRun run("cli-wrong");
  const std::pair<std::vector<std::string>, const char*> wrong[] = {
      {{"--serve", "a/b"}, "--serve: \"a/b\" can't name a served simulation"},
      {{"--serve", run.name, "--allow", "/none"}, "there is no folder \"/none\""},
      {{"--allow", "/tmp"}, "--serve"},
      {{"--serve", run.name, "--lockstep-timeout", "1"}, "--lockstep"},
      {{"--serve", run.name, "--lockstep", "a", "--lockstep-timeout", "0"}, "--lockstep-timeout"},
      {{"--real-time", "0"}, "--real-time"},
      {{"--serve", run.name, "--resume"}, "--resume"},
  };
  for (const auto& [options, message] : wrong) {
    const ProcessResult result = Process(run.command(options)).wait();
    CHECK(result.exit_code == 2);
    CHECK_MESSAGE(result.err.find(message) != std::string::npos, result.err);
  }
}

TEST_SUITE_END();
