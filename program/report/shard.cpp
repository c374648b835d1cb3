#include "program/report/shard.h"

#include <simvis/error.h>
#include "engine/base/words.h"

namespace simvis {

std::string Shard::suffix() const { return "-" + std::to_string(index) + "-of-" + std::to_string(count); }

Shard parse_shard(const std::string& text) {
  if (const std::size_t slash = text.find('/'); slash != text.npos) {
    const auto index = as_number<decltype(Shard::index)>(text.substr(0, slash));
    const auto count = as_number<decltype(Shard::count)>(text.substr(slash + 1));
    if (index && count && *index < *count) return {.index = *index, .count = *count};
  }
  throw InputError("\"" + text + "\" is not a share of a run, expected K/N with K from 0 to N - 1");
}

}  // namespace simvis
