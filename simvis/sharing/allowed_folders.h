// The folders below which requests of other programs may name files, and what answers to them may say.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include "engine/base/program_api.h"
#include "engine/base/read_fence.h"

namespace simvis {

class SIMVIS_PROGRAM_API AllowedFolders {
 public:
  /// Throws InputError: a folder is not there.
  explicit AllowedFolders(std::span<const std::filesystem::path> folders);

  /// The commands of a request, which `name` stands for in messages; relative names start at start(). Throws
  /// InputError: as parse_commands(), at arguments of xacro in which code could stand, and at the first file that lies
  /// elsewhere, before it is opened, in the same words whether it is there or not. What executes the commands belongs
  /// into carry_out(), too.
  std::vector<Command> parse(std::string_view xml, const std::string& name) const;
  /// Carries out a request: this thread then reads files below the folders alone, those too that files name in turn,
  /// and wherever symbolic links lead in the meantime (engine/base/read_fence.h).
  void carry_out(const std::function<void()>& request) const;
  /// Throws InputError: the file lies elsewhere.
  void check(const std::filesystem::path& file) const;
  /// Where relative names of requests start.
  std::filesystem::path start() const;

 private:
  void check(const CommandAttribute& file, const std::filesystem::path& folder) const;

  Folders folders_;  // canonical
};

/// Why a request is refused for which the host's memory does not suffice.
inline constexpr std::string_view kNoMemoryForRequest =
    "the memory of the simulation does not suffice for this request";

/// A message about a request for its sender, which need not have the rights of this process: texts in quotes that do
/// not stand in the request, such as the line of a file that could not be read, become "...". Names that the message
/// suggests stay.
SIMVIS_PROGRAM_API std::string without_file_content(std::string_view message, std::string_view request);

}  // namespace simvis
