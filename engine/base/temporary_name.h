// Names for files that are written before they get their own name.
#pragma once

#include <string>

namespace simvis {

/// "MACHINE.PROCESS.NUMBER": no other call gives the same, in this process, in another one, or in one of another
/// machine that writes to the same file system.
std::string temporary_name();

}  // namespace simvis
