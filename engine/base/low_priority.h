// The priority of threads whose work nobody waits for at first.
#pragma once

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>

namespace simvis {

/// Lowers the priority of the calling thread for good: on a machine with few cores it uses the time that other threads
/// leave over, and delays none of them.
inline void lower_thread_priority() {
  constexpr int kNiceness = 10;
  ::setpriority(PRIO_PROCESS, 0, ::getpriority(PRIO_PROCESS, 0) + kNiceness);  // on Linux this affects this thread only
}

/// As lower_thread_priority(), but the thread gets hardly any time of a busy core, and every other thread takes its
/// core over at once. Its work must not be needed soon, or others must be able to do it.
inline void use_idle_cores_only() {
  const sched_param none{};
  if (::pthread_setschedparam(::pthread_self(), SCHED_IDLE, &none) != 0) lower_thread_priority();
}

}  // namespace simvis
