// The order in which the beams of a beam table are cast.
#pragma once

#include <cstdint>
#include <vector>

namespace simvis {

struct ScanBeams;

/// Returns all beams, [ring * beams + beam], so that the beams of each packet are neighbours that start close to each
/// other. Of several orders it is the one whose packets are expected to cost the least.
std::vector<std::uint32_t> table_order(const ScanBeams& beams);

}  // namespace simvis
