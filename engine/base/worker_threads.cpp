#include "engine/base/worker_threads.h"

#include <algorithm>
#include <utility>

namespace simvis {

namespace {

// The casts of one frame follow one another within this time, some 20 microseconds: waking a thread takes longer.
constexpr int kPatience = 1000;

void pause_briefly() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

/// Returns once the value is another.
template <typename T>
void wait_while(const std::atomic<T>& value, T old) {
  for (int i = 0; i < kPatience; ++i) {
    if (value.load(std::memory_order_acquire) != old) return;
    pause_briefly();
  }
  value.wait(old, std::memory_order_acquire);
}

}  // namespace

std::size_t WorkerThreads::count() { return std::max(1u, std::thread::hardware_concurrency()); }

WorkerThreads::~WorkerThreads() {
  stopped_ = true;
  ++number_;
  number_.notify_all();
}

void WorkerThreads::share(std::size_t things, std::size_t piece, const Work& work) {
  if (things <= piece || count() == 1) {
    if (things > 0) work(0, 0, things);
    return;
  }
  start();
  job_ = {&work, things, piece};
  next_ = 0;
  unfinished_ = static_cast<std::uint32_t>(threads_.size());
  ++number_;
  number_.notify_all();
  work_on_pieces(0);
  for (std::uint32_t left = unfinished_; left > 0; left = unfinished_) wait_while(unfinished_, left);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void WorkerThreads::start() {
  while (threads_.size() + 1 < count()) {
    threads_.emplace_back([this, thread = threads_.size() + 1] { serve(thread); });
  }
}

void WorkerThreads::serve(std::size_t thread) {
  for (std::uint32_t done = 0;;) {
    wait_while(number_, done);
    if (stopped_) return;
    ++done;
    work_on_pieces(thread);
    --unfinished_;
    unfinished_.notify_all();
  }
}

void WorkerThreads::work_on_pieces(std::size_t thread) {
  try {
    for (std::size_t first; (first = next_.fetch_add(job_.piece)) < job_.things;) {
      (*job_.work)(thread, first, std::min(job_.piece, job_.things - first));
    }
  } catch (...) {
    const std::lock_guard lock(failed_);
    failure_ = std::current_exception();
  }
}

}  // namespace simvis
