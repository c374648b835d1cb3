// Reads part files with other projects' libraries, in a program of its own: they may crash or hang on what is broken.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scenegraph/import/sandbox/imported_scene.h"

namespace simvis {

struct SandboxedImport {
  std::filesystem::path program;
  std::string library;         ///< that the program reads with, for messages
  std::filesystem::path file;  ///< as messages name it
  bool ignore_up_axis = false;
  std::chrono::milliseconds time{10'000};
  std::size_t memory_bytes = std::size_t{4} << 30;  ///< not enforced under AddressSanitizer
};

/// Warnings that the library gave stand first in the scene.
/// Throws InputError naming the file: the library refuses it, crashes on it, takes more time or memory, or the program
/// gives a malformed answer; MachineError naming the program when that cannot be started.
ImportedScene import_in_sandbox(const SandboxedImport& import);

}  // namespace simvis
