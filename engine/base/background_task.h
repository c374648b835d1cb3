// Work that nobody waits for yet.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <utility>

namespace simvis {

/// Work that runs once, on a background thread of a ThreadPool or in finish(), whichever comes first.
/// Threads  all functions from any thread; finish() and cancel() from one.
class BackgroundTask {
 public:
  explicit BackgroundTask(std::function<void()> work) : work_(std::move(work)) {}

  /// Runs the work on this thread if no thread has begun it.
  void run_if_waiting();

  bool done() const { return state_.load(std::memory_order_acquire) == kDone; }

  /// Returns when the work is done, and runs it on this thread if no other has begun it. Rethrows what it threw.
  void finish();

  /// The work does not begin any more. Waits for it where it has begun, and ignores what it threw.
  void cancel();

 private:
  static constexpr std::uint32_t kWaiting = 0, kRunning = 1, kDone = 2;
  void end();
  void wait() const;

  std::function<void()> work_;
  std::exception_ptr failure_;
  std::atomic<std::uint32_t> state_{kWaiting};
};

}  // namespace simvis
