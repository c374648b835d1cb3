#include "program/output/encoding_queue.h"

#include <utility>

#include "engine/base/thread_pool.h"

namespace simvis {

EncodingQueue::EncodingQueue(std::shared_ptr<ThreadPool> pool) : pool_(std::move(pool)) {}

EncodingQueue::~EncodingQueue() { drop(); }

// For each thread, including the caller's: one job being encoded and one waiting.
std::size_t EncodingQueue::max_pending() const { return 2 * (std::size_t{pool_->background_threads()} + 1); }

void EncodingQueue::add(Encode encode, std::size_t held_bytes, Put put) {
  const auto must_put = [&] {
    if (held_bytes_ + held_bytes > kMaxBytes) return true;
    return !held_ && (pending_.size() >= max_pending() || pending_.front().task->done());
  };
  while (!pending_.empty() && must_put()) put_oldest();
  const auto bytes = std::make_shared<std::string>();
  std::shared_ptr<BackgroundTask> task =
      pool_->run_in_background([encode = std::move(encode), bytes] { *bytes = encode(); });
  pending_.push_back({std::move(task), bytes, held_bytes, std::move(put)});
  held_bytes_ += held_bytes;
}

void EncodingQueue::finish() {
  while (!pending_.empty()) put_oldest();
}

void EncodingQueue::put_oldest() {
  const Pending oldest = std::move(pending_.front());
  pending_.pop_front();
  held_bytes_ -= oldest.held_bytes;
  try {
    oldest.task->finish();
    oldest.put(*oldest.bytes);
  } catch (...) {
    drop();
    throw;
  }
}

void EncodingQueue::drop() {
  for (const Pending& each : pending_) each.task->cancel();
  pending_.clear();
  held_bytes_ = 0;
}

}  // namespace simvis
