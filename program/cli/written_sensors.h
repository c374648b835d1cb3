// The sensors whose results a run writes.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "program/output/output_writer.h"

namespace simvis {

/// Sensors of the scene file write files. Those that clients add while it runs have the shared memory.
class WrittenSensors {
 public:
  void start(std::set<std::string> names, const Simulation& simulation);
  /// A sensor that was removed writes nothing more, even if another sensor gets its name.
  void follow(const Simulation& simulation);
  bool contains(const std::string& name) const { return names_.contains(name); }

 private:
  std::set<std::string> names_;
  std::size_t changes_ = 0;
};

/// Writes what was measured in the last frame, and the poses of `parts`.
void write_results(const std::vector<std::string>& parts, const Simulation& simulation, const WrittenSensors& written,
                   const FrameTime& time, OutputWriter& writer);

/// The lines of randomized.csv for a frame: "FRAME,ELEMENT,PARAMETER,VALUE". Empty if nothing is drawn.
std::string drawn_lines(const Simulation& simulation, const FrameTime& time);

}  // namespace simvis
