// A consumer of frames: a file, a network, other processes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "simvis/frame.h"

namespace simvis {

/// Frames come in order, each at most once. An outlet whose frame() has thrown is destroyed and gets no further frames.
class FrameOutlet {
 public:
  FrameOutlet() = default;
  virtual ~FrameOutlet() = default;
  FrameOutlet(const FrameOutlet&) = delete;
  FrameOutlet& operator=(const FrameOutlet&) = delete;

  /// The outlet in messages: "recording".
  virtual std::string_view name() const = 0;
  /// The stage of a step that its time belongs to; the text is valid for the rest of the program.
  virtual std::string_view stage() const = 0;
  /// Called after each change of the scene, before it is kept. Throws InputError if the outlet cannot take frames of
  /// this scene; the change is undone then.
  virtual void check(const BuiltScene& /*scene*/) const {}
  /// Throws if the outlet cannot go on.
  virtual void frame(const Frame& frame) = 0;
  /// No frame follows, although more were wanted. The outlet then does not warn of what a later frame could have had.
  virtual void end_early() {}
  /// Warnings since the last call.
  virtual std::vector<std::string> take_warnings() { return {}; }
};

}  // namespace simvis
