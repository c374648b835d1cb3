// Warnings of patterns that no topic has matched: topics may start at any frame, so they come at the end, from each
// outlet that takes patterns.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <simvis/simulation.h>
#include "tests/messages/mcap_file.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wall_scene.h"

using namespace simvis;

TEST_SUITE_BEGIN("clients");

namespace {

// At 10 frames a second SLOW measures in every second one, and what LATE measures arrives two frames later.
constexpr std::string_view kLateSensors = R"(
<part name="ROBOT" insert_at="ROOT"/>
<element type="pose" name="MOVE" insert_at="ROBOT"/>
<sensor type="psd" name="FIRST" insert_at="ROBOT" pose_offset="3.5 0 0 0 0 0"/>
<sensor type="psd" name="SLOW" insert_at="ROBOT" pose_offset="3.5 0 0 0 0 0" rate="5"/>
<sensor type="psd" name="LATE" insert_at="ROBOT" pose_offset="3.5 0 0 0 0 0" delay="0.15"/>
<sensor type="psd" name="WOKEN" insert_at="ROBOT" pose_offset="3.5 0 0 0 0 0"/>
<sensor type="psd" name="LEFT" insert_at="ROBOT" pose_offset="3.5 0 0 0 0 0"/>
<sensor type="psd" name="OFF" insert_at="ROBOT" pose_offset="3.5 0 0 0 0 0"/>)";

struct TopicCase {
  std::string pattern;
  bool comes;
  bool by_dds_only = false;
};
// The second measurement of a slow sensor, a delayed one, the motion and the path of a part; a sensor that is switched
// on after the first frame, off after it, or never on; topics of texts, of which there are none; and what no scene
// sends.
const std::vector<TopicCase> kTopicCases = {{"/SLOW/twist", true},  {"/LATE/*", true},           {"/ROBOT/odom", true},
                                            {"/ROBOT/path", true},  {"/WOKEN/pose", true},       {"/LEFT/pose", true},
                                            {"/diagnostics", true}, {"/simvis/log", true, true}, {"/OFF/*", false},
                                            {"/nothing", false}};

struct PatternOutlet {
  std::string name;
  std::function<void(Simulation&, const std::filesystem::path& folder, std::vector<std::string> topics)> begin;
  std::function<void(Simulation&)> end;
};

std::vector<PatternOutlet> pattern_outlets() {
  std::vector<PatternOutlet> outlets;
  for (const char* const file : {"run.mcap", "bag/"}) {
    outlets.push_back(
        {"recording",
         [file](Simulation& simulation, const std::filesystem::path& folder, std::vector<std::string> topics) {
           simulation.record({.file = folder / file, .topics = std::move(topics)});
         },
         [](Simulation& simulation) { simulation.finish_recording(); }});
  }
  if (has_dds()) {
    outlets.push_back({"DDS",
                       [](Simulation& simulation, const std::filesystem::path&, std::vector<std::string> topics) {
                         simulation.join_dds({.domain = own_domain(), .topics = std::move(topics)});
                       },
                       [](Simulation& simulation) { simulation.leave_dds(); }});
  }
  return outlets;
}

bool comes_by(const PatternOutlet& outlet, const TopicCase& topic) {
  return topic.comes && (!topic.by_dds_only || outlet.name == "DDS");
}

struct LateTopics {
  explicit LateTopics(bool strict = false) : simulation(load(folder, strict)) {
    simulation.enable("WOKEN", false);
    simulation.enable("OFF", false);
  }
  static Simulation load(const TemporaryFolder& folder, bool strict) {
    SimulationDesc desc;
    desc.rate_hz = 10;
    desc.strict = strict;
    return Simulation::load(write_wall_scene(folder.path(), kLateSensors), desc);
  }
  void run() {
    simulation.step();
    simulation.enable("WOKEN", true);
    simulation.enable("LEFT", false);
    for (int i = 0; i < 3; ++i) simulation.step();
  }

  TemporaryFolder folder;
  Simulation simulation;
};

TEST_CASE("a pattern is warned of at the end, once, and only if no topic of any frame matches") {
  for (const PatternOutlet& outlet : pattern_outlets()) {
    for (const TopicCase& topic : kTopicCases) {
      const std::string name = outlet.name, pattern = topic.pattern;
      CAPTURE(name);
      CAPTURE(pattern);
      LateTopics late;
      outlet.begin(late.simulation, late.folder.path(), {topic.pattern});
      late.run();
      CHECK(late.simulation.warnings().empty());
      outlet.end(late.simulation);
      const std::vector<std::string> expected = {outlet.name + ": no topic has matched \"" + topic.pattern + "\""};
      CHECK(late.simulation.warnings() == (comes_by(outlet, topic) ? std::vector<std::string>{} : expected));
    }
  }
}

TEST_CASE("a strict simulation takes topics that start late, and ends with the error of one that never comes") {
  for (const PatternOutlet& outlet : pattern_outlets()) {
    const std::string name = outlet.name;
    CAPTURE(name);
    std::vector<std::string> patterns;
    for (const TopicCase& each : kTopicCases) {
      if (comes_by(outlet, each)) patterns.push_back(each.pattern);
    }
    LateTopics all(true);
    outlet.begin(all.simulation, all.folder.path(), patterns);
    all.run();
    CHECK_NOTHROW(outlet.end(all.simulation));
    LateTopics lacks(true);
    outlet.begin(lacks.simulation, lacks.folder.path(), {"/clock", "/nothing"});
    lacks.run();
    CHECK_THROWS_WITH_AS(outlet.end(lacks.simulation), doctest::Contains("no topic has matched \"/nothing\""),
                         InputError);
    CHECK_NOTHROW(outlet.begin(lacks.simulation, lacks.folder.path(), {}));  // the first one is over
  }
}

TEST_CASE("an outlet that has got no frame warns of nothing") {
  for (const PatternOutlet& outlet : pattern_outlets()) {
    LateTopics late(true);
    outlet.begin(late.simulation, late.folder.path(), {"/nothing"});
    CHECK_NOTHROW(outlet.end(late.simulation));
  }
}

TEST_CASE("simvis-run prints the warning when the run ends, and --strict ends it with status 2 and whole files") {
  for (const bool records : {true, false}) {
    if (!records && !has_dds()) continue;
    for (const bool strict : {false, true}) {
      for (const std::string topic : {"/SLOW/twist", "/nothing"}) {
        CAPTURE(records);
        CAPTURE(strict);
        CAPTURE(topic);
        const TemporaryFolder folder;
        Strings arguments = {write_wall_scene(folder.path(), kLateSensors).string(),
                             "--out",
                             (folder / "out").string(),
                             "--rate",
                             "10",
                             "--frames",
                             "4",
                             "--quiet"};
        const Strings record = {"--record", (folder / "run.mcap").string(), "--record-topics", topic};
        const Strings send = {"--dds", std::to_string(own_domain()), "--dds-topics", topic};
        arguments.insert(arguments.end(), records ? record.begin() : send.begin(), records ? record.end() : send.end());
        if (strict) arguments.emplace_back("--strict");
        const ProcessResult result = run_simvis(arguments);
        INFO(result.err);
        const bool is_missing = topic == "/nothing";
        const std::string report = read_text(folder / "out/run.json"), text = "no topic has matched";
        CHECK(result.exit_code == (is_missing && strict ? 2 : 0));
        CHECK((result.err.find(text) != std::string::npos) == is_missing);
        CHECK((report.find(text) != std::string::npos) == (is_missing && !strict));
        CHECK(report.find(is_missing && strict ? "\"failed\"" : "\"complete\"") != std::string::npos);
        CHECK(read_text(folder / "out/FIRST.csv").ends_with('\n'));
        CHECK((!records || ros::test::McapReader::read(read_text(folder / "run.mcap")).has_end));
      }
    }
  }
}

TEST_CASE("a recording that a signal stops is not warned of topics that may come in later frames, also with --strict") {
  for (const bool strict : {false, true}) {
    CAPTURE(strict);
    const TemporaryFolder folder;
    Strings arguments = {simvis_run(),
                         write_wall_scene(folder.path(), kLateSensors).string(),
                         "--out",
                         (folder / "out").string(),
                         "--rate",
                         "10",
                         "--frames",
                         "1000000",
                         "--quiet",
                         "--record",
                         (folder / "run.mcap").string(),
                         "--record-topics",
                         "/nothing"};
    if (strict) arguments.emplace_back("--strict");
    Process running(arguments);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!std::filesystem::exists(folder / "run.mcap") && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    running.send(SIGINT);
    const ProcessResult result = running.wait();
    INFO(result.err);
    const std::string report = read_text(folder / "out/run.json"), text = "no topic has matched";
    CHECK(result.exit_code == 130);
    CHECK(result.err.find("--resume goes on") != std::string::npos);
    CHECK(result.err.find(text) == std::string::npos);
    CHECK(report.find("\"stopped\"") != std::string::npos);
    CHECK(report.find(text) == std::string::npos);
    CHECK(ros::test::McapReader::read(read_text(folder / "run.mcap")).has_end);
  }
}

}  // namespace
