#include "engine/base/read_scope.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include <simvis/error.h>

namespace simvis {
namespace {

thread_local ReadScope* innermost_scope = nullptr;

}  // namespace

ReadScope closed_scope(Folders folders) { return {.folders = folders, .limit = folders}; }

std::optional<ReadScope> read_scope() {
  return innermost_scope == nullptr ? std::nullopt : std::optional(*innermost_scope);
}

ReadScope* innermost_read_scope() { return innermost_scope; }

ReadScope* exchange_read_scope(ReadScope* scope) { return std::exchange(innermost_scope, scope); }

bool lies_in(const std::filesystem::path& file, const Folders& folders) {
  return std::ranges::any_of(folders, [&](const std::filesystem::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
  });
}

std::filesystem::path place_of(const std::filesystem::path& file, int descriptor) {
  std::error_code error;
  std::filesystem::path place = std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor), error);
  if (error) throw MachineError(file.string() + ": error: the system does not say where it lies: " + error.message());
  return place;
}

}  // namespace simvis
