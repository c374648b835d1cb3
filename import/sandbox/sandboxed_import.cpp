#include "import/sandbox/sandboxed_import.h"

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/input_log.h"
#include "engine/base/read_fence.h"
#include "import/sandbox/import_answer.h"
#include "import/sandbox/sandbox_process.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxMessages = 5;

// The message may already begin with the file and the place, as from readers of text formats.
[[noreturn]] void fail(const std::filesystem::path& file, Blame blame, const std::string& what,
                       const ImportAnswer& answer) {
  const std::vector<std::string>& said = answer.errors.empty() ? answer.warnings : answer.errors;
  std::string text = what.starts_with(file.string() + ":") ? what : file.string() + ": error: " + what;
  for (std::size_t i = 0; i < std::min(said.size(), kMaxMessages); ++i) text += "; " + said[i];
  if (said.size() > kMaxMessages) text += "; and " + std::to_string(said.size() - kMaxMessages) + " more messages";
  throw_fault(blame, text);
}

ImportLimits limits_of(const SandboxedImport& import) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(import.file, error);
  return limits_for(import.least, error ? 0 : bytes);
}

SandboxCall call_of(const SandboxedImport& import) {
  const ImportLimits limits = limits_of(import);
  SandboxCall call;
  call.program = import.program;
  call.arguments = import.first_arguments;
  call.arguments.push_back(std::to_string(limits.memory_bytes));
  call.arguments.push_back(import.file.string());
  call.environment = import.environment;
  if (import.ignore_up_axis) call.arguments.emplace_back("--ignore-up-axis");
  const std::optional<Folders> folders = readable_folders();
  SIMVIS_ASSERT(folders.has_value());
  for (const std::filesystem::path& folder : *folders) call.arguments.push_back(folder.string());
  call.inherits_environment = import.inherits_environment;
  call.input = import.input;
  call.time = limits.time;
  call.wall_time =
      std::max<decltype(call.wall_time)>(call.wall_time, 2 * limits.time);  // so that it does not end first
  call.answer_bytes = limits.memory_bytes;
  if (import.most_answer_bytes > 0) call.answer_bytes = std::min(call.answer_bytes, import.most_answer_bytes);
  return call;
}

}  // namespace

SandboxedAnswer ask_in_sandbox(const SandboxedImport& import) {
  const PartFence fence(import.file);
  SandboxReport report = run_in_sandbox(call_of(import));
  const ImportAnswer answer = read_import_answer(report.answer.bytes());
  const HelperFault fault = fault_of(report.end, answer);
  if (fault.blame != Blame::nobody) {
    const bool is_limit = report.end.kind != HelperEndKind::exited && report.end.kind != HelperEndKind::killed;
    fail(import.file, fault.blame,
         (fault.is_reported ? fault.reason : import.library + " " + fault.reason) + (is_limit ? kRaiseLimits : ""),
         answer);
  }
  // A library may continue after an error with only a part of the file.
  if (!answer.errors.empty()) fail(import.file, Blame::file, import.library + " cannot read all of the file", answer);
  // Also if the program was killed in a host that ignores SIGCHLD, whose programs have no exit status.
  if (!answer.scene) fail(import.file, Blame::machine, "the helper program that read it returned nothing", answer);
  for (const std::string& file : answer.inputs) {
    if (is_readable(file)) note_input(file);  // a program that its file has taken over may name others
  }
  // Moving the bytes leaves them where the span points.
  return {.bytes = std::move(report.answer), .scene = *answer.scene, .warnings = answer.warnings};
}

ImportedScene import_in_sandbox(const SandboxedImport& import) {
  const SandboxedAnswer answer = ask_in_sandbox(import);
  ImportedScene scene = unpack_imported_scene(answer.scene, import.file.string() + ": error: ");
  scene.warnings.insert(scene.warnings.begin(), answer.warnings.begin(), answer.warnings.end());
  return scene;
}

}  // namespace simvis
