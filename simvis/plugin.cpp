#include <simvis/plugin.h>

#include <dlfcn.h>

#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <simvis/error.h>
#include "import/sandbox/import_program.h"
#include "import/sandbox/sandbox_process.h"
#include "scenegraph/language/registrations.h"

namespace simvis {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw InputError(file.string() + ": error: this plug-in cannot be loaded: " + reason);
}

/// Why plug-ins were refused that are loaded nevertheless. A library with a unique symbol (an inline variable is
/// enough) stays after dlclose(), and its registrations do not run again. By the handle of dlopen().
std::map<void*, std::string>& refused_but_loaded() {
  static std::map<void*, std::string> reasons;
  return reasons;
}

void* loaded(const std::string& path) { return ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD); }

/// One plug-in is loaded at a time: the counts before and after show what it has registered.
std::recursive_mutex& loading() {
  static std::recursive_mutex mutex;
  return mutex;
}

/// In their order: a plug-in may use what an earlier one has registered.
std::vector<std::string>& accepted_files() {
  static std::vector<std::string> files;
  return files;
}

/// Returns why the library at `path` would end this process while it is loaded; empty if it would not. The loader
/// passes on no exception of a static initialiser, so a helper program loads the library first.
std::string fault_of(const std::string& path) {
  constexpr std::chrono::seconds kPatience(60);
  constexpr std::size_t kReasonBytes = 1 << 10;
  SandboxCall call;
  call.program = import_program("simvis-try-plugin");
  call.purpose = "tries plug-ins";
  call.arguments = accepted_files();
  call.arguments.push_back(path);
  call.time = kPatience;
  call.answer_bytes = kReasonBytes;
  const SandboxReport report = run_in_sandbox(call);
  const HelperFault fault = fault_of(report.end);
  switch (fault.blame) {
    case Blame::nobody:
      return {};
    case Blame::machine:
      // A plug-in that computes for so long is one that hangs; it is not the machine that is slow.
      if (report.end.kind != HelperEndKind::out_of_processor_time) {
        throw MachineError(path + ": error: the helper program that tries it " + fault.reason);
      }
      return "its static initialisers take longer than " + std::to_string(kPatience.count()) + " s";
    default:
      if (report.answer.bytes().empty())
        return "its static initialisers are at fault: a program that tries it " + fault.reason;
      return "a static initialiser throws: " + std::string(report.answer.bytes().begin(), report.answer.bytes().end());
  }
}

}  // namespace

void load_plugin(const std::filesystem::path& file) {
  const std::lock_guard lock(loading());
  if (file.empty() || file.native().find('\0') != std::string::npos) refuse(file, "no file can have this name");
  // dlopen() searches the system folders for a name without a path, so it gets an absolute path.
  const std::string path = std::filesystem::absolute(file).string();
  if (void* const library = loaded(path)) {
    const auto refused = refused_but_loaded().find(library);
    if (refused == refused_but_loaded().end()) return;
    refuse(file, refused->second);
  }
  if (const std::string fault = fault_of(path); !fault.empty()) refuse(file, fault);
  Registrations& registrations = Registrations::instance();
  const std::size_t accepted = registrations.accepted(), refused = registrations.refused().size();
  void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) refuse(file, ::dlerror());

  std::string reason;
  const std::vector<std::string> reasons = registrations.refused();
  for (std::size_t i = refused; i < reasons.size(); ++i) reason += (reason.empty() ? "" : "; ") + reasons[i];
  if (reason.empty() && registrations.accepted() == accepted) {
    reason = "it registers no element, sensor, effect or part format with this SimVis";
  }
  if (reason.empty()) {
    accepted_files().push_back(path);
    return;
  }
  registrations.roll_back(accepted, refused);
  ::dlclose(library);
  if (void* const remaining = loaded(path)) refused_but_loaded()[remaining] = reason;
  refuse(file, reason);
}

}  // namespace simvis
