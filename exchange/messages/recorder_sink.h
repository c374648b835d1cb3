// What a recorder writes to: a file, or a network.
#pragma once

#include <cstdint>

#include "exchange/messages/message_outlet.h"

namespace simvis::ros {

/// Errors   MachineError.
/// Threads  one thread at a time.
class RecorderSink : public MessageSink {
 public:
  /// Nothing is written afterwards.
  virtual void finish() = 0;

  virtual std::uint64_t messages() const = 0;  ///< written so far
  virtual std::uint64_t bytes() const = 0;     ///< of all that was written so far
};

}  // namespace simvis::ros
