#include "program/report/shard.h"

#include <simvis/error.h>
#include "engine/base/words.h"

namespace simvis {

std::string Shard::suffix() const { return "-" + std::to_string(index) + "-of-" + std::to_string(count); }

Shard parse_shard(const std::string& text) {
  const std::vector<std::string_view> parts = cells_of(text, '/');
  const auto index = as_number<decltype(Shard::index)>(parts.front()),
             count = as_number<decltype(Shard::count)>(parts.back());
  if (parts.size() == 2 && index && count && *index < *count) return {.index = *index, .count = *count};
  throw InputError("\"" + text + "\" is not a share of a run, expected K/N with K from 0 to N - 1");
}

}  // namespace simvis
