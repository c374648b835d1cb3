// Bytes of files, made on other cores while the caller goes on.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace simvis {

/// Encoding, which is dear, happens on threads of its own; what is done with the bytes happens on the caller's thread,
/// in the order in which it was asked for. So files and rows come in their order, and errors too.
///
/// Errors   what `encode` and `put` throw comes out of add() or finish(), the oldest first.
/// Memory   of at most most_pending() jobs, which together hold at most kMaxBytes: or of one that holds more.
/// Threading  one thread calls; `encode` runs on any. Threads are started by the first add().
class EncodingQueue {
 public:
  using Encode = std::packaged_task<std::string()>;
  using Put = std::function<void(std::string_view bytes)>;
  static constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

  EncodingQueue();
  /// Drops what has not been put.
  ~EncodingQueue();
  EncodingQueue(const EncodingQueue&) = delete;
  EncodingQueue& operator=(const EncodingQueue&) = delete;

  /// `held_bytes` are those of the copies that `encode` works on. Puts what is ready; where too much is pending, waits
  /// for the oldest.
  void add(Encode encode, std::size_t held_bytes, Put put);
  /// Puts all.
  void finish();

  std::size_t max_pending() const { return 2 * cores_; }

 private:
  struct Pending {
    std::future<std::string> bytes;
    std::size_t held_bytes;
    Put put;
  };
  void put_oldest();
  void work();

  std::size_t cores_;
  std::deque<Pending> pending_;  // of the caller's thread alone
  std::size_t held_bytes_ = 0;   // by all of them
  std::mutex mutex_;             // of the two below
  std::deque<Encode> waiting_;
  bool ending_ = false;
  std::condition_variable changed_;
  std::vector<std::thread> threads_;
};

}  // namespace simvis
