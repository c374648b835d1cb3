// Starts the programs in Python that read strangers' files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "import/sandbox/sandboxed_import.h"

namespace simvis {

/// The first program of this name in the folders of PATH. Entries that are empty or relative are left out: the current
/// folder may be that of a stranger's part.
std::optional<std::filesystem::path> program_in_path(std::string_view name);

/// The interpreter that the variable SIMVIS_PYTHON names, or else the python3 of PATH, as in a virtual environment.
std::optional<std::filesystem::path> find_python();

/// The interpreter of a program: the one that its first line names, or find_python() for a program that is no script of
/// Python, such as those by which pyenv starts others.
std::optional<std::filesystem::path> python_of(const std::filesystem::path& program);

/// A call of the script, one of those in the folder import/programs/, which reads `file` with the library. Modules come
/// from the interpreter's own folders and the absolute ones of PYTHONPATH, and none are written.
SandboxedImport python_import(const std::filesystem::path& python, std::string_view script, const std::string& library,
                              const std::filesystem::path& file);

}  // namespace simvis
