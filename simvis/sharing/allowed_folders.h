// The folders below which requests of other programs may name files, and what answers to them may say.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include "engine/base/program_api.h"

namespace simvis {

/// Attributes of commands and elements that name files.
inline constexpr std::string_view kFileAttributes[] = {"file", "texture", "heights", "pattern"};

/// Whether the value of one of them is a file: `pattern` may also name a device.
constexpr bool names_file(std::string_view attribute, std::string_view value) {
  return attribute != "pattern" || !value.starts_with("device:");
}

class SIMVIS_PROGRAM_API AllowedFolders {
 public:
  /// Throws InputError: a folder is not there.
  explicit AllowedFolders(std::span<const std::filesystem::path> folders);

  /// The commands of a request, which `name` stands for in messages; relative names start at start(). Throws
  /// InputError: as parse_commands(), at the first file that lies elsewhere, before it is opened, and at arguments of
  /// xacro in which code could stand.
  std::vector<Command> parse(std::string_view xml, const std::string& name) const;
  /// Throws InputError: the file lies elsewhere.
  void check(const std::filesystem::path& file) const;
  /// Where relative names of requests start.
  std::filesystem::path start() const;

 private:
  void check(const CommandAttribute& file, const std::filesystem::path& folder) const;

  std::vector<std::filesystem::path> folders_;  // canonical
};

/// Why a request is refused for which the host's memory does not suffice.
inline constexpr std::string_view kNoMemoryForRequest =
    "the memory of the simulation does not suffice for this request";

/// A message about a request for its sender, which need not have the rights of this process: texts in quotes that do
/// not stand in the request, such as the line of a file that could not be read, become "...". Names that the message
/// suggests stay.
SIMVIS_PROGRAM_API std::string without_file_content(std::string_view message, std::string_view request);

}  // namespace simvis
