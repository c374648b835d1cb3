#include "simvis/output/encoding_queue.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace simvis {

namespace {

// Encoding a picture takes some times as long as rendering it does: more would find nothing to do.
constexpr unsigned kMaxThreads = 8;
// Where cores are few, encoding fills the time that rendering leaves them, and not the other way round.
constexpr int kNiceness = 10;

}  // namespace

EncodingQueue::EncodingQueue() : cores_(std::clamp(std::thread::hardware_concurrency(), 1u, kMaxThreads)) {}

EncodingQueue::~EncodingQueue() {
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    ending_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void EncodingQueue::add(Encode encode, std::size_t held_bytes, Put put) {
  const auto ready = [](const Pending& job) {
    return job.bytes.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  };
  const auto too_much = [&] { return pending_.size() >= max_pending() || held_bytes_ + held_bytes > kMaxBytes; };
  while (!pending_.empty() && (too_much() || ready(pending_.front()))) put_oldest();
  while (threads_.size() < cores_) threads_.emplace_back([this] { work(); });
  pending_.push_back({encode.get_future(), held_bytes, std::move(put)});
  held_bytes_ += held_bytes;
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(encode));
  }
  changed_.notify_one();
}

void EncodingQueue::finish() {
  while (!pending_.empty()) put_oldest();
}

void EncodingQueue::put_oldest() {
  Pending oldest = std::move(pending_.front());
  pending_.pop_front();
  held_bytes_ -= oldest.held_bytes;
  oldest.put(oldest.bytes.get());
}

void EncodingQueue::work() {
  ::setpriority(PRIO_PROCESS, 0, ::getpriority(PRIO_PROCESS, 0) + kNiceness);  // on Linux: of this thread alone
  while (true) {
    Encode encode;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      encode = std::move(waiting_.front());
      waiting_.pop_front();
    }
    encode();
  }
}

}  // namespace simvis
