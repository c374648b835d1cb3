// The threads of SimVis: all parallel work uses this pool, except the opening of a device.
//
// There are two kinds of work, and each has its own threads. The caller of a loop waits for it, and a loop may take
// less than 0.2 ms. So the caller takes part, and workers that sleep or spin join it. A background task (the encoding
// of an image) takes tens of milliseconds, and at first its result is not needed. A worker that encodes an image could
// not join a loop until it has finished, and Linux does not let a thread raise its priority again after lowering it. So
// tasks have separate threads of low priority. If all cores are busy, these take about a tenth of one core each;
// otherwise they take the idle cores. If a thread waits for a task that has not begun, that thread runs it.
//
// Nesting. The work of a loop may begin loops. No loop waits for a thread that has not joined it: a loop ends when its
// caller finds no piece left and all threads that have joined it have left. So each loop ends even if all workers are
// busy with other loops.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "engine/base/background_task.h"
#include "engine/base/program_api.h"

namespace simvis {

/// Threads  all functions from any thread, several at the same time; also from within the work of a loop.
/// Errors   an exception of the work is rethrown by the function that began it, only the first if there are several;
///          the pieces of a loop that have not begun are then skipped. If the machine provides fewer threads than
///          requested, these do all the work.
class ThreadPool {
 public:
  static constexpr unsigned kMaxSize = 1024;

  /// `slot` is a number below size() that no other thread working on this loop has. The caller's is 0.
  using LoopBody = std::function<void(std::size_t slot, std::size_t first, std::size_t count)>;

  /// `size`, from 1 to kMaxSize, is the number of threads that run a loop, its caller included. Threads start when
  /// there is first work for them.
  explicit ThreadPool(unsigned size);
  /// No loop may be running. Waits for the tasks that have begun; the other tasks remain waiting.
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned size() const { return size_; }

  /// Divides [0, count) into pieces of size `piece`, of which the last may be smaller, and returns when all are done.
  /// If there is only one piece, the caller runs it alone.
  void parallel_for(std::size_t count, std::size_t piece, const LoopBody& body);

  /// Runs both and returns when both are done. Meanwhile the caller helps other parallel_both() calls, so neither
  /// function may hold a lock that another such call takes.
  void parallel_both(const std::function<void()>& a, const std::function<void()>& b);

  /// Helps parallel_both() calls while `busy` returns true. The thread that makes it false must call notify()
  /// afterwards.
  void help_while(const std::function<bool()>& busy);
  void notify();

  /// Runs the work in the background. In a pool of size 1 the caller runs it at once.
  SIMVIS_PROGRAM_API std::shared_ptr<BackgroundTask> run_in_background(std::function<void()> work);

  /// The number of tasks that run in the background at the same time: 0 in a pool of size 1.
  SIMVIS_PROGRAM_API unsigned background_threads() const;

 private:
  struct Loop;
  enum class Kind { pieces, both };
  void run_loop(Loop& loop, bool helps);
  Loop* join(bool only_both, std::size_t& slot);
  void work_on(Loop& loop, std::size_t slot);
  void leave(Loop& loop);
  void start_workers();
  void wake(std::size_t helpers);
  void serve_loops();
  void serve_tasks();

  unsigned size_;
  std::mutex mutex_;                       // protects the two members below
  std::vector<Loop*> loops_;               // loops that threads may join
  std::vector<std::thread> workers_;       // size_ - 1 threads, or none yet
  std::atomic<bool> started_{false};       // whether workers_ have been started
  std::atomic<bool> stopped_{false};       // whether workers have to end
  std::atomic<std::uint32_t> changes_{0};  // counts new loops and calls of notify()
  std::atomic<std::uint32_t> ends_{0};     // counts threads that have left a loop of kind `pieces`

  std::mutex tasks_mutex_;  // protects all members below
  std::condition_variable tasks_changed_;
  std::deque<std::shared_ptr<BackgroundTask>> tasks_;
  bool tasks_end_ = false;
  std::vector<std::thread> background_;
};

/// The pool of `threads` threads; 0 for as many as the machine has. All callers that request the same number share one
/// pool, which lives as long as any of them holds it, so that several simulations together use no more threads than one
/// of them. Throws InputError above ThreadPool::kMaxSize.
SIMVIS_PROGRAM_API std::shared_ptr<ThreadPool> shared_thread_pool(unsigned threads = 0);

}  // namespace simvis
