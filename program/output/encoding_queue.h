// A queue that encodes the bytes of files in the background while the caller continues.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace simvis {

class BackgroundTask;
class ThreadPool;

/// `encode` takes long and runs in the background (see ThreadPool). `put` runs on the caller's thread, in the order of
/// the calls to add(). So files, rows and errors appear in order.
///
/// Errors   an exception from `encode` or `put` is rethrown by add() or finish(), the oldest first, and drops the jobs
///          that are pending: what follows it is not put.
/// Memory   at most max_pending() jobs, which together hold at most kMaxBytes, or a single job that holds more. While
///          the queue is held, any number of jobs within kMaxBytes.
/// Threads  only one thread may call the queue; `encode` runs on any thread.
class EncodingQueue {
 public:
  using Encode = std::function<std::string()>;
  using Put = std::function<void(std::string_view bytes)>;
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

  explicit EncodingQueue(std::shared_ptr<ThreadPool> pool);
  /// Drops all jobs whose bytes have not been passed to `put`.
  ~EncodingQueue();
  EncodingQueue(const EncodingQueue&) = delete;
  EncodingQueue& operator=(const EncodingQueue&) = delete;

  /// `held_bytes` is the size of the copies that `encode` works on. Passes finished jobs to their `put`; if too many
  /// jobs are pending, waits for the oldest.
  void add(Encode encode, std::size_t held_bytes, Put put);
  /// Until release(), add() passes no job to its `put`, unless the jobs hold more than kMaxBytes.
  void hold() { held_ = true; }
  void release() { held_ = false; }
  /// Waits for all jobs and passes their bytes to `put`, held or not.
  void finish();

  std::size_t max_pending() const;

 private:
  struct Pending {
    std::shared_ptr<BackgroundTask> task;
    std::shared_ptr<std::string> bytes;  // valid when the task is done
    std::size_t held_bytes;
    Put put;
  };
  void put_oldest();
  void drop();

  std::shared_ptr<ThreadPool> pool_;
  std::deque<Pending> pending_;
  std::size_t held_bytes_ = 0;  // by all pending jobs
  bool held_ = false;
};

}  // namespace simvis
