#include "program/report/shard.h"

#include <charconv>

#include <simvis/error.h>

namespace simvis {

std::string Shard::suffix() const { return "-" + std::to_string(index) + "-of-" + std::to_string(count); }

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, index_error] = std::from_chars(text.data(), end, shard.index);
  if (index_error == std::errc() && slash != end && *slash == '/') {
    const auto [rest, count_error] = std::from_chars(slash + 1, end, shard.count);
    if (count_error == std::errc() && rest == end && shard.index < shard.count) return shard;
  }
  throw InputError("\"" + text + "\" is not a share of a run, expected K/N with K from 0 to N - 1");
}

}  // namespace simvis
