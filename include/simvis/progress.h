// Progress reports of long one-time work.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

namespace simvis {

/// How far a piece of work is.
struct Progress {
  std::string_view work;   ///< for people: "reading parts"; static text
  std::uint64_t done = 0,  ///< finished amount, in units of the work; at most `total`
      total = 0;           ///< whole amount, above 0
};

/// Called between two steps of the work.
///
/// Errors   an exception that it throws ends the work.
/// Threads  called in the thread that does the work.
using ProgressCallback = std::function<void(const Progress&)>;

}  // namespace simvis
