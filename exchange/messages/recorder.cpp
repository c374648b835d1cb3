#include "exchange/messages/recorder.h"

#include <utility>

#include <simvis/error.h>
#include "engine/base/low_priority.h"

namespace simvis::ros {

void MessageFile::put(const Topic& topic, std::int64_t time_ns, std::string_view bytes) {
  auto found = channels_.find(topic.name);
  if (found == channels_.end()) {
    found = channels_.emplace(topic.name, writer_.add_channel(topic.name, *topic.type, topic.durability)).first;
  }
  writer_.write(found->second, time_ns, bytes);
}

Recorder::Recorder(std::unique_ptr<RecorderSink> sink) : sink_(std::move(sink)), thread_([this] { run(); }) {}

Recorder::~Recorder() {
  try {
    finish();
  } catch (...) {  // finish() reports errors; the destructor ignores them
  }
}

// A caller that has to wait runs jobs instead: the thread gets little time on a busy machine.
bool Recorder::add(std::size_t held_bytes, WhenFull when_full, Job job) {
  std::unique_lock lock(mutex_);
  const auto fits = [&] { return held_bytes_ == 0 || held_bytes_ + held_bytes <= kMaxBytes || failure_; };
  while (when_full == WhenFull::wait && !fits()) {
    if (!run_next(lock)) changed_.wait(lock);
  }
  throw_failure();
  if (when_full == WhenFull::drop && !fits()) return false;
  waiting_.push_back({held_bytes, std::move(job)});
  held_bytes_ += held_bytes;
  changed_.notify_all();
  return true;
}

void Recorder::finish() {
  std::unique_lock lock(mutex_);
  const bool is_first = !std::exchange(ends_, true);
  changed_.notify_all();
  while (!failure_ && (runs_ || !waiting_.empty())) {
    if (!run_next(lock)) changed_.wait(lock);
  }
  if (is_first && !failure_) {
    try {
      sink_->finish();
      bytes_ = sink_->bytes();
    } catch (...) {
      failure_ = std::current_exception();
    }
  }
  lock.unlock();
  if (thread_.joinable()) thread_.join();
  throw_failure();
}

std::uint64_t Recorder::messages() const {
  const std::lock_guard lock(mutex_);
  return messages_;
}

std::uint64_t Recorder::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

void Recorder::throw_failure() {
  if (failure_) std::rethrow_exception(failure_);
}

/// Runs the next job without the lock. Returns false if there is none, or one runs already.
bool Recorder::run_next(std::unique_lock<std::mutex>& lock) {
  if (runs_ || waiting_.empty() || failure_) return false;
  Waiting next = std::move(waiting_.front());
  waiting_.pop_front();
  runs_ = true;
  lock.unlock();
  std::exception_ptr failure;
  try {
    next.job(*sink_);
  } catch (...) {
    failure = std::current_exception();
  }
  next.job = nullptr;  // frees what it holds
  lock.lock();
  runs_ = false;
  failure_ = failure;
  held_bytes_ -= next.held_bytes;
  messages_ = sink_->messages();
  bytes_ = sink_->bytes();
  changed_.notify_all();
  return true;
}

// After a failure the thread ends; what waits is dropped with the recorder.
void Recorder::run() {
  lower_thread_priority();
  std::unique_lock lock(mutex_);
  while (!failure_ && (!ends_ || !waiting_.empty())) {
    if (!run_next(lock)) changed_.wait(lock);
  }
}

}  // namespace simvis::ros
