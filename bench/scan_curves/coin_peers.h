// How the 2009 SimVis3D paper came to ranges, on today's machine: Coin, which it was built on.
#pragma once

#include <vector>

#include <simvis/draw_list.h>
#include "bench/scan_curves/peer_scans.h"
#include "bench/scan_curves/ways.h"

namespace simvis::bench {

/// Coin's ray pick, beam by beam; and its scene drawn by OpenGL off screen, on a surfaceless EGL display, with depth
/// read back: per scan one view of 90 degrees for each quarter of its circle, each as wide as the scan has beams and
/// one row high, the nearest pixel taken. Of scans of one ring. Nothing moves, the scanners neither.
std::vector<Way> coin_ways(const DrawList& list, const std::vector<PeerScan>& scans);

}  // namespace simvis::bench
