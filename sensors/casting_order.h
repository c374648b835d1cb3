// In which order the beams of a laser scanner are cast.
#pragma once

#include <cstdint>
#include <vector>

#include "sensors/scan_layout.h"

namespace simvis {

/// All beams, [ring * samples + beam]: neighbours along and across the rings one after another, so that those who
/// travel together (see RayCaster::kTogether) see much the same. A single ring's are in their own order.
std::vector<std::uint32_t> casting_order(const ScanPattern& pattern);

}  // namespace simvis
