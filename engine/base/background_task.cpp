#include "engine/base/background_task.h"

namespace simvis {

void BackgroundTask::run_if_waiting() {
  std::uint32_t waiting = kWaiting;
  if (!state_.compare_exchange_strong(waiting, kRunning, std::memory_order_acq_rel)) return;
  try {
    work_();
  } catch (...) {
    failure_ = std::current_exception();
  }
  end();
}

void BackgroundTask::finish() {
  run_if_waiting();
  wait();
  if (failure_) std::rethrow_exception(failure_);
}

void BackgroundTask::cancel() {
  std::uint32_t waiting = kWaiting;
  if (state_.compare_exchange_strong(waiting, kRunning, std::memory_order_acq_rel)) return end();
  wait();
}

// Releases what the work holds, which may be a whole image.
void BackgroundTask::end() {
  work_ = nullptr;
  state_.store(kDone, std::memory_order_release);
  state_.notify_all();
}

void BackgroundTask::wait() const {
  while (true) {
    const std::uint32_t state = state_.load(std::memory_order_acquire);
    if (state == kDone) return;
    state_.wait(state, std::memory_order_acquire);
  }
}

}  // namespace simvis
