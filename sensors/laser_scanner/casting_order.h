// In which order the beams of a laser scanner are cast.
#pragma once

#include <cstdint>
#include <vector>

#include "sensors/laser_scanner/scan_layout.h"

namespace simvis {

/// All beams, [ring * samples + beam]: each RayCaster::kPacketSize of them are neighbours along and across the rings,
/// so that they see much the same; what is left over at the ends of rings comes last. A single ring's are in their own
/// order.
std::vector<std::uint32_t> casting_order(const ScanPattern& pattern);

}  // namespace simvis
