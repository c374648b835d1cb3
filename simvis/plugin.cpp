#include <simvis/plugin.h>

#include <dlfcn.h>

#include <string>

#include <simvis/error.h>

namespace simvis {

void load_plugin(const std::filesystem::path& file) {
  // An absolute name: a bare one would be looked for among the system's libraries.
  const std::string path = std::filesystem::absolute(file).string();
  if (::dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL) != nullptr) return;
  throw InputError(file.string() + ": error: this plug-in cannot be loaded: " + ::dlerror());
}

}  // namespace simvis
