// Reads part files with third-party libraries in a separate program, because they may crash or hang on broken files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "import/sandbox/growing_bytes.h"
#include "import/sandbox/import_limits.h"
#include "import/sandbox/imported_scene.h"

namespace simvis {

struct SandboxedImport {
  std::filesystem::path program;
  std::vector<std::string> first_arguments{};  ///< in front of the limit of memory, the file and its folders
  std::vector<std::string> environment{};      ///< as that of SandboxCall
  bool inherits_environment = true;            ///< the same
  std::span<const std::uint8_t> input{};       ///< the same
  std::string library;                         ///< name of the library that the program uses, for messages
  std::filesystem::path file;                  ///< appears in messages as given
  bool ignore_up_axis = false;
  ImportLimits least{};               ///< limits_for() makes them larger; memory is not limited under AddressSanitizer
  std::size_t most_answer_bytes = 0;  ///< 0: as much as the memory
};

/// What a program answers, which is not trusted.
struct SandboxedAnswer {
  GrowingBytes bytes;
  std::span<const std::uint8_t> scene;  ///< in `bytes`
  std::vector<std::string> warnings;
};

/// The program's answer. Throws as import_in_sandbox(), except for what is in the answer.
SandboxedAnswer ask_in_sandbox(const SandboxedImport& import);

/// The program reads no other files than those of the fence of the part (engine/base/read_fence.h), which the caller
/// sets. The library's warnings
/// come first in the scene's warnings. Throws InputError naming the file if the library refuses it or crashes on it, or
/// if the program gives a malformed answer; MachineError naming it if the program exceeds a limit of time or memory
/// (import_limits.h), or
/// the machine fails (helper_end.h), and MachineError naming the program if it cannot be started.
ImportedScene import_in_sandbox(const SandboxedImport& import);

}  // namespace simvis
