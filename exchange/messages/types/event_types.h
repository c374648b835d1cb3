// Messages of event_camera_msgs (github.com/ros-event-camera/event_camera_msgs).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct EventPacket {
  static constexpr std::string_view kName = "event_camera_msgs/msg/EventPacket";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::uint64_t seq = 0;        ///< counts packets, so that a lost one is noticed
  std::uint64_t time_base = 0;  ///< nanoseconds that are added to the times of the events
  std::string encoding;         ///< "evt3"
  bool is_bigendian = false;
  std::vector<std::uint8_t> events;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &EventPacket::header},
                      Field{"height", &EventPacket::height},
                      Field{"width", &EventPacket::width},
                      Field{"seq", &EventPacket::seq},
                      Field{"time_base", &EventPacket::time_base},
                      Field{"encoding", &EventPacket::encoding},
                      Field{"is_bigendian", &EventPacket::is_bigendian},
                      Field{"events", &EventPacket::events}};
  }
};

}  // namespace simvis::ros
