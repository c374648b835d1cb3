// Recordings as bag folders of ROS 2. readers_test.cpp has rosbags read one.
#include "exchange/messages/bag_folder.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include <simvis/simulation.h>
#include "tests/messages/mcap_file.h"
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

namespace fs = std::filesystem;
using ros::test::McapFile;
using ros::test::McapReader;

struct BagRun {
  TemporaryFolder folder;
  std::string scene = write_wall_scene(folder.path(), kWallSensors).string();

  ProcessResult record(const fs::path& file) const {
    return run_simvis({scene, "--out", (folder / "out").string(), "--frames", "3", "--record", file.string()});
  }
};

// The number behind each occurrence of a key.
std::vector<std::uint64_t> numbers_of(const std::string& yaml, const std::string& key) {
  std::vector<std::uint64_t> numbers;
  for (std::size_t at = yaml.find(key + ": "); at != yaml.npos; at = yaml.find(key + ": ", at + 1)) {
    numbers.push_back(std::stoull(yaml.substr(at + key.size() + 2)));
  }
  return numbers;
}

TEST_CASE("a path with a slash at its end is a bag folder with the same file") {
  const BagRun run;
  REQUIRE(run.record(run.folder / "run.mcap").exit_code == 0);
  const ProcessResult bag = run.record(run.folder / "drive/");
  REQUIRE(bag.exit_code == 0);
  CHECK(bag.out.find("drive/ (") != std::string::npos);
  CHECK(files_below(run.folder / "drive") == Strings{"drive_0.mcap", "metadata.yaml"});
  CHECK(read_text(run.folder / "drive/drive_0.mcap") == read_text(run.folder / "run.mcap"));

  const McapFile file = McapReader::read(read_text(run.folder / "run.mcap"));
  const std::string yaml = read_text(run.folder / "drive/metadata.yaml");
  std::vector<std::uint64_t> counts{file.messages.size()}, times;
  std::map<std::string, std::uint64_t> by_topic;
  for (const auto& message : file.messages) {
    ++by_topic[message.topic];
    times.push_back(std::max<std::uint64_t>(message.time_ns, 1));  // of the log
  }
  const std::uint64_t first = *std::ranges::min_element(times), last = *std::ranges::max_element(times);
  CHECK(numbers_of(yaml, "nanoseconds_since_epoch") == std::vector<std::uint64_t>{first, first});
  CHECK(numbers_of(yaml, " nanoseconds") == std::vector<std::uint64_t>{last - first, last - first});
  const std::vector<std::uint64_t> written = numbers_of(yaml, " message_count");
  REQUIRE(written.size() == by_topic.size() + 2);
  CHECK(written.front() == file.messages.size());
  CHECK(written.back() == file.messages.size());
  for (const auto& [topic, count] : by_topic) {
    CAPTURE(topic);
    const std::size_t at = yaml.find("name: \"" + topic + "\"");
    REQUIRE(at != yaml.npos);
    CHECK(numbers_of(yaml.substr(at), " message_count").front() == count);
  }
}

TEST_CASE("a bag replaces a bag, and nothing else") {
  const BagRun run;
  const fs::path bag = run.folder / "drive";
  REQUIRE(run.record(bag / "").exit_code == 0);
  const std::string metadata = read_text(bag / "metadata.yaml");
  CHECK(run.record(bag / "").exit_code == 0);
  CHECK(read_text(bag / "metadata.yaml") == metadata);

  write_text(bag / "metadata.yaml", "title: my thesis\n");
  const ProcessResult other = run.record(bag / "");
  CHECK(other.exit_code == 2);
  CHECK(other.err.find("metadata.yaml: error: exists and is no metadata of a bag") != std::string::npos);
  CHECK(read_text(bag / "metadata.yaml") == "title: my thesis\n");

  fs::remove(bag / "metadata.yaml");
  write_text(bag / "drive_0.mcap", "notes");
  CHECK(run.record(bag / "").exit_code == 2);
  CHECK(read_text(bag / "drive_0.mcap") == "notes");

  write_text(run.folder / "plain", "text");
  CHECK(run.record(run.folder / "plain" / "").exit_code != 0);
  CHECK(read_text(run.folder / "plain") == "text");
}

TEST_CASE("a bag whose recording has not ended has no metadata") {
  const BagRun run;
  const fs::path bag = run.folder / "drive";
  REQUIRE(run.record(bag / "").exit_code == 0);
  Simulation simulation = Simulation::load(run.scene);
  simulation.record({.file = bag / ""});
  CHECK(fs::exists(bag / "metadata.yaml"));  // until the first frame replaces the data
  simulation.step();
  CHECK_FALSE(fs::exists(bag / "metadata.yaml"));
  const RecordReport report = simulation.finish_recording();
  CHECK(report.file == bag / "");
  CHECK(numbers_of(read_text(bag / "metadata.yaml"), " message_count").front() == report.messages);
}

TEST_CASE("metadata of an empty bag are whole") {
  const std::string yaml = ros::metadata_yaml({}, "a\"b.mcap");
  CHECK(yaml.find("topics_with_message_count: []\n") != std::string::npos);
  CHECK(yaml.find("- \"a\\\"b.mcap\"\n") != std::string::npos);
  CHECK(numbers_of(yaml, " message_count") == std::vector<std::uint64_t>{0, 0});
}

TEST_CASE("only a slash at the end makes a bag, whose files have the name of the folder") {
  CHECK(ros::is_bag_folder("out/drive/"));
  CHECK_FALSE(ros::is_bag_folder("out/drive"));
  CHECK_FALSE(ros::is_bag_folder(""));
  CHECK_FALSE(ros::is_bag_folder("/"));
  CHECK(ros::bag_data("out/drive/") == "out/drive/drive_0.mcap");
  CHECK(ros::bag_data("drive/./").filename() == "drive_0.mcap");
  CHECK(ros::bag_data("./").filename() == fs::current_path().filename().string() + "_0.mcap");
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
