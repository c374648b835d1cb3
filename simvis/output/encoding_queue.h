// Bytes of files, encoded in the background while the caller goes on.
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

/// Encoding takes long, so it happens in the background (see ThreadPool). What is done with the bytes happens on the
/// caller's thread, in the order in which it was asked for. So files and rows come in their order, and errors too.
///
/// Errors   what `encode` and `put` throw comes out of add() or finish(), the oldest first.
/// Memory   of at most max_pending() jobs, which together hold at most kMaxBytes: or of one that holds more.
/// Threads  one thread calls; `encode` runs on any.
class EncodingQueue {
 public:
  using Encode = std::function<std::string()>;
  using Put = std::function<void(std::string_view bytes)>;
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

  explicit EncodingQueue(std::shared_ptr<ThreadPool> pool);
  /// Drops what has not been put.
  ~EncodingQueue();
  EncodingQueue(const EncodingQueue&) = delete;
  EncodingQueue& operator=(const EncodingQueue&) = delete;

  /// `held_bytes` are those of the copies that `encode` works on. Puts what is ready; where too much is pending, waits
  /// for the oldest.
  void add(Encode encode, std::size_t held_bytes, Put put);
  /// Puts all.
  void finish();

  std::size_t max_pending() const;

 private:
  struct Pending {
    std::shared_ptr<BackgroundTask> task;
    std::shared_ptr<std::string> bytes;  // once the task is done
    std::size_t held_bytes;
    Put put;
  };
  void put_oldest();

  std::shared_ptr<ThreadPool> pool_;
  std::deque<Pending> pending_;
  std::size_t held_bytes_ = 0;  // by all of them
};

}  // namespace simvis
