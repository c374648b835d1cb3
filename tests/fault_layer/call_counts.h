// The calls of one instance or device: how many there were, and which of them are made to fail.
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tests/fault_layer/settings.h"

namespace simvis::faults {

/// The functions of commands.inc, by index.
struct Command {
  std::string_view name;
  std::string_view results;  ///< as in the table
};
inline constexpr Command kCommands[] = {
#define SIMVIS_COMMAND(name, ...) {#name, #__VA_ARGS__},
#include "tests/fault_layer/commands.inc"
#undef SIMVIS_COMMAND
};
inline constexpr std::size_t kCommandCount = std::size(kCommands);

consteval std::size_t index_of(std::string_view name) {
  for (std::size_t i = 0; i < kCommandCount; ++i) {
    if (kCommands[i].name == name) return i;
  }
  throw "no such command";
}

/// Threads  any.
class CallCounts {
 public:
  explicit CallCounts(const std::vector<Fault>& faults) : faults_(faults) {}

  struct Outcome {
    std::optional<VkResult> result;  ///< what the call returns instead of reaching the driver; empty: it reaches it
    std::chrono::milliseconds delay{};
  };
  /// Counts a call. A lost device stays lost: after VK_ERROR_DEVICE_LOST all functions that may return it do so.
  Outcome next(std::size_t command);

  std::uint64_t count(std::size_t command) const { return counts_[command]; }
  std::uint64_t failed() const { return failed_; }  ///< calls of which a fault decided the result
  bool lost() const { return lost_; }

 private:
  const std::vector<Fault> faults_;
  std::atomic<std::uint64_t> counts_[kCommandCount] = {};
  std::atomic<std::uint64_t> failed_ = 0;
  std::atomic<bool> lost_ = false;
};

}  // namespace simvis::faults
