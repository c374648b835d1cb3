// What a run writes for people to look at: --export and --page.
#pragma once

#include <optional>
#include <string>

#include <simvis/simulation.h>
#include "engine/base/result_lock.h"
#include "program/live/page_recording.h"
#include "program/output/atomic_file.h"

namespace simvis {

/// Files appear with finish(), or not at all. Errors: MachineError, also of the constructor.
class ViewFiles {
 public:
  /// Empty names: no such file.
  ViewFiles(const std::string& glb, const std::string& page);

  bool any() const { return glb_ || page_; }
  /// After a step.
  void add(Simulation& simulation, const FrameTime& time);
  void finish(const Simulation& simulation);

 private:
  std::optional<ResultLock> glb_lock_;
  std::optional<AtomicFile> glb_;
  std::optional<live::PageRecording> page_;
  bool has_frames_ = false;
};

}  // namespace simvis
