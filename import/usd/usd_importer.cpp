// Imports stages of USD as parts: a program in Python reads them with usd-core and answers glTF.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <simvis/error.h>
#include <simvis/part_importer.h>
#include "engine/base/input_file.h"
#include "engine/base/read_fence.h"
#include "import/sandbox/python_program.h"
#include "import/sandbox/sandboxed_import.h"
#include "import/usd/usd_answer.h"
#include "import/usd/usd_model.h"

namespace simvis {
namespace {

PartContent import_usd(const ImportRequest& request, ContentPool& pool) {
  const PartFence fence(request.file);
  const ModelFence model_fence(request.file);
  const std::string name = request.file.string();
  // USD would call a pointer of Git LFS a broken file.
  if (InputFile(request.file).size() == 0) throw InputError(name + ": error: is empty; expected USD");
  const std::optional<std::filesystem::path> python = find_python();
  if (!python)
    throw InputError(name + ": error: USD is read by Python: install python3 and its packages usd-core and numpy");
  SandboxedImport import = python_import(*python, "usd_main.py", "usd-core", request.file);
  import.least.time = kUsdTime;
  const SandboxedAnswer answer = ask_in_sandbox(import);
  PartContent content = read_usd_answer(answer.scene, request, pool);
  std::vector<std::string> warnings;
  for (const std::string& warning : answer.warnings) warnings.push_back(name + ": " + warning);
  content.warnings.insert(content.warnings.begin(), warnings.begin(), warnings.end());
  return content;
}

const PartImporterRegistration usd_registration({".usd", ".usda", ".usdc", ".usdz"}, import_usd);

}  // namespace
}  // namespace simvis
