// How far work is that is done once and may take long.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

namespace simvis {

struct Progress {
  std::string_view work;              ///< for people: "reading parts"; static text
  std::uint64_t done = 0, total = 0;  ///< of the work, in units of its own; done <= total, total > 0
};

/// Called between two pieces of the work, in the thread that does it. What it throws ends the work.
using ProgressCallback = std::function<void(const Progress&)>;

}  // namespace simvis
