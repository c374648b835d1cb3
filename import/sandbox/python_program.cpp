#include "import/sandbox/python_program.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <vector>

#include "import/sandbox/import_program.h"

namespace simvis {
namespace {

constexpr const char* kPythonVariable = "SIMVIS_PYTHON";

// Those of the variable, without entries that are empty or relative.
std::vector<std::filesystem::path> absolute_folders(const char* variable) {
  std::vector<std::filesystem::path> folders;
  const char* const value = std::getenv(variable);
  std::istringstream entries(value == nullptr ? "" : value);
  for (std::string folder; std::getline(entries, folder, ':');) {
    if (folder.starts_with('/')) folders.emplace_back(folder);
  }
  return folders;
}

bool is_python(const std::filesystem::path& program) { return program.filename().string().starts_with("python"); }

// The first of the words that is a path of Python or, behind env, its name; empty if none is.
std::optional<std::filesystem::path> python_among(const std::string& words) {
  std::istringstream rest(words);
  for (std::string word; rest >> std::quoted(word);) {
    if (!is_python(word)) continue;
    if (!word.starts_with('/')) return program_in_path(word);
    if (::access(word.c_str(), X_OK) == 0) return word;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::filesystem::path> program_in_path(std::string_view name) {
  for (const std::filesystem::path& folder : absolute_folders("PATH")) {
    const std::filesystem::path program = folder / name;
    if (::access(program.c_str(), X_OK) == 0 && !std::filesystem::is_directory(program)) return program;
  }
  return std::nullopt;
}

std::optional<std::filesystem::path> find_python() {
  if (const char* const named = std::getenv(kPythonVariable); named != nullptr && *named != '\0') return named;
  return program_in_path("python3");
}

std::optional<std::filesystem::path> python_of(const std::filesystem::path& program) {
  constexpr std::string_view kSecond = "'''exec' ";  // where the path of Python is too long for the first line
  std::ifstream script(program);
  std::string line;
  std::optional<std::filesystem::path> python;
  if (std::getline(script, line) && line.starts_with("#!")) python = python_among(line.substr(2));
  if (!python && std::getline(script, line) && line.starts_with(kSecond)) {
    python = python_among(line.substr(kSecond.size()));
  }
  return python ? python : find_python();
}

SandboxedImport python_import(const std::filesystem::path& python, std::string_view script, const std::string& library,
                              const std::filesystem::path& file) {
  std::string modules;
  for (const std::filesystem::path& folder : absolute_folders("PYTHONPATH")) {
    modules += (modules.empty() ? "" : ":") + folder.string();
  }
  return {.program = python,
          .first_arguments = {"-B", import_program("python") / script, import_program("simvis-python-limits.so")},
          .environment = {"PYTHONDONTWRITEBYTECODE=1", "PYTHONPATH=" + modules},
          .library = library,
          .file = file};
}

}  // namespace simvis
