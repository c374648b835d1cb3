#include "messages/recorder.h"

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

Recorder::Recorder(const std::filesystem::path& file) : file_(file), thread_([this] { run(); }) {}

Recorder::~Recorder() {
  try {
    finish();
  } catch (const Error&) {  // whoever wants to know calls finish()
  }
}

bool Recorder::add(std::size_t held_bytes, WhenFull when_full, Job job) {
  std::unique_lock lock(mutex_);
  const auto fits = [&] { return held_bytes_ == 0 || held_bytes_ + held_bytes <= kMaxBytes || failure_; };
  if (when_full == WhenFull::wait) changed_.wait(lock, fits);
  throw_failure();
  if (when_full == WhenFull::drop && !fits()) return false;
  waiting_.push_back({held_bytes, std::move(job)});
  held_bytes_ += held_bytes;
  changed_.notify_all();
  return true;
}

void Recorder::finish() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  const std::lock_guard lock(mutex_);
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

// After a failure the thread ends; what waits is dropped with the recorder.
void Recorder::run() {
  lower_thread_priority();
  try {
    for (;;) {
      Waiting next;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
        if (waiting_.empty()) break;
        next = std::move(waiting_.front());
        waiting_.pop_front();
      }
      next.job(file_);
      next.job = nullptr;  // frees what it holds
      const std::lock_guard lock(mutex_);
      held_bytes_ -= next.held_bytes;
      messages_ = file_.writer().messages();
      bytes_ = file_.writer().bytes();
      changed_.notify_all();
    }
    file_.writer().finish();
    const std::lock_guard lock(mutex_);
    bytes_ = file_.writer().bytes();
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    changed_.notify_all();
  }
}

}  // namespace simvis::ros
