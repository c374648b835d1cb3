// The start and end times of the stages of a step.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include <simvis/step_costs.h>
#include "engine/base/now_ns.h"

namespace simvis {

/// Each stage ends when the next one begins.
class StepStages {
 public:
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
