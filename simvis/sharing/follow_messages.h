// A simulation for followers on other machines: its log of changes, the values of each frame, and its measurements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "exchange/messages/message_outlet.h"
#include "simvis/frame_messages.h"
#include "simvis/scene_builder.h"

namespace simvis {

/// Topics of a simulation that is served as `name`, or of one of its sensors: NAME/SENSOR.
std::string follow_topic(std::string_view name, std::string_view what);
inline constexpr std::string_view kFollowLog = "changes", kFollowFrame = "frame", kFollowMeasurement = "measured";
/// Where it takes values and change requests that are for it alone.
inline constexpr std::string_view kFollowSet = "set", kFollowRequest = "request";

class FollowMessages {
 public:
  /// `outlet` must outlive this object.
  FollowMessages(ros::MessageOutlet& outlet, std::string name);

  /// Throws what the outlet throws.
  void add_frame(const BuiltScene& scene, const FrameTime& time, std::span<const PlacedSensor> sensors);

 private:
  void add_changes(const std::vector<std::string>& changes, const FrameTime& time);
  void add_measurement(const PlacedSensor& placed, const FrameTime& time);

  ros::MessageOutlet& outlet_;
  std::string name_;
  std::uint64_t host_;
  std::size_t sent_changes_ = 0;
};

}  // namespace simvis
