// The tested build of SimVis: the one in which a test program was built, or another one whose library it links.
#pragma once

#include <dlfcn.h>

#include <cstdlib>
#include <string>

namespace simvis {

/// The folder of the tested build's library and programs: from ctest, or by default the folder in which the test was
/// built.
inline std::string tested_build() {
  const char* folder = std::getenv("SIMVIS_TESTED_BUILD");
  return folder ? folder : SIMVIS_BINARY_DIR;
}

/// Whether the address or the thread sanitizer is active. Beams are then about twenty times slower, pictures about ten
/// times.
inline bool sanitized() {
  return ::dlsym(RTLD_DEFAULT, "__asan_init") != nullptr || ::dlsym(RTLD_DEFAULT, "__tsan_init") != nullptr;
}

}  // namespace simvis
