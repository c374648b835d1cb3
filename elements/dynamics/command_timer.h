// How long a command holds.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <simvis/attributes.h>
#include <simvis/state_archive.h>

namespace simvis {

/// The rows `timeout` and `command`, for the tables of elements that take commands.
inline constexpr AttributeSpec kCommandTimeoutRow{
    .name = "timeout",
    .default_value = "0.5",
    .unit = "s",
    .text =
        "simulated time for which a command holds; what drives then stops. A message with a stamp that is older, or "
        "so far in the future, is refused",
    .min = 0.001,
    .max = 1e6};
inline constexpr AttributeSpec kCommandRow{.name = "command",
                                           .default_value = "0",
                                           .text =
                                               "each new value is a command: the other parameters count from then "
                                               "on, for the time of timeout",
                                           .min = 0,
                                           .max = 1e15,
                                           .live = true};

/// Follows the parameter `command`.
class CommandTimer {
 public:
  explicit CommandTimer(double timeout_s) : timeout_ns_(static_cast<std::int64_t>(timeout_s * 1e9)) {}

  std::int64_t timeout_ns() const { return timeout_ns_; }
  void set(double command) {
    if (!taken_) taken_ = command;  // of the scene file
    command_ = command;
  }
  /// The value of the next command.
  double next() const { return command_ >= kCommandRow.max ? 0 : command_ + 1; }

  void archive(StateArchive& state) { state(taken_, until_ns_); }

  enum class Event { none, begins, ends };
  /// What happens at this time, once.
  Event at(std::int64_t time_ns) {
    if (taken_ && *taken_ != command_) {
      taken_ = command_;
      until_ns_ = time_ns + timeout_ns_;
      return Event::begins;
    }
    if (!until_ns_ || time_ns < *until_ns_) return Event::none;
    until_ns_.reset();
    return Event::ends;
  }

 private:
  std::int64_t timeout_ns_;
  double command_ = 0;
  std::optional<double> taken_;
  std::optional<std::int64_t> until_ns_;  // set while a command holds
};

}  // namespace simvis
