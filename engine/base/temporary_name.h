// Unique names for files that are written first and renamed afterwards.
#pragma once

#include <string>

#include "engine/base/program_api.h"

namespace simvis {

/// "MACHINE.PROCESS.NUMBER". No other call returns the same name, whether in this process, in another process, or on
/// another machine that writes to the same file system.
SIMVIS_PROGRAM_API std::string temporary_name();

}  // namespace simvis
