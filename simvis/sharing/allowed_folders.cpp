#include "simvis/sharing/allowed_folders.h"

#include <algorithm>
#include <string>
#include <system_error>

#include <simvis/error.h>
#include <simvis/location.h>

namespace simvis {
namespace {

bool is_below(const std::filesystem::path& file, const std::filesystem::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

}  // namespace

AllowedFolders::AllowedFolders(std::span<const std::filesystem::path> folders) {
  for (const std::filesystem::path& folder : folders) {
    std::error_code error;
    folders_.push_back(std::filesystem::canonical(folder, error));
    if (error) throw InputError("there is no folder " + in_quotes(folder.string()) + " that requests could name");
  }
}

void AllowedFolders::check(std::span<const Command> commands) const {
  for (const Command& command : commands) {
    const CommandAttribute* const file = command.find("file");
    if (file == nullptr) continue;
    std::error_code error;
    const std::filesystem::path path = std::filesystem::weakly_canonical(command.folder / file->value, error);
    const auto allows = [&](const std::filesystem::path& folder) { return is_below(path, folder); };
    if (!error && std::ranges::any_of(folders_, allows)) continue;
    std::string allowed;
    for (const std::filesystem::path& folder : folders_) allowed += (allowed.empty() ? "" : ", ") + folder.string();
    fail_at(file->where, "a request may not read " + in_quotes(path.string()) + ", expected a file below " +
                             (allowed.empty() ? "no folder: none was allowed" : allowed));
  }
}

std::filesystem::path AllowedFolders::start() const { return folders_.empty() ? "." : folders_.front(); }

}  // namespace simvis
