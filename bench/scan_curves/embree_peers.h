// Bare Embree as a way to scans: single precision, one flat mesh in which nothing moves, no bounds.
#pragma once

#include <vector>

#include <simvis/draw_list.h>
#include "bench/scan_curves/peer_scans.h"
#include "bench/scan_curves/ways.h"

namespace simvis::bench {

/// rtcIntersect1 in a loop, and packets of 16, each on one thread and on two. From where the scanners are, frame by
/// frame; rays in the world are ready when the clock starts. `scans` must outlive them.
std::vector<Way> embree_ways(const DrawList& list, PeerScans& scans);

}  // namespace simvis::bench
