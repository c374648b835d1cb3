// The ways to a set of scans that are timed side by side, and how.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "bench/timing.h"

namespace simvis::bench {

struct Way {
  std::string name;           ///< the method, or who the peer is
  std::string max_error_rel;  ///< as in a scene; empty: it has none
  int threads = 0;            ///< of a peer; 0: SimVis, with as many as it likes
  std::function<void()> begin_turn = [] {};
  std::function<void(int frame)> move{};           ///< before each set, not timed; none: it measures in frame 0 only
  std::function<void()> set{};                     ///< one set of scans
  std::function<std::vector<float>()> ranges_m{};  ///< of the last set
  std::vector<Took> took{};
};

/// The ways of SimVis: each scanner of the list measures by each method. `move` takes the robot to where it is in a
/// frame. The simulation must outlive them.
std::vector<Way> simvis_ways(Simulation& simulation, const std::vector<std::string>& scanners,
                             const std::function<void(int frame)>& move);

/// Times all ways in turns, so that whatever else the machine does hits them alike, for about `seconds`. Each gets its
/// share of the time, and some sets at the least, or one if that takes many times as long.
void time_ways(std::vector<Way>& ways, double seconds);

}  // namespace simvis::bench
