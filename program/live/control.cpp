#include "program/live/control.h"

#include <algorithm>

namespace simvis::live {
namespace {

std::size_t size_of(const Control& control) {
  return sizeof control + control.text.size() + control.values.size() * sizeof control.values.front();
}

}  // namespace

bool ControlQueue::replaces_last(const Control& control) const {
  if (waiting_.empty() || control.kind != waiting_.back().kind || control.client != waiting_.back().client)
    return false;
  if (control.kind == Control::Kind::look || control.kind == Control::Kind::pull) return true;
  const Control& last = waiting_.back();
  return control.kind == Control::Kind::set && last.request.empty() &&
         std::ranges::equal(control.values, last.values, {}, &std::pair<std::size_t, double>::first,
                            &std::pair<std::size_t, double>::first);
}

bool ControlQueue::add(Control control) {
  {
    const std::lock_guard lock(mutex_);
    if (replaces_last(control)) {
      waiting_.back() = std::move(control);
    } else if (waiting_.size() >= kMaxWaiting || bytes_ + size_of(control) > kMaxBytes) {
      return false;
    } else {
      bytes_ += size_of(control);
      waiting_.push_back(std::move(control));
    }
  }
  added_.notify_one();
  return true;
}

std::optional<Control> ControlQueue::next(std::optional<std::chrono::steady_clock::time_point> until) {
  std::unique_lock lock(mutex_);
  if (until) added_.wait_until(lock, *until, [this] { return !waiting_.empty(); });
  if (waiting_.empty()) return std::nullopt;
  Control control = std::move(waiting_.front());
  waiting_.pop_front();
  bytes_ -= size_of(control);
  return control;
}

}  // namespace simvis::live
