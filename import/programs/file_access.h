// The files that a helper program may open.
#pragma once

#include "engine/base/read_fence.h"

namespace simvis {

/// From now on the kernel lets this process open files for reading in these folders and below them, and these files,
/// and no others; what is open stays open, and files in memory can be opened. Folders that are not there are left out.
/// Does nothing where the kernel lacks Landlock (Linux 5.13) and in programs with a sanitizer.
void restrict_files(const Folders& folders);

}  // namespace simvis
