// A task that runs in the background until its result is needed.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <utility>

#include "engine/base/program_api.h"

namespace simvis {

/// Work that runs once, on a background thread of a ThreadPool or in finish(), whichever comes first.
/// Threads  all functions from any thread; finish() and cancel() from one thread only.
class BackgroundTask {
 public:
  explicit BackgroundTask(std::function<void()> work) : work_(std::move(work)) {}

  /// Runs the work on this thread if no thread has begun it.
  void run_if_waiting();

  bool done() const { return state_.load(std::memory_order_acquire) == kDone; }

  /// Returns when the work is done; runs it on this thread if no other thread has begun it. Rethrows the exception that
  /// the work threw.
  SIMVIS_PROGRAM_API void finish();

  /// Prevents the work from beginning. If it has begun, waits for it and ignores what it throws.
  SIMVIS_PROGRAM_API void cancel();

 private:
  static constexpr std::uint32_t kWaiting = 0, kRunning = 1, kDone = 2;
  void end();
  void wait() const;

  std::function<void()> work_;
  std::exception_ptr failure_;
  std::atomic<std::uint32_t> state_{kWaiting};
};

}  // namespace simvis
