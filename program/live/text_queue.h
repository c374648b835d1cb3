// Messages to one client that must not be lost.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <simvis/error.h>
#include "program/live/server.h"

namespace simvis::live {

class TextQueue {
 public:
  /// A client that lets so much wait is closed. The description of a scene of 10,000 parts is a tenth of it.
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

  void add(std::string text) {
    if (overflows_) return;
    bytes_ += text.size();
    overflows_ = bytes_ > kMaxBytes;
    waiting_.push_back(std::move(text));
  }
  /// Throws InputError if too much has waited.
  std::optional<WireMessage> next() {
    if (overflows_) throw InputError("the client reads too slowly");
    if (waiting_.empty()) return std::nullopt;
    WireMessage message{.binary = false, .head = std::move(waiting_.front()), .body = nullptr};
    waiting_.pop_front();
    bytes_ -= message.head.size();
    return message;
  }

 private:
  std::deque<std::string> waiting_;
  std::size_t bytes_ = 0;
  bool overflows_ = false;
};

}  // namespace simvis::live
