// The columns of a beam table whose file describes one column.
#pragma once

#include <cstdint>

namespace simvis {

/// The columns of a turn, for files that describe the lasers of a column only: azimuths of equal steps from `first_deg`
/// to `last_deg`, both included.
struct TableColumns {
  std::uint32_t count = 1;
  double first_deg = 0, last_deg = 0;
};

}  // namespace simvis
