// The destination of the messages of a simulation: a file or listeners.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "exchange/messages/cdr.h"
#include "exchange/messages/description.h"
#include "exchange/messages/topics.h"

namespace simvis::ros {

/// How long subscribers may find a message.
enum class Durability : std::uint8_t {
  transient,  ///< while they listen
  latched,    ///< later too, if it is the last one of its topic
  log         ///< later too, with all others of its topic, none of which is ever lost
};

/// A topic. It always has the same type and durability.
struct Topic {
  std::string name;
  const TypeDescription* type = nullptr;  ///< valid for the rest of the program
  Durability durability = Durability::transient;
};

/// Takes encoded messages.
class MessageSink {
 public:
  MessageSink() = default;
  virtual ~MessageSink() = default;
  MessageSink(const MessageSink&) = delete;
  MessageSink& operator=(const MessageSink&) = delete;

  template <Message M>
  void write(const std::string& topic, std::int64_t time_ns, const M& message,
             Durability durability = Durability::transient) {
    bytes_.clear();
    encode(message, bytes_);
    put({topic, &describe<M>(), durability}, time_ns, bytes_);
  }

  /// Whether a message that is written now has a reader; one that is not need not be made.
  template <Message M>
  bool is_read(const std::string& topic) {
    return is_read({topic, &describe<M>()});
  }

 protected:
  virtual bool is_read(const Topic&) { return true; }
  /// `bytes` is in CDR.
  virtual void put(const Topic& topic, std::int64_t time_ns, std::string_view bytes) = 0;

 private:
  std::string bytes_;
};

/// Fills, encodes and writes messages.
struct MessageJob {
  /// A measurement may be left out where there is no room for it; what says how objects are may not.
  enum class Kind : std::uint8_t { state, measurement } kind = Kind::state;
  std::size_t held_bytes = 0;  ///< size of the copies and kept images that the job works on
  std::uint64_t messages = 1;  ///< that it writes
  std::function<void(MessageSink&)> run;
};

/// Decides which topics are wanted, and runs jobs in the order in which they come, at once or later, on any one thread.
class MessageOutlet {
 public:
  virtual ~MessageOutlet() = default;
  virtual bool wants(const Topic& topic, TopicForm form) = 0;
  /// Returns false if a measurement is left out.
  virtual bool add(MessageJob job) = 0;

  template <Message M>
  bool wants(const std::string& topic, TopicForm form = TopicForm::own, Durability durability = Durability::transient) {
    return wants(Topic{topic, &describe<M>(), durability}, form);
  }
};

}  // namespace simvis::ros
