// The methods of the 2009 SimVis3D paper on today's hardware, with Coin, on which SimVis3D was built.
#pragma once

#include <vector>

#include <simvis/draw_list.h>
#include "bench/scan_curves/methods.h"
#include "bench/scan_curves/peer_scans.h"

namespace simvis::bench {

/// Two methods for scans of one ring: Coin's ray pick, beam by beam; and Coin's scene drawn off screen by OpenGL on a
/// surfaceless EGL display, with depth read back. The latter draws one view of 90 degrees for each quarter of a scan's
/// circle, each as wide as the scan has beams and one row high, and takes the nearest pixel. Neither the scene nor the
/// scanners move.
std::vector<Method> coin_methods(const DrawList& list, const std::vector<PeerScan>& scans);

}  // namespace simvis::bench
