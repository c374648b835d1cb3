// Memory that runs out in a helper program, whatever the library does about it.
#pragma once

#include <string>

namespace simvis {

/// From now on, the first allocation that fails adds the fault of the machine `text` to the answer on `descriptor`.
/// Libraries turn such a failure into a message about the file, a part of its content, or a crash. Programs with a
/// sanitizer, whose memory is not limited, do not notice failures.
void report_failed_allocations(int descriptor, const std::string& text);

}  // namespace simvis
