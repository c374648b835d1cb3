// Folders that go again when nothing was written into them.
#pragma once

#include <filesystem>
#include <vector>

namespace simvis {

/// Makes a folder and its parents where they do not exist. With this object, those that it made go if they are empty.
///
/// Errors   MachineError of make_folder(); no folder is left then.
class NewFolders {
 public:
  explicit NewFolders(const std::filesystem::path& folder);
  ~NewFolders();
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;

 private:
  void remove_empty() const;

  std::vector<std::filesystem::path> made_;  // the innermost first
};

}  // namespace simvis
