// Tells a forked process from the one that it was forked from.
#pragma once

#include <sys/types.h>

namespace simvis {

/// One user of threads and of the Vulkan driver. fork() copies their memory but none of their threads: whatever waits
/// for one of them in the child would wait for ever.
///
/// Threads  any.
class ProcessUse {
 public:
  /// Throws InputError in a process that was forked while there were users.
  ProcessUse();
  ~ProcessUse();
  ProcessUse(const ProcessUse&) = delete;
  ProcessUse& operator=(const ProcessUse&) = delete;

  /// Whether this process was forked since the constructor.
  bool forked() const;
  /// Throws InputError if it was.
  void require_not_forked() const;

 private:
  unsigned forks_;
  pid_t process_;
};

}  // namespace simvis
