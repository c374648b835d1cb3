// Keeps two runs from writing to one folder at the same time.
#pragma once

#include <filesystem>

namespace simvis {

/// A lock on the folder itself, so that no file of it stays. The operating system releases it when the process ends,
/// however it ends. File systems that cannot lock folders are not guarded.
class FolderLock {
 public:
  /// `shared`: processes that share may write at the same time, but not beside one that does not.
  /// Throws InputError naming the folder if another process holds a lock that this one does not allow; MachineError if
  /// the folder cannot be opened.
  FolderLock(const std::filesystem::path& folder, bool shared);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace simvis
