// When the stages of a step began and ended.
#pragma once

#include <cstdint>
#include <string_view>

namespace simvis {

/// One stage of a step, on the steady clock. "render" ends when the device has done, and what casts alone has cast;
/// with step_async() the caller's own work lies in it.
struct StageTime {
  std::string_view name;  ///< "elements", "flatten", "plan", "render", "collect" or "visualization"
  std::int64_t start_ns = 0, end_ns = 0;
};

}  // namespace simvis
