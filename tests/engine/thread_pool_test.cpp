// The thread pool: the caller and its helpers do every piece once, for any number of callers and levels. Background
// tasks take no thread away from loops.
#include "engine/base/thread_pool.h"

#include <doctest/doctest.h>

#include <barrier>
#include <latch>
#include <numeric>
#include <set>
#include <stdexcept>

#include <simvis/error.h>

TEST_SUITE_BEGIN("engine");

namespace simvis {
namespace {

constexpr unsigned kSizes[] = {1, 2, 3, 8};

/// How often a loop does each of `count` pieces. Checks that no two threads use a slot at the same time.
std::vector<int> done_by_loop(ThreadPool& pool, std::size_t count, std::size_t piece) {
  std::vector<int> done(count);
  std::vector<std::atomic<bool>> busy(pool.size());
  pool.parallel_for(count, piece, [&](std::size_t slot, std::size_t first, std::size_t part) {
    REQUIRE(slot < busy.size());
    CHECK_FALSE(busy[slot].exchange(true));
    for (std::size_t i = first; i < first + part; ++i) ++done[i];
    busy[slot] = false;
  });
  return done;
}

/// The sum of [first, end), split into halves.
std::uint64_t sum(ThreadPool& pool, std::uint64_t first, std::uint64_t end) {
  if (end - first == 1) return first;
  const std::uint64_t middle = first + (end - first) / 2;
  std::uint64_t before = 0, after = 0;
  pool.parallel_both([&] { before = sum(pool, first, middle); }, [&] { after = sum(pool, middle, end); });
  return before + after;
}

TEST_CASE("a loop does each piece once in pools of all sizes") {
  for (const unsigned size : kSizes) {
    CAPTURE(size);
    ThreadPool pool(size);
    CHECK(pool.size() == size);
    for (const std::size_t count : {0, 1, 2, 7, 64, 1000}) {
      for (const std::size_t piece : {1, 3, 64, 2000}) {
        CHECK(done_by_loop(pool, count, piece) == std::vector<int>(count, 1));
      }
    }
  }
}

TEST_CASE("all threads of a pool take part in one loop") {
  constexpr unsigned kSize = 4;
  ThreadPool pool(kSize);
  std::barrier all_there(kSize);  // would wait forever for a missing thread
  pool.parallel_for(kSize, 1, [&](std::size_t, std::size_t, std::size_t) { all_there.arrive_and_wait(); });
}

TEST_CASE("the caller does single pieces, and all pieces of a pool of size 1") {
  const std::thread::id caller = std::this_thread::get_id();
  const auto check = [&](std::size_t slot, std::size_t, std::size_t) {
    CHECK(slot == 0);
    CHECK(std::this_thread::get_id() == caller);
  };
  ThreadPool many(8), one(1);
  many.parallel_for(10, 10, check);
  one.parallel_for(10, 1, check);
}

TEST_CASE("loops of several concurrent callers share one pool") {
  for (const unsigned size : kSizes) {
    CAPTURE(size);
    ThreadPool pool(size);
    std::vector<std::vector<int>> done(6);
    std::vector<std::jthread> callers;
    for (std::vector<int>& mine : done) {
      callers.emplace_back([&] {
        for (int round = 0; round < 50; ++round) mine = done_by_loop(pool, 200, 3);
      });
    }
    callers.clear();
    for (const std::vector<int>& each : done) CHECK(each == std::vector<int>(200, 1));
  }
}

TEST_CASE("nested loops end with any number of threads") {
  for (const unsigned size : kSizes) {
    CAPTURE(size);
    ThreadPool pool(size);
    std::atomic<int> done = 0;
    pool.parallel_for(5, 1, [&](std::size_t, std::size_t, std::size_t outer) {
      for (; outer > 0; --outer) {
        pool.parallel_for(6, 1, [&](std::size_t, std::size_t, std::size_t inner) {
          for (; inner > 0; --inner) {
            pool.parallel_for(7, 2,
                              [&](std::size_t, std::size_t, std::size_t count) { done += static_cast<int>(count); });
          }
        });
      }
    });
    CHECK(done.load() == 5 * 6 * 7);
    CHECK(sum(pool, 0, 3000) == 3000u * 2999 / 2);
  }
}

TEST_CASE("a thread that waits for another one of the pool helps it") {
  for (const unsigned size : kSizes) {
    CAPTURE(size);
    ThreadPool pool(size);
    std::atomic<int> state = 0;  // 1: a thread computes the sum, 2: it is ready
    std::uint64_t made = 0;
    pool.parallel_for(8, 1, [&](std::size_t, std::size_t, std::size_t) {
      int none = 0;
      if (state.compare_exchange_strong(none, 1)) {
        made = sum(pool, 0, 2000);
        state = 2;
        pool.notify();
      }
      pool.help_while([&] { return state.load() == 1; });
      CHECK(made == 2000u * 1999 / 2);
    });
  }
}

TEST_CASE("exceptions of pieces leave the loop, and the pool still works") {
  for (const unsigned size : kSizes) {
    CAPTURE(size);
    ThreadPool pool(size);
    for (const std::size_t wrong : {0, 50, 99}) {
      const auto work = [&](std::size_t, std::size_t first, std::size_t count) {
        if (first <= wrong && wrong < first + count) throw std::runtime_error("wrong");
      };
      CHECK_THROWS_WITH_AS(pool.parallel_for(100, 1, work), "wrong", std::runtime_error);
      CHECK_THROWS_WITH_AS(pool.parallel_both([] {}, [] { throw std::runtime_error("wrong"); }), "wrong",
                           std::runtime_error);
      CHECK(done_by_loop(pool, 100, 1) == std::vector<int>(100, 1));
    }
  }
}

TEST_CASE("tasks run in the background; with a pool of size 1 the caller runs them") {
  for (const unsigned size : kSizes) {
    CAPTURE(size);
    ThreadPool pool(size);
    std::vector<int> done(100);
    std::vector<std::shared_ptr<BackgroundTask>> tasks;
    const std::thread::id caller = std::this_thread::get_id();
    for (int& each : done) {
      tasks.push_back(pool.run_in_background([&] {
        if (size == 1) CHECK(std::this_thread::get_id() == caller);
        ++each;
      }));
    }
    for (const auto& task : tasks) task->finish();
    CHECK(done == std::vector<int>(100, 1));
    CHECK_THROWS_WITH_AS(pool.run_in_background([] { throw std::runtime_error("wrong"); })->finish(), "wrong",
                         std::runtime_error);
  }
}

TEST_CASE("loops have all their threads while the background is busy") {
  constexpr unsigned kSize = 3;
  ThreadPool pool(kSize);
  std::latch release(1);
  std::vector<std::shared_ptr<BackgroundTask>> tasks;
  for (int i = 0; i < 20; ++i) tasks.push_back(pool.run_in_background([&] { release.wait(); }));
  std::barrier all_there(kSize);  // would wait forever for a thread that runs a task
  pool.parallel_for(kSize, 1, [&](std::size_t, std::size_t, std::size_t) { all_there.arrive_and_wait(); });
  release.count_down();
  for (const auto& task : tasks) task->finish();
}

TEST_CASE("a task that has not begun is run by the thread that waits for it, or never if it is cancelled") {
  ThreadPool pool(2);
  REQUIRE(pool.background_threads() == 1);
  std::latch begun(1), release(1);
  const auto blocking = pool.run_in_background([&] {
    begun.count_down();
    release.wait();
  });
  begun.wait();
  std::thread::id by;
  const auto waited_for = pool.run_in_background([&] { by = std::this_thread::get_id(); });
  bool ran = false;
  const auto cancelled = pool.run_in_background([&] { ran = true; });
  waited_for->finish();
  CHECK(by == std::this_thread::get_id());
  cancelled->cancel();
  CHECK(cancelled->done());
  release.count_down();
  blocking->finish();
  CHECK_FALSE(ran);
}

TEST_CASE("tasks that have not begun when the pool is destroyed can still be finished") {
  std::shared_ptr<BackgroundTask> last;
  int done = 0;
  {
    ThreadPool pool(2);
    for (int i = 0; i < 50; ++i) last = pool.run_in_background([&] { ++done; });
  }
  last->finish();
  CHECK(done >= 1);
  CHECK(last->done());
}

TEST_CASE("users of the same number of threads share a pool as long as one of them holds it") {
  const std::shared_ptr<ThreadPool> three = shared_thread_pool(3);
  CHECK(three->size() == 3);
  CHECK(shared_thread_pool(3) == three);
  CHECK(shared_thread_pool(2) != three);
  CHECK(shared_thread_pool() == shared_thread_pool(shared_thread_pool()->size()));
  const std::weak_ptr<ThreadPool> four = shared_thread_pool(4);
  CHECK(four.expired());
  CHECK_THROWS_AS(shared_thread_pool(ThreadPool::kMaxSize + 1), InputError);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
