// Where messages go: to a file, or to a network.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "messages/cdr.h"
#include "messages/description.h"

namespace simvis::ros {

/// How long subscribers may find a message: while they listen, or later too.
enum class Durability : std::uint8_t { transient, latched };

/// Takes encoded messages. A topic always has the same type.
/// Errors   MachineError.
/// Threads  one thread at a time.
class MessageOutlet {
 public:
  MessageOutlet() = default;
  MessageOutlet(const MessageOutlet&) = delete;
  MessageOutlet& operator=(const MessageOutlet&) = delete;
  virtual ~MessageOutlet() = default;

  template <Message M>
  void write(const std::string& topic, std::int64_t time_ns, const M& message,
             Durability durability = Durability::transient) {
    bytes_.clear();
    encode(message, bytes_);
    write_bytes(topic, describe<M>(), durability, time_ns, bytes_);
  }
  /// Nothing is written afterwards.
  virtual void finish() = 0;

  virtual std::uint64_t messages() const = 0;  ///< written so far
  virtual std::uint64_t bytes() const = 0;     ///< of all that was written so far

 private:
  /// `type` lives as long as the program.
  virtual void write_bytes(const std::string& topic, const TypeDescription& type, Durability durability,
                           std::int64_t time_ns, std::string_view message) = 0;

  std::string bytes_;
};

}  // namespace simvis::ros
