// What a run writes for people to look at: --export and --page.
#pragma once

#include <optional>
#include <string>

#include <simvis/simulation.h>
#include "live/page_recording.h"
#include "simvis/output/atomic_file.h"

namespace simvis {

/// Removes the temporary files of killed runs that were to become the file, which an option names. Throws InputError as
/// output_target().
void remove_leftovers_of_target(const std::string& file);

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
  std::optional<AtomicFile> glb_;
  std::optional<live::PageRecording> page_;
  bool has_frames_ = false;
};

}  // namespace simvis
