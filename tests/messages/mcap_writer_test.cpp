// Files of the MCAP writer, read by the records of their definition, and the thread that writes them.
#include "exchange/messages/mcap_writer.h"

#include <doctest/doctest.h>

#include <future>

#include <simvis/error.h>
#include "exchange/messages/mcap_records.h"
#include "exchange/messages/record_file.h"
#include "exchange/messages/recorder.h"
#include "tests/messages/file_size_limit.h"
#include "tests/messages/mcap_file.h"
#include "tests/messages/message_values.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("messages");

namespace simvis::ros {
namespace {

using test::McapFile;
using test::McapReader;

McapFile read_mcap(const std::filesystem::path& file) { return McapReader::read(read_text(file)); }

/// Bytes that zstd cannot make smaller.
Image noise(test::Random& random, std::size_t bytes) {
  Image image;
  image.data.resize(bytes);
  for (std::uint8_t& each : image.data) each = static_cast<std::uint8_t>(random());
  return image;
}

TEST_CASE("a file holds every message of every type") {
  const TemporaryFolder folder;
  test::Random random(3);
  std::vector<std::string> written;
  {
    McapWriter writer(folder / "all.mcap");
    for (int i = 0; i < 20; ++i) {
      test::for_each_type([&]<typename M>() {
        static std::map<McapWriter*, McapWriter::Channel> channels;
        const std::string topic = "/" + std::string(M::kName);
        if (i == 0) channels[&writer] = writer.add_channel(topic, describe<M>(), Durability::transient);
        M message;
        test::fill(message, random);
        written.push_back(encode(message));
        writer.write(channels[&writer], i * 1000, written.back());
      });
    }
    writer.finish();
    CHECK(writer.messages() == written.size());
    CHECK(writer.bytes() == std::filesystem::file_size(folder / "all.mcap"));
  }
  const McapFile file = read_mcap(folder / "all.mcap");
  CHECK(file.has_end);
  REQUIRE(file.messages.size() == written.size());
  const std::size_t types = written.size() / 20;
  for (std::size_t i = 0; i < written.size(); ++i) {
    CHECK(file.messages[i].bytes == written[i]);
    CHECK(file.messages[i].sequence == i / types);
    CHECK(file.messages[i].time_ns == i / types * 1000);
  }
  test::for_each_type([&]<typename M>() {
    CHECK(file.schemas.at(std::string(M::kName)) == msg_text(describe<M>()));
    CHECK(file.metadata.at("/" + std::string(M::kName)).at("topic_type_hash") == type_hash(describe<M>()));
  });
}

TEST_CASE("a latched channel says so") {
  const TemporaryFolder folder;
  McapWriter writer(folder / "file.mcap");
  const auto latched = writer.add_channel("/fixed", describe<Clock>(), Durability::latched);
  const auto other = writer.add_channel("/other", describe<Clock>(), Durability::transient);
  for (const auto channel : {latched, other}) writer.write(channel, 0, encode(Clock{}));
  writer.finish();
  const McapFile file = read_mcap(folder / "file.mcap");
  const auto qos = [&](const char* topic) { return file.metadata.at(topic).at("offered_qos_profiles"); };
  CHECK(qos("/fixed").find("durability: 1\n") != std::string::npos);  // transient local
  CHECK(qos("/other").find("durability: 2\n") != std::string::npos);  // volatile
  CHECK(file.schemas.size() == 1);
}

TEST_CASE("a file that is not finished is whole, without a summary") {
  const TemporaryFolder folder;
  test::Random random(4);
  McapWriter writer(folder / "file.mcap");
  CHECK(read_mcap(folder / "file.mcap").messages.empty());
  const auto channel = writer.add_channel("/image", describe<Image>(), Durability::transient);
  for (std::size_t i = 1; i < 20; ++i) {  // beyond what is reserved at first
    writer.write(channel, 0, encode(noise(random, McapWriter::kChunkBytes + random() % 5000)));
    const McapFile file = read_mcap(folder / "file.mcap");
    CHECK_FALSE(file.has_end);
    CHECK(file.messages.size() == i);
  }
  writer.write(channel, 0, encode(noise(random, 10)));  // waits in the last chunk
  CHECK(read_mcap(folder / "file.mcap").messages.size() == 19);
  writer.finish();
  const McapFile file = read_mcap(folder / "file.mcap");
  CHECK(file.has_end);
  CHECK(file.messages.size() == 20);
}

TEST_CASE("records of any length are there as soon as they are appended, and heads lie within a page") {
  const TemporaryFolder folder;
  test::Random random(10);
  const std::string start = std::string(kMcapMagic) + McapRecord(McapOpcode::header).text("").text("").bytes();
  RecordFile file(folder / "file.mcap", start);
  std::uint64_t crossing = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::uint64_t size = file.size();
    file.append(McapRecord(McapOpcode::metadata).raw(std::string(random() % 600, 'x')).bytes());
    crossing += file.size() % 4096 > 4096 - 9 ? 1 : 0;
    if (i % 100 == 0) {
      const std::string bytes = read_text(folder / "file.mcap");
      CHECK(McapReader::read(bytes).chunks == 0);
      CHECK(static_cast<McapOpcode>(bytes[size]) == McapOpcode::metadata);
      CHECK(file.crc() == test::crc_of(bytes.substr(0, file.size())));
    }
  }
  CHECK(crossing == 0);
  CHECK(files_below(folder.path()) == std::vector<std::string>{"file.mcap"});
}

TEST_CASE("a file that may not grow is an error, and ends with its summary") {
  const TemporaryFolder folder;
  test::Random random(5);
  for (const std::uint64_t limit : {100'000, 1'500'000, 3'200'000, 11'000'000}) {
    std::string error;
    {
      const FileSizeLimit limited(limit);
      McapWriter writer(folder / "file.mcap");
      const auto channel = writer.add_channel("/image", describe<Image>(), Durability::transient);
      try {
        for (int i = 0; i < 20; ++i) writer.write(channel, i, encode(noise(random, McapWriter::kChunkBytes)));
      } catch (const MachineError& thrown) {
        error = thrown.what();
      }
    }
    CHECK(error == (folder / "file.mcap").string() + ": error: cannot be written: File too large");
    const McapFile file = read_mcap(folder / "file.mcap");
    CHECK(file.has_end);
    // A chunk is a little longer than kChunkBytes, and the summary and the reserved page take less than another one.
    CHECK(file.messages.size() >= limit / (McapWriter::kChunkBytes + 4096) - (limit > McapWriter::kChunkBytes ? 1 : 0));
    CHECK(std::filesystem::file_size(folder / "file.mcap") <= limit);
  }
}

TEST_CASE("the recorder waits, drops or goes on when its queue is full") {
  const TemporaryFolder folder;
  Recorder recorder(std::make_unique<MessageFile>(folder / "file.mcap"));
  std::promise<void> gate;
  std::shared_future<void> opened = gate.get_future().share();
  const auto write = [](int time) {
    return [time](MessageSink& file) { file.write("/clock", time, Clock{{time, 0}}); };
  };
  using WhenFull = Recorder::WhenFull;
  CHECK(recorder.add(Recorder::kMaxBytes, WhenFull::wait, [opened](MessageSink&) { opened.wait(); }));
  CHECK_FALSE(recorder.add(1, WhenFull::drop, write(1)));
  CHECK(recorder.add(0, WhenFull::exceed, write(2)));
  std::future<bool> waits = std::async(std::launch::async, [&] { return recorder.add(1, WhenFull::wait, write(3)); });
  gate.set_value();
  CHECK(waits.get());
  recorder.finish();
  CHECK(recorder.messages() == 2);
  std::vector<int> seconds;
  for (const Clock& clock : read_mcap(folder / "file.mcap").all<Clock>("/clock")) seconds.push_back(clock.clock.sec);
  CHECK(seconds == std::vector<int>{2, 3});
}

TEST_CASE("a failure on the recorder's thread is thrown by each later call") {
  const TemporaryFolder folder;
  Recorder recorder(std::make_unique<MessageFile>(folder / "file.mcap"));
  recorder.add(0, Recorder::WhenFull::wait, [](MessageSink&) { throw MachineError("the disk is full"); });
  CHECK_THROWS_WITH_AS(recorder.finish(), "the disk is full", MachineError);
  CHECK_THROWS_AS(recorder.add(0, Recorder::WhenFull::exceed, [](MessageSink&) {}), MachineError);
  CHECK_THROWS_AS(recorder.finish(), MachineError);
}

}  // namespace
}  // namespace simvis::ros

TEST_SUITE_END();
