#include <simvis/plugin.h>

#include <dlfcn.h>

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <simvis/error.h>
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

}  // namespace

void load_plugin(const std::filesystem::path& file) {
  // One at a time: the counts before and after tell what this library has registered.
  static std::recursive_mutex loading;
  const std::lock_guard lock(loading);
  // dlopen() searches the system folders for a name without a path, so it gets an absolute path.
  const std::string path = std::filesystem::absolute(file).string();
  if (void* const library = loaded(path)) {
    const auto refused = refused_but_loaded().find(library);
    if (refused == refused_but_loaded().end()) return;
    refuse(file, refused->second);
  }
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
  if (reason.empty()) return;
  registrations.roll_back(accepted, refused);
  ::dlclose(library);
  if (void* const remaining = loaded(path)) refused_but_loaded()[remaining] = reason;
  refuse(file, reason);
}

}  // namespace simvis
