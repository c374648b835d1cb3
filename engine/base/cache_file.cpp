#include "engine/base/cache_file.h"

#include <cstdlib>
#include <mutex>
#include <set>
#include <system_error>

#include <simvis/error.h>
#include "engine/base/fnv1a.h"
#include "engine/base/temporary_file.h"

namespace simvis {
namespace {

/// Removes what killed programs left, at the first call for this folder: to list it for each file would be slow.
void clear_cache_folder(const std::filesystem::path& folder) {
  static std::mutex mutex;
  static std::set<std::filesystem::path> cleared;
  {
    const std::lock_guard lock(mutex);
    if (!cleared.insert(folder).second) return;
  }
  remove_leftovers(folder, true);
}

}  // namespace

std::filesystem::path cache_folder(const std::string& wish) {
  if (!wish.empty()) return wish;
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg) return std::filesystem::path(xdg) / "simvis";
  if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache" / "simvis";
  return {};
}

void write_cache_file(const std::filesystem::path& file, std::string_view content) {
  std::error_code failure;
  std::filesystem::create_directories(file.parent_path(), failure);
  try {
    clear_cache_folder(file.parent_path());
    replace_file(file, file, content);
  } catch (const MachineError&) {  // then there is no cache
  }
}

std::uint64_t cache_checksum(std::string_view content) { return fnv1a(content); }

}  // namespace simvis
