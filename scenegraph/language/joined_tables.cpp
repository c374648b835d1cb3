#include "scenegraph/language/joined_tables.h"

#include <deque>
#include <mutex>

namespace simvis {

AttributeTable join_tables(const std::vector<std::vector<AttributeSpec>>& tables) {
  static std::mutex mutex;
  static std::deque<std::vector<AttributeSpec>> kept;
  const std::lock_guard lock(mutex);
  std::vector<AttributeSpec>& joined = kept.emplace_back();
  for (const std::vector<AttributeSpec>& table : tables) joined.insert(joined.end(), table.begin(), table.end());
  return joined;
}

}  // namespace simvis
