// Bare Embree as a scan method for comparison: single precision, one flat static mesh, no bounds.
#pragma once

#include <vector>

#include <simvis/draw_list.h>
#include "bench/scan_curves/methods.h"
#include "bench/scan_curves/peer_scans.h"

namespace simvis::bench {

/// rtcIntersect1 in a loop, and packets of 16, each on one thread and on two threads, from the poses of the scanners
/// frame by frame. Rays are transformed to the world before the clock starts. `scans` must outlive the result.
std::vector<Method> embree_methods(const DrawList& list, PeerScans& scans);

}  // namespace simvis::bench
