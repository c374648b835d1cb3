// Imports stages of USD as parts: a program in Python reads them with usd-core and answers glTF.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include <simvis/error.h>
#include <simvis/part_importer.h>
#include "engine/base/input_file.h"
#include "engine/base/input_log.h"
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "import/usd/usd_answer.h"
#include "import/usd/usd_model.h"
#include "sandbox/import_program.h"
#include "sandbox/python_path.h"
#include "sandbox/sandboxed_import.h"

namespace simvis {
namespace {

constexpr const char* kPythonVariable = "SIMVIS_PYTHON";

// The interpreter that the variable names, or else the first python3 of PATH, as in a virtual environment.
std::filesystem::path find_python(const std::filesystem::path& file) {
  const ReadOpening opening;
  if (const char* const named = noted_variable(kPythonVariable)) return named;
  const char* const path = std::getenv("PATH");
  for (std::string_view rest = path == nullptr ? "" : path; !rest.empty();) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    const std::filesystem::path python = std::filesystem::path(folder) / "python3";
    if (!folder.empty() && is_there(python)) return python;
    rest.remove_prefix(std::min(folder.size() + 1, rest.size()));
  }
  throw InputError(file.string() +
                   ": error: USD is read by Python: install python3 and its packages usd-core and numpy");
}

PartContent import_usd(const ImportRequest& request, ContentPool& pool) {
  const PartFence fence(request.file);
  const std::string name = request.file.string();
  // USD would call a pointer of Git LFS a broken file.
  if (InputFile(request.file).size() == 0) throw InputError(name + ": error: is empty; expected USD");
  const SandboxedAnswer answer = ask_in_sandbox(
      {.program = find_python(request.file),
       .first_arguments = {"-B", import_program("usd") / "usd_main.py", import_program("simvis-usd-limits.so")},
       .environment = {"PYTHONDONTWRITEBYTECODE=1", "PYTHONPATH=" + python_path()},
       .library = "usd-core",
       .file = request.file,
       .time = kUsdTime});
  PartContent content = read_usd_answer(answer.scene, request.file, request.up_given && request.up == UpAxis::y, pool);
  std::vector<std::string> warnings;
  for (const std::string& warning : answer.warnings) warnings.push_back(name + ": " + warning);
  content.warnings.insert(content.warnings.begin(), warnings.begin(), warnings.end());
  return content;
}

const PartImporterRegistration registration({".usd", ".usda", ".usdc", ".usdz"}, import_usd);

}  // namespace
}  // namespace simvis
