// Reads MCAP files for tests: by the records of the data section alone, as a reader of a file without a summary does. A
// summary is checked against them.
#pragma once

#include <doctest/doctest.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/cdr.h"
#include "exchange/messages/mcap_records.h"

namespace simvis::ros::test {

struct McapMessage {
  std::string topic, type;
  std::uint32_t sequence = 0;
  std::uint64_t time_ns = 0;
  std::string bytes;
};

struct McapFile {
  std::vector<McapMessage> messages;
  std::size_t chunks = 0;
  bool has_end = false;                                                ///< a summary and checksums
  std::map<std::string, std::string> schemas;                          ///< text by type
  std::map<std::string, std::map<std::string, std::string>> metadata;  ///< of channels, by topic
  std::vector<std::uint64_t> chunk_offsets;

  template <Message M>
  std::vector<M> all(const std::string& topic) const {
    std::vector<M> found;
    for (const McapMessage& each : messages) {
      if (each.topic != topic) continue;
      CHECK(each.type == M::kName);
      found.push_back(decode<M>(each.bytes));
    }
    return found;
  }
  std::map<std::string, std::size_t> counts() const {
    std::map<std::string, std::size_t> counts;
    for (const McapMessage& each : messages) ++counts[each.topic];
    return counts;
  }
};

/// Reads numbers and texts from the front.
class McapBytes {
 public:
  explicit McapBytes(std::string_view bytes) : left_(bytes) {}
  std::string_view take(std::uint64_t size) {
    if (size > left_.size()) throw std::runtime_error("an MCAP record is cut off");
    const std::string_view front = left_.substr(0, size);
    left_.remove_prefix(size);
    return front;
  }
  template <typename T>
  T number() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string text() { return std::string(take(number<std::uint32_t>())); }
  std::map<std::string, std::string> texts() {
    McapBytes bytes(take(number<std::uint32_t>()));
    std::map<std::string, std::string> all;
    while (!bytes.left_.empty()) {
      const std::string key = bytes.text();
      all[key] = bytes.text();
    }
    return all;
  }
  bool empty() const { return left_.empty(); }
  std::size_t size() const { return left_.size(); }

 private:
  std::string_view left_;
};

inline std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

class McapReader {
 public:
  /// Follows the records from the start to the end, which must be whole.
  static McapFile read(std::string_view bytes) {
    McapReader reader;
    REQUIRE(bytes.ends_with(kMcapMagic));
    McapBytes left(bytes);
    REQUIRE(left.take(kMcapMagic.size()) == kMcapMagic);
    for (bool data_ends = false; !data_ends;) {
      const std::uint64_t offset = bytes.size() - left.size();
      const auto opcode = static_cast<McapOpcode>(left.number<std::uint8_t>());
      McapBytes content(left.take(left.number<std::uint64_t>()));
      if (opcode == McapOpcode::chunk) {
        reader.file_.chunk_offsets.push_back(offset);
        reader.read_chunk(content);
      }
      data_ends = opcode == McapOpcode::data_end;
      if (!data_ends) continue;
      const auto crc = content.number<std::uint32_t>();
      reader.file_.has_end = crc != 0;
      if (crc != 0) CHECK(crc == crc_of(bytes.substr(0, offset)));
    }
    if (reader.file_.has_end) {
      reader.check_summary(bytes, bytes.size() - left.size());
    } else {
      constexpr std::size_t kFooterBytes = 9 + 20;
      const std::string_view end = left.take(kFooterBytes + kMcapMagic.size());
      CHECK(end.ends_with(kMcapMagic));
      CHECK(bytes.ends_with(end));  // a kill while room is made leaves another end behind this one, see record_file.h
    }
    return std::move(reader.file_);
  }

 private:
  struct Channel {
    std::string topic, type;
  };

  void read_chunk(McapBytes& chunk) {
    ++file_.chunks;
    chunk.take(16);  // times
    const auto size = chunk.number<std::uint64_t>();
    const auto crc = chunk.number<std::uint32_t>();
    CHECK(chunk.text() == "zstd");
    const std::string_view compressed = chunk.take(chunk.number<std::uint64_t>());
    std::string records(size, '\0');
    REQUIRE(ZSTD_decompress(records.data(), records.size(), compressed.data(), compressed.size()) == size);
    CHECK(crc_of(records) == crc);
    for (McapBytes left(records); !left.empty();) {
      const auto opcode = static_cast<McapOpcode>(left.number<std::uint8_t>());
      McapBytes content(left.take(left.number<std::uint64_t>()));
      if (opcode == McapOpcode::schema) read_schema(content);
      if (opcode == McapOpcode::channel) read_channel(content);
      if (opcode == McapOpcode::message) read_message(content);
    }
  }
  void read_schema(McapBytes& content) {
    const auto id = content.number<std::uint16_t>();
    types_[id] = content.text();
    CHECK(content.text() == "ros2msg");
    file_.schemas[types_[id]] = content.text();
  }
  void read_channel(McapBytes& content) {
    const auto id = content.number<std::uint16_t>(), schema = content.number<std::uint16_t>();
    CHECK(id > 0);
    channels_[id] = {content.text(), types_.at(schema)};
    CHECK(content.text() == "cdr");
    file_.metadata[channels_[id].topic] = content.texts();
  }
  void read_message(McapBytes& content) {
    const Channel& channel = channels_.at(content.number<std::uint16_t>());
    McapMessage message;
    message.topic = channel.topic;
    message.type = channel.type;
    message.sequence = content.number<std::uint32_t>();
    const auto logged_ns = content.number<std::uint64_t>();
    message.time_ns = content.number<std::uint64_t>();
    CHECK(logged_ns == std::max<std::uint64_t>(message.time_ns, 1));
    message.bytes = content.take(content.size());
    file_.messages.push_back(std::move(message));
  }
  /// The summary says what the data section has.
  void check_summary(std::string_view bytes, std::uint64_t start) {
    const std::size_t footer_at = bytes.size() - kMcapMagic.size() - 20;
    McapBytes footer(bytes.substr(footer_at));
    CHECK(footer.number<std::uint64_t>() == start);
    footer.number<std::uint64_t>();
    CHECK(footer.number<std::uint32_t>() == crc_of(bytes.substr(start, footer_at + 16 - start)));
    std::size_t chunk = 0;
    for (McapBytes left(bytes.substr(start)); left.size() > kMcapMagic.size();) {
      const auto opcode = static_cast<McapOpcode>(left.number<std::uint8_t>());
      McapBytes content(left.take(left.number<std::uint64_t>()));
      if (opcode == McapOpcode::statistics) CHECK(content.number<std::uint64_t>() == file_.messages.size());
      if (opcode != McapOpcode::chunk_index) continue;
      content.take(16);
      REQUIRE(chunk < file_.chunks);
      CHECK(content.number<std::uint64_t>() == file_.chunk_offsets[chunk++]);
    }
    CHECK(chunk == file_.chunks);
  }

  McapFile file_;
  std::map<std::uint16_t, std::string> types_;
  std::map<std::uint16_t, Channel> channels_;
};

}  // namespace simvis::ros::test
