// The laser scanner of a scene that a recording is compared with.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/scan.h>

namespace simvis {

/// `list` and `scan` must live during the call that gets it.
struct ComparedScanner {
  std::string name;
  const DrawList* list = nullptr;       ///< of the frame in which it measured
  std::vector<std::uint32_t> unseen{};  ///< items of the list that the scanner does not see, ascending
  const Scan* scan = nullptr;           ///< its measurement
  double range_min_m = 0, range_max_m = 0;
};

}  // namespace simvis
