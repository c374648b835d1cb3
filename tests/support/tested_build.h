// Which build of SimVis a test program tests: the one that it was built with, or another whose library it was given.
#pragma once

#include <dlfcn.h>

#include <cstdlib>
#include <string>

namespace simvis {

/// Where the tested build's library and programs are: as ctest says, or, by hand, where the test was built.
inline std::string tested_build() {
  const char* folder = std::getenv("SIMVIS_TESTED_BUILD");
  return folder ? folder : SIMVIS_BINARY_DIR;
}

/// Whether the address or the thread sanitizer is there. Beams are then some twenty times slower, pictures some ten
/// times.
inline bool sanitized() {
  return ::dlsym(RTLD_DEFAULT, "__asan_init") != nullptr || ::dlsym(RTLD_DEFAULT, "__tsan_init") != nullptr;
}

}  // namespace simvis
