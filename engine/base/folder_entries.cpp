#include "engine/base/folder_entries.h"

#include <algorithm>
#include <system_error>

#include "engine/base/read_error.h"

namespace simvis {

std::vector<std::filesystem::path> folder_entries(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> entries;
  std::error_code error;
  for (std::filesystem::directory_iterator each(folder, error), end; !error && each != end; each.increment(error)) {
    entries.push_back(each->path());
  }
  if (error && !is_fault_of_file(error.value())) throw_read_error(folder, "cannot be listed", error.value());
  std::ranges::sort(entries);
  return entries;
}

}  // namespace simvis
