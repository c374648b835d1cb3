// The threads of SimVis: all that runs on several cores runs on these.
//
// Two kinds of work need two kinds of threads. A loop is waited for, and may take no more than 0.2 ms: its caller takes
// part, and workers that sleep or spin join it. A background task (the encoding of a picture) takes tens of
// milliseconds, and nobody waits for it at first. A worker that encodes could not join a loop until it is done, and
// Linux does not let a thread take back a priority that it has given up. So tasks have threads of their own, of low
// priority: where all cores are busy they take about a tenth of one core each, and else they take the cores that are
// idle. A task that is waited for and has not begun is run by the thread that waits.
//
// Nesting. The work of a loop may begin loops. None of them waits for a thread that has not joined it: a loop ends once
// its caller finds no piece left and those that have joined it have left. So each loop ends, also where all workers are
// busy elsewhere.
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

namespace simvis {

/// Threads  all functions from any thread, several at a time; also from within the work of a loop.
/// Errors   what work throws is thrown by the function that began it, the first of several; the pieces of a loop that
///          have not begun are then left out. Where the machine gives fewer threads than asked for, these do all.
class ThreadPool {
 public:
  static constexpr unsigned kMaxSize = 1024;

  /// `slot`: a number below size(), that of no other thread that works on this loop. The caller's is 0.
  using LoopBody = std::function<void(std::size_t slot, std::size_t first, std::size_t count)>;

  /// `size` from 1 to kMaxSize: on how many threads a loop runs, its caller among them. Threads are started when there
  /// is first work for them.
  explicit ThreadPool(unsigned size);
  /// No loop may be under way. Waits for the tasks that have begun; the others stay as they are.
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned size() const { return size_; }

  /// Divides [0, count) into pieces of `piece`, the last one may be shorter, and returns when all are done. One piece
  /// is done by the caller alone.
  void parallel_for(std::size_t count, std::size_t piece, const LoopBody& body);

  /// Does both and returns when both are done. Meanwhile the caller helps other parallel_both() calls, so neither may
  /// hold a lock that another one takes.
  void parallel_both(const std::function<void()>& a, const std::function<void()>& b);

  /// While `busy` is true, helps parallel_both() calls. Whoever makes it false calls notify() then.
  void help_while(const std::function<bool()>& busy);
  void notify();

  /// Has the work done in the background. In a pool of size 1 it is done at once, by the caller.
  std::shared_ptr<BackgroundTask> run_in_background(std::function<void()> work);

  /// How many tasks run in the background at the same time: 0 in a pool of size 1.
  unsigned background_threads() const;

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
  std::mutex mutex_;                       // of the two below
  std::vector<Loop*> loops_;               // that may be joined
  std::vector<std::thread> workers_;       // size_ - 1, or none yet
  std::atomic<bool> started_{false};       // workers_ are
  std::atomic<bool> stopped_{false};       // workers end
  std::atomic<std::uint32_t> changes_{0};  // of loops_, and ends of what is helped
  std::atomic<std::uint32_t> ends_{0};     // of the part that a thread took in a loop

  std::mutex tasks_mutex_;  // of all below
  std::condition_variable tasks_changed_;
  std::deque<std::shared_ptr<BackgroundTask>> tasks_;
  bool tasks_end_ = false;
  std::vector<std::thread> background_;
};

/// The pool of `threads` threads, 0 for as many as the machine has: all that ask for the same number share one pool for
/// as long as any of them holds it, so that simulations side by side do not ask for more threads than one of them.
/// Throws InputError above ThreadPool::kMaxSize.
std::shared_ptr<ThreadPool> shared_thread_pool(unsigned threads = 0);

}  // namespace simvis
