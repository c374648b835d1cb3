// When the stages of a step began and ended.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <simvis/stage_time.h>

namespace simvis {

/// Each stage ends where the next begins.
class StepStages {
 public:
  /// By a clock that never goes back.
  static std::int64_t now_ns() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
  }

  void clear() { stages_.clear(); }
  void begin(std::string_view name) {
    end();
    stages_.push_back({name, now_ns(), 0});
  }
  void end() {
    if (!stages_.empty() && stages_.back().end_ns == 0) stages_.back().end_ns = now_ns();
  }
  std::span<const StageTime> times() const { return stages_; }

 private:
  std::vector<StageTime> stages_;
};

}  // namespace simvis
