// Unique names for files that are written first and renamed afterwards.
#pragma once

#include <string>

namespace simvis {

/// "MACHINE.PROCESS.NUMBER". No other call returns the same name, whether in this process, in another process, or on
/// another machine that writes to the same file system.
std::string temporary_name();

}  // namespace simvis
