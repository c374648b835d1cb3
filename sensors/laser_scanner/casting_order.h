// The order in which the beams of a laser scanner are cast.
#pragma once

#include <cstdint>
#include <vector>

#include "sensors/laser_scanner/scan_layout.h"

namespace simvis {

/// Returns all beams, [ring * beams + beam]. The RayCaster::kPacketSize beams of each group are neighbours along and
/// across the rings, so their rays hit nearby surfaces. Beams left over at the ends of rings come last. The beams of a
/// single ring keep their order.
std::vector<std::uint32_t> casting_order(const ScanPattern& pattern);

}  // namespace simvis
