// Bare Embree as a way to scans: single precision, one flat mesh, nothing moves, no bounds.
#pragma once

#include <vector>

#include "bench/scan_curves/still_scans.h"
#include "bench/scan_curves/ways.h"
#include "engine/draw_list.h"

namespace simvis::bench {

/// rtcIntersect1 in a loop, and packets of 16, each on one thread and on two.
std::vector<Way> embree_ways(const DrawList& list, const std::vector<StillScan>& scans);

}  // namespace simvis::bench
