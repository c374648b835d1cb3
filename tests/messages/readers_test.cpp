// Files that the packages rosbags and mcap of PyPI read: every type field by field, and a recorded run.
#include <doctest/doctest.h>

#include "exchange/messages/mcap_writer.h"
#include "tests/messages/message_values.h"
#include "tests/messages/pip_packages.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

using ros::test::Json;

ProcessResult run_python(const std::filesystem::path& packages, const Strings& arguments) {
  Strings all = {"python3"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return Process(all, {"PYTHONPATH=" + packages.string()}).wait();
}

TEST_CASE("readers that others wrote read every type, and a recorded run") {
  const TemporaryFolder folder;
  const auto packages = test::pip_packages({"rosbags", "mcap"});
  if (!packages) return;
  const std::filesystem::path file = folder / "all.mcap";
  ros::test::Random random(6);
  Json expected;
  {
    ros::McapWriter writer(file);
    for (int i = 0; i < 5; ++i) {
      ros::test::for_each_type([&]<typename M>() {
        M message;
        ros::test::fill(message, random);
        const std::string topic = "/t" + std::to_string(i) + "/" + std::string(M::kName);
        expected[topic] = {{"hash", ros::type_hash(ros::describe<M>())}, {"message", ros::test::to_json(message)}};
        writer.write(writer.add_channel(topic, ros::describe<M>(), ros::Durability::transient), i,
                     ros::encode(message));
      });
    }
    writer.finish();
  }
  write_text(folder / "expected.json", expected.dump());
  const std::string script = SIMVIS_SOURCE_DIR "/tests/messages/read_recording.py";
  const ProcessResult all = run_python(*packages, {script, file.string(), (folder / "expected.json").string()});
  INFO(all.err);
  CHECK(all.exit_code == 0);
  CHECK(all.out == std::to_string(expected.size()) + " messages\n");

  // A file without a summary, as after a kill: rosbags and mcap read it from its start.
  const std::filesystem::path killed = folder / "killed.mcap";
  {
    ros::McapWriter writer(killed);
    const auto channel = writer.add_channel("/image", ros::describe<ros::Image>(), ros::Durability::transient);
    ros::Image image;
    image.data.resize(ros::McapWriter::kChunkBytes);
    for (int i = 0; i < 3; ++i) writer.write(channel, i, ros::encode(image));
  }
  const ProcessResult open = run_python(*packages, {"-c", R"(
import sys
from pathlib import Path
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
with AnyReader([Path(sys.argv[1])]) as reader:
    print(len(list(reader.messages())))
with open(sys.argv[1], "rb") as stream:
    print(len(list(make_reader(stream, validate_crcs=True).iter_messages())))
)",
                                                    killed.string()});
  INFO(open.err);
  CHECK(open.out == "3\n3\n");

  for (const char* name : {"run.mcap", "bag/"}) {
    CAPTURE(name);
    const std::filesystem::path recorded = folder / name;
    const ProcessResult run = run_simvis({write_wall_scene(folder.path(), kWallSensors).string(), "--out",
                                          (folder / "out").string(), "--frames", "20", "--record", recorded.string()});
    REQUIRE(run.exit_code == 0);
    const ProcessResult read = run_python(*packages, {"-c", R"(
import sys
from pathlib import Path
from rosbags.highlevel import AnyReader
with AnyReader([Path(sys.argv[1])]) as reader:
    read = sum(1 for connection, _, raw in reader.messages() if reader.deserialize(raw, connection.msgtype))
    assert read == reader.message_count, reader.message_count
    print(read)
)",
                                                      recorded.string()});
    INFO(read.err);
    CHECK(read.exit_code == 0);
    CHECK(std::stoul("0" + read.out) > 20 * 8);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
