// The records of an MCAP file as bytes: an opcode, the length of the content, and the content, little-endian.
#pragma once

#include <concepts>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "engine/base/binary_numbers.h"

namespace simvis::ros {

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

enum class McapOpcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
  reserved = 0x80  ///< private to this program: skipped by readers
};

/// Builds the content of a record.
class McapRecord {
 public:
  explicit McapRecord(McapOpcode opcode) : opcode_(opcode) {}

  template <std::unsigned_integral T>
  McapRecord& number(T value) {
    append_binary(content_, value);
    return *this;
  }
  /// A text with its length, or bytes with theirs.
  McapRecord& text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    return raw(text);
  }
  McapRecord& raw(std::string_view bytes) {
    content_ += bytes;
    return *this;
  }
  McapRecord& map(const std::map<std::string, std::string>& texts);
  McapRecord& map(const std::map<std::uint16_t, std::uint64_t>& numbers);

  /// The whole record.
  std::string bytes() const;

 private:
  McapOpcode opcode_;
  std::string content_;
};

/// Opcode and length, as they stand before the content of every record.
std::string mcap_record_head(McapOpcode opcode, std::uint64_t content_bytes);

}  // namespace simvis::ros
