// The priority of background threads, whose results are needed late.
#pragma once

#include <sys/resource.h>

namespace simvis {

/// Lowers the priority of the calling thread for good: on a machine with few cores it uses the time that other threads
/// leave over, and delays none of them.
inline void lower_thread_priority() {
  constexpr int kNiceness = 10;
  ::setpriority(PRIO_PROCESS, 0, ::getpriority(PRIO_PROCESS, 0) + kNiceness);  // on Linux this affects this thread only
}

}  // namespace simvis
