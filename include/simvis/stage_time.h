// The times at which the stages of a step began and ended.
#pragma once

#include <cstdint>
#include <string_view>

namespace simvis {

/// One stage of a step, on the steady clock. "render" ends when the GPU has finished and host-only ray casts are
/// complete; with step_async() it includes what the caller did between the two halves.
struct StageTime {
  std::string_view name;      ///< "elements", "flatten", "plan", "render", "collect" or "visualization"
  std::int64_t start_ns = 0,  ///< begin of the stage
      end_ns = 0;             ///< end of the stage
};

}  // namespace simvis
