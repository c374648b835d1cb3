// The laser scanner of a scene that a recording is compared with.
#pragma once

#include <string>

#include <simvis/draw_list.h>
#include <simvis/scan.h>

namespace simvis {

/// `list` and `scan` must live during the call that gets it.
struct ComparedScanner {
  std::string name;
  const DrawList* list = nullptr;  ///< of the frame in which it measured
  const Scan* scan = nullptr;      ///< its measurement
  double range_min_m = 0, range_max_m = 0;
};

}  // namespace simvis
