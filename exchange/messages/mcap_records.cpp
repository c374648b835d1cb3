#include "exchange/messages/mcap_records.h"

#include <bit>

namespace simvis::ros {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

McapRecord& McapRecord::map(const std::map<std::string, std::string>& texts) {
  std::uint32_t size = 0;
  for (const auto& [key, value] : texts)
    size += static_cast<std::uint32_t>(2 * sizeof size + key.size() + value.size());
  number(size);
  for (const auto& [key, value] : texts) text(key).text(value);
  return *this;
}

McapRecord& McapRecord::map(const std::map<std::uint16_t, std::uint64_t>& numbers) {
  number(static_cast<std::uint32_t>(numbers.size() * (sizeof(std::uint16_t) + sizeof(std::uint64_t))));
  for (const auto& [key, value] : numbers) number(key).number(value);
  return *this;
}

std::string McapRecord::bytes() const { return mcap_record_head(opcode_, content_.size()) + content_; }

std::string mcap_record_head(McapOpcode opcode, std::uint64_t content_bytes) {
  std::string head(1, static_cast<char>(opcode));
  append_binary(head, content_bytes);
  return head;
}

}  // namespace simvis::ros
