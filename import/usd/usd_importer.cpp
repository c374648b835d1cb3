// Imports stages of USD as parts: a program in Python reads them with usd-core and answers glTF.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include <simvis/error.h>
#include <simvis/part_importer.h>
#include "engine/base/input_file.h"
#include "engine/base/input_log.h"
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "import/gltf/gltf_importer.h"
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

// The JSON, whose text is behind its size in eight bytes, and the bytes behind it.
using UsdAnswer = std::pair<nlohmann::json, Bytes>;

UsdAnswer split_answer(const SandboxedAnswer& answer, const std::filesystem::path& file) {
  const auto fail = [&] {
    throw InputError(file.string() + ": error: the helper program that read it returned a malformed answer");
  };
  std::uint64_t size = 0;
  if (answer.scene.size() < sizeof(size)) fail();
  std::memcpy(&size, answer.scene.data(), sizeof(size));
  const auto rest = answer.scene.subspan(sizeof(size));
  if (size > rest.size()) fail();
  constexpr int kMaxDepth = 64;  // dump() calls itself for each level
  bool is_deep = false;
  const auto note_depth = [&](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    is_deep = is_deep || depth > kMaxDepth;
    return !is_deep;
  };
  nlohmann::json json =
      nlohmann::json::parse(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(size), note_depth, false);
  if (is_deep || !json.is_object() || !json.contains("gltf") || !json.contains("model")) fail();
  Bytes binary(rest.begin() + static_cast<std::ptrdiff_t>(size), rest.end());
  return {std::move(json), std::move(binary)};
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
  auto [json, binary] = split_answer(answer, request.file);
  GltfDocument document = read_converted_gltf(request.file, json["gltf"].dump(), std::move(binary));
  const bool turns = request.up_given && request.up == UpAxis::y;
  PartContent content = build_gltf(document, pool, turns);
  std::vector<std::string> warnings;
  for (const std::string& warning : answer.warnings) warnings.push_back(name + ": " + warning);
  content.warnings.insert(content.warnings.begin(), warnings.begin(), warnings.end());
  if (!json["model"].is_null()) {
    content.model = std::make_shared<UsdSource>(read_usd_model(json["model"], document, pool));
  }
  return content;
}

const PartImporterRegistration registration({".usd", ".usda", ".usdc", ".usdz"}, import_usd);

}  // namespace
}  // namespace simvis
