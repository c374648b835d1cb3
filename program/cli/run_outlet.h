// A consumer of the frames of a run: its files, a dataset, a recording, a page, the live view, a profile.
#pragma once

#include <simvis/frame_time.h>

namespace simvis {

/// A run calls its outlets in their order, and destroys them in the reverse order. An exception of an outlet ends the
/// run.
class RunOutlet {
 public:
  RunOutlet() = default;
  virtual ~RunOutlet() = default;
  RunOutlet(const RunOutlet&) = delete;
  RunOutlet& operator=(const RunOutlet&) = delete;

  /// Before the first frame that the outlet gets is made.
  virtual void begin() {}
  /// Takes the frame that the simulation has just made.
  virtual void frame(const FrameTime& time) = 0;
  /// After the last frame: files appear.
  virtual void finish() {}
  /// After an exception: keeps what is whole. What this throws is lost, since the first exception is the one to report.
  virtual void fail() {}
  /// Returns whether time may go back from one frame to the next. It does after a reset.
  virtual bool can_go_back() const { return false; }
  /// Whether it shows shapes and pictures that no sensor needs.
  virtual bool shows_all_content() const { return false; }
};

}  // namespace simvis
