// The messages of a simulation, sent to an object of the program.
#pragma once

#include <string_view>

#include "simvis/frame_messages.h"
#include "simvis/sharing/frame_outlet.h"

namespace simvis {

class SentMessages : public FrameOutlet {
 public:
  /// `outlet` must outlive this object. Throws InputError as check_messages().
  SentMessages(ros::MessageOutlet& outlet, const BuiltScene& scene) : messages_(outlet, scene) {}

  std::string_view name() const override { return "messages"; }
  std::string_view stage() const override { return "messages"; }
  void check(const BuiltScene& scene) const override { check_messages(scene); }
  void frame(const Frame& frame) override { messages_.add_frame(frame); }

 private:
  FrameMessages messages_;
};

}  // namespace simvis
