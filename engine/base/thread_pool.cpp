#include "engine/base/thread_pool.h"

#include <algorithm>
#include <exception>
#include <map>
#include <string>
#include <system_error>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/base/low_priority.h"

namespace simvis {

namespace {

// The casts of one frame follow one another within this time, about 20 microseconds; waking a thread takes longer.
constexpr int kSpins = 1000;
// Encoding an image takes a few times as long as rendering it, so more threads would be idle.
constexpr unsigned kMaxBackground = 8;

void pause_briefly() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

/// Returns as soon as the value differs from `old`.
void wait_while(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  for (int i = 0; i < kSpins; ++i) {
    if (value.load(std::memory_order_acquire) != old) return;
    pause_briefly();
  }
  value.wait(old, std::memory_order_acquire);
}

/// Starts `count` threads, or as many as the machine provides.
template <typename Start>
void start_threads(std::vector<std::thread>& threads, std::size_t count, const Start& start) {
  threads.reserve(count);
  try {
    while (threads.size() < count) threads.push_back(start());
  } catch (const std::system_error&) {
  }
}

}  // namespace

struct ThreadPool::Loop {
  Kind kind;
  std::size_t count, piece;
  const LoopBody& body;
  std::size_t slots = 1;                 // number of assigned slots, the caller's included; protected by mutex_
  std::atomic<std::size_t> next{0};      // index of the first piece that no thread has taken
  std::atomic<std::uint32_t> active{0};  // number of threads that have joined and not left
  std::atomic<bool> failed{false};
  std::exception_ptr failure{};  // exception of the thread that has set `failed`

  bool open() const { return next.load(std::memory_order_relaxed) < count; }
};

ThreadPool::ThreadPool(unsigned size) : size_(size) { SIMVIS_ASSERT(size >= 1 && size <= kMaxSize); }

ThreadPool::~ThreadPool() {
  SIMVIS_ASSERT(loops_.empty());
  stopped_ = true;
  notify();
  for (std::thread& worker : workers_) worker.join();
  {
    const std::lock_guard lock(tasks_mutex_);
    tasks_.clear();
    tasks_end_ = true;
  }
  tasks_changed_.notify_all();
  for (std::thread& thread : background_) thread.join();
}

void ThreadPool::parallel_for(std::size_t count, std::size_t piece, const LoopBody& body) {
  if (count == 0) return;
  if (count <= piece || size_ == 1) return body(0, 0, count);
  Loop loop{.kind = Kind::pieces, .count = count, .piece = piece, .body = body};
  run_loop(loop, false);
}

void ThreadPool::parallel_both(const std::function<void()>& a, const std::function<void()>& b) {
  if (size_ == 1) {
    a();
    return b();
  }
  const LoopBody either = [&](std::size_t, std::size_t first, std::size_t) { first == 0 ? a() : b(); };
  Loop loop{.kind = Kind::both, .count = 2, .piece = 1, .body = either};
  run_loop(loop, true);
}

void ThreadPool::run_loop(Loop& loop, bool helps) {
  start_workers();
  {
    const std::lock_guard lock(mutex_);
    loops_.push_back(&loop);
  }
  wake((loop.count - 1) / loop.piece);
  work_on(loop, 0);
  {
    const std::lock_guard lock(mutex_);
    std::erase(loops_, &loop);
  }
  const auto busy = [&loop] { return loop.active.load(std::memory_order_acquire) > 0; };
  if (helps) {
    help_while(busy);
  } else {
    for (std::uint32_t ends; ends = ends_.load(std::memory_order_acquire), busy();) wait_while(ends_, ends);
  }
  if (loop.failure) std::rethrow_exception(loop.failure);
}

void ThreadPool::help_while(const std::function<bool()>& busy) {
  while (true) {
    const std::uint32_t changes = changes_.load(std::memory_order_acquire);
    if (!busy()) return;
    std::size_t slot = 0;
    if (Loop* const loop = join(true, slot)) {
      work_on(*loop, slot);
      leave(*loop);
    } else {
      wait_while(changes_, changes);
    }
  }
}

void ThreadPool::notify() {
  changes_.fetch_add(1, std::memory_order_release);
  changes_.notify_all();
}

// The loop that began last comes first: it is nested in the others, or as new as they are.
ThreadPool::Loop* ThreadPool::join(bool only_both, std::size_t& slot) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = loops_.size(); i-- > 0;) {
    Loop& loop = *loops_[i];
    if (!loop.open() || (only_both && loop.kind != Kind::both)) continue;
    slot = loop.slots++;
    loop.active.fetch_add(1, std::memory_order_relaxed);
    return &loop;
  }
  return nullptr;
}

void ThreadPool::work_on(Loop& loop, std::size_t slot) {
  try {
    for (std::size_t first; (first = loop.next.fetch_add(loop.piece, std::memory_order_relaxed)) < loop.count;) {
      loop.body(slot, first, std::min(loop.piece, loop.count - first));
    }
  } catch (...) {
    if (!loop.failed.exchange(true)) loop.failure = std::current_exception();
    loop.next.store(loop.count, std::memory_order_relaxed);
  }
}

// The loop no longer exists as soon as the last thread has left it.
void ThreadPool::leave(Loop& loop) {
  const bool both = loop.kind == Kind::both;
  loop.active.fetch_sub(1, std::memory_order_release);
  if (both) return notify();
  ends_.fetch_add(1, std::memory_order_release);
  ends_.notify_all();
}

void ThreadPool::start_workers() {
  if (started_.load(std::memory_order_acquire)) return;
  const std::lock_guard lock(mutex_);
  if (started_.load(std::memory_order_relaxed)) return;
  start_threads(workers_, size_ - 1, [this] { return std::thread([this] { serve_loops(); }); });
  started_.store(true, std::memory_order_release);
}

void ThreadPool::wake(std::size_t helpers) {
  if (helpers + 1 >= size_) return notify();
  changes_.fetch_add(1, std::memory_order_release);
  for (; helpers > 0; --helpers) changes_.notify_one();
}

void ThreadPool::serve_loops() {
  while (true) {
    const std::uint32_t changes = changes_.load(std::memory_order_acquire);
    if (stopped_.load(std::memory_order_acquire)) return;
    std::size_t slot = 0;
    if (Loop* const loop = join(false, slot)) {
      work_on(*loop, slot);
      leave(*loop);
    } else {
      wait_while(changes_, changes);
    }
  }
}

unsigned ThreadPool::background_threads() const { return std::min(size_ - 1, kMaxBackground); }

std::shared_ptr<BackgroundTask> ThreadPool::run_in_background(std::function<void()> work) {
  auto task = std::make_shared<BackgroundTask>(std::move(work));
  if (background_threads() == 0) {
    task->run_if_waiting();
    return task;
  }
  {
    const std::lock_guard lock(tasks_mutex_);
    if (background_.empty()) {
      start_threads(background_, background_threads(), [this] { return std::thread([this] { serve_tasks(); }); });
    }
    if (!background_.empty()) tasks_.push_back(task);  // otherwise finish() runs the task
  }
  tasks_changed_.notify_one();
  return task;
}

void ThreadPool::serve_tasks() {
  lower_thread_priority();  // loops are not delayed by tasks
  while (true) {
    std::shared_ptr<BackgroundTask> task;
    {
      std::unique_lock lock(tasks_mutex_);
      tasks_changed_.wait(lock, [this] { return tasks_end_ || !tasks_.empty(); });
      if (tasks_.empty()) return;
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    task->run_if_waiting();
  }
}

std::shared_ptr<ThreadPool> shared_thread_pool(unsigned threads) {
  if (threads > ThreadPool::kMaxSize) {
    throw InputError(std::to_string(threads) + " threads are not allowed, expected 0 (as many as the machine has) to " +
                     std::to_string(ThreadPool::kMaxSize));
  }
  const unsigned size =
      threads > 0 ? threads : std::clamp(std::thread::hardware_concurrency(), 1u, ThreadPool::kMaxSize);
  static std::mutex mutex;
  static std::map<unsigned, std::weak_ptr<ThreadPool>> pools;
  const std::lock_guard lock(mutex);
  std::weak_ptr<ThreadPool>& known = pools[size];
  std::shared_ptr<ThreadPool> pool = known.lock();
  if (!pool) known = pool = std::make_shared<ThreadPool>(size);
  return pool;
}

}  // namespace simvis
