// The messages of a simulation, sent to an object of the program.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "simvis/frame_messages.h"
#include "simvis/sharing/frame_outlet.h"

namespace simvis {

class SentMessages : public FrameOutlet {
 public:
  /// Throws InputError: two sensors would have the same topics.
  SentMessages(ros::MessageOutlet& outlet, const BuiltScene& scene) : messages_(std::in_place, outlet, scene) {}

  std::string_view name() const override { return "messages"; }
  void check(const BuiltScene& scene) const override {
    if (messages_) check_messages(scene);
  }
  std::string_view stage() const override { return "messages"; }
  // Topics that clash do not end the run, because no file and no network of them was asked for.
  void frame(const Frame& frame) override try {
    if (messages_) messages_->add_frame(frame.scene, frame.time, frame.sensors);
  } catch (const InputError& error) {
    messages_.reset();
    warnings_.push_back(std::string("messages: none are sent any more: ") + error.what());
  }
  std::vector<std::string> take_warnings() override { return std::exchange(warnings_, {}); }

 private:
  std::optional<FrameMessages> messages_;  // empty: they have ended
  std::vector<std::string> warnings_;
};

}  // namespace simvis
