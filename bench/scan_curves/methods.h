// The methods for a set of scans that are timed side by side, and the timing.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "bench/timing.h"

namespace simvis::bench {

struct Method {
  std::string name;           ///< the method, or the name of the peer
  std::string max_error_rel;  ///< as in a scene; empty if the method has none
  int threads = 0;            ///< of a peer; 0: SimVis with its default number
  std::function<void()> begin_turn = [] {};
  std::function<void(int frame)> move{};  ///< called before each set, not timed; if empty, measures in frame 0 only
  std::function<void()> set{};            ///< one set of scans
  std::function<std::vector<float>()> ranges_m{};  ///< of the last set
  std::vector<Took> took{};
};

/// The methods of SimVis: each scanner of the list measures by each method. `move` moves the robot to its pose in a
/// frame. The simulation must outlive the result.
std::vector<Method> simvis_methods(Simulation& simulation, const std::vector<std::string>& scanners,
                                   const std::function<void(int frame)>& move);

/// Times all methods in turns for about `seconds`, so that other load on the machine affects all alike. Each method
/// gets its share of the time and measures a minimum number of sets, or one set if that takes many times the share.
void time_methods(std::vector<Method>& methods, double seconds);

}  // namespace simvis::bench
