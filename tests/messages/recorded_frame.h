// The messages of one frame of a scene.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <simvis/simulation.h>
#include "tests/messages/mcap_file.h"
#include "tests/support/temporary_folder.h"

namespace simvis::test {

/// Records the first frame; `topics` as RecordOptions::topics.
inline ros::test::McapFile recorded_frame(const std::string& commands, std::vector<std::string> topics = {}) {
  const TemporaryFolder folder;
  Simulation simulation = Simulation::from_string("<simvis>" + commands + "</simvis>");
  simulation.record({.file = folder / "run.mcap", .topics = std::move(topics)});
  simulation.step();
  simulation.finish_recording();
  return ros::test::McapReader::read(read_text(folder / "run.mcap"));
}

}  // namespace simvis::test
