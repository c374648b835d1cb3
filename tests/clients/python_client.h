// Programs in Python with the module simvis_client, which loads the client library of the tested build.
#pragma once

#include <string>
#include <vector>

#include "tests/support/tested_build.h"

namespace simvis {

/// Variables of the environment with which /usr/bin/python3 imports simvis_client. It is built without sanitizers, and
/// may still load a library that has them.
inline std::vector<std::string> python_client_environment() {
  return {"PYTHONPATH=" SIMVIS_SOURCE_DIR "/exchange/clients",
          "SIMVIS_CLIENT_LIBRARY=" + tested_build() + "/lib/libsimvis-client.so",
          "ASAN_OPTIONS=verify_asan_link_order=0:detect_leaks=0"};
}

}  // namespace simvis
