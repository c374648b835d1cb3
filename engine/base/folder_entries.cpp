#include "engine/base/folder_entries.h"

#include <dirent.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <string_view>

#include "engine/base/read_error.h"

namespace simvis {

// By readdir(): the iterators of the C++ library end the process where an allocation fails.
std::vector<std::filesystem::path> folder_entries(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> entries;
  const auto check = [&](int error) {
    if (error != 0 && !is_fault_of_file(error)) throw_read_error(folder, "cannot be listed", error);
  };
  if (!is_input_folder(folder)) return entries;
  const std::unique_ptr<DIR, int (*)(DIR*)> listing(::opendir(folder.c_str()), ::closedir);
  if (listing == nullptr) {
    check(errno);
    return entries;
  }
  errno = 0;
  while (const dirent* const entry = ::readdir(listing.get())) {
    const std::string_view name = entry->d_name;
    if (name != "." && name != "..") entries.push_back(folder / name);
    errno = 0;
  }
  check(errno);
  std::ranges::sort(entries);
  return entries;
}

}  // namespace simvis
