// The folders below which requests of other programs may name files.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <simvis/command.h>

namespace simvis {

class AllowedFolders {
 public:
  /// Throws InputError: a folder is not there.
  explicit AllowedFolders(std::span<const std::filesystem::path> folders);

  /// Throws InputError at the first file that lies elsewhere.
  void check(std::span<const Command> commands) const;
  /// Where relative names of requests start.
  std::filesystem::path start() const;

 private:
  std::vector<std::filesystem::path> folders_;  // canonical
};

}  // namespace simvis
