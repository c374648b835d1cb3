#include "program/output/new_folders.h"

#include <system_error>

#include "program/output/atomic_file.h"

namespace simvis {

NewFolders::NewFolders(const std::filesystem::path& folder) {
  std::error_code error;
  // A link that leads nowhere is there too.
  const auto is_there = [&](const std::filesystem::path& name) {
    return std::filesystem::exists(std::filesystem::symlink_status(name, error));
  };
  for (std::filesystem::path each = folder; !each.empty() && !is_there(each); each = each.parent_path()) {
    made_.push_back(each);
  }
  try {
    make_folder(folder);
  } catch (...) {
    remove_empty();
    throw;
  }
}

NewFolders::~NewFolders() { remove_empty(); }

void NewFolders::remove_empty() const {
  std::error_code is_not_empty;
  for (const std::filesystem::path& each : made_) std::filesystem::remove(each, is_not_empty);
}

}  // namespace simvis
