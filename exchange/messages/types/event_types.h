// Messages of event_camera_msgs (github.com/ros-event-camera/event_camera_msgs).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct EventPacket {
  SIMVIS_MESSAGE("event_camera_msgs/msg/EventPacket", header, height, width, seq, time_base, encoding, is_bigendian,
                 events);
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::uint64_t seq = 0;        ///< counts packets, so that a lost one is noticed
  std::uint64_t time_base = 0;  ///< nanoseconds that are added to the times of the events
  std::string encoding;         ///< "evt3"
  bool is_bigendian = false;
  std::vector<std::uint8_t> events;
};

}  // namespace simvis::ros
