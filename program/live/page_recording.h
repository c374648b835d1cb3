// The frames of a simulation, as it makes them, as one page.
#pragma once

#include <filesystem>
#include <utility>

#include <simvis/simulation.h>
#include "program/live/page_file.h"
#include "program/live/view_snapshot.h"

namespace simvis::live {

/// Errors   MachineError of the file. It appears whole, with finish(), or not at all.
/// Threads  that of the simulation.
class PageRecording {
 public:
  explicit PageRecording(std::filesystem::path file) : page_(std::move(file)) {}

  /// Adds the frame of the last step, with what all sensors measured. It has no time by the clock, so that two runs of
  /// the same scene write the same bytes.
  void add(Simulation& simulation, const FrameTime& time) {
    page_.add(copier_.copy(simulation, time, 0, {.every_sensor = true, .physics = true, .plan = true, .times = false}));
    has_frames_ = true;
  }
  bool has_frames() const { return has_frames_; }
  void finish() { page_.finish(); }

 private:
  PageFile page_;
  ViewCopier copier_;
  bool has_frames_ = false;
};

}  // namespace simvis::live
