// Messages of SimVis's own, from which a follower on another machine makes the scene of a host.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/output_types.h"

namespace simvis::ros {

/// Commands that the host has executed, in order. All messages of a host together are its log from the start.
struct ChangeLog {
  static constexpr std::string_view kName = "simvis_msgs/msg/ChangeLog";
  std::uint64_t host = 0;             ///< the sender: a host that begins later has a larger number
  std::uint64_t first = 0;            ///< number of commands in earlier messages
  std::uint64_t frame = 0;            ///< the first that is made with these commands
  std::vector<std::string> commands;  ///< each in the form of a scene file
  static constexpr auto field_table() {
    return std::tuple{Field{"host", &ChangeLog::host}, Field{"first", &ChangeLog::first},
                      Field{"frame", &ChangeLog::frame}, Field{"commands", &ChangeLog::commands}};
  }
};

/// A frame that the host has finished.
struct HostFrame {
  static constexpr std::string_view kName = "simvis_msgs/msg/HostFrame";
  std::uint64_t host = 0;
  std::string name;            ///< under which the host is served
  std::uint64_t frame = 0;     ///< its index
  std::int64_t time_ns = 0;    ///< simulated
  std::uint64_t changes = 0;   ///< number of commands that it is made with
  std::vector<double> values;  ///< of all parameters, removed ones included
  static constexpr auto field_table() {
    return std::tuple{Field{"host", &HostFrame::host},       Field{"name", &HostFrame::name},
                      Field{"frame", &HostFrame::frame},     Field{"time_ns", &HostFrame::time_ns},
                      Field{"changes", &HostFrame::changes}, Field{"values", &HostFrame::values}};
  }
};

/// What a sensor of the host has measured.
struct HostMeasurement {
  static constexpr std::string_view kName = "simvis_msgs/msg/HostMeasurement";
  std::uint64_t host = 0;
  std::int64_t time_ns = 0;
  std::array<double, 16> world_from_sensor{};  ///< column by column
  std::vector<Output> outputs;
  static constexpr auto field_table() {
    return std::tuple{Field{"host", &HostMeasurement::host}, Field{"time_ns", &HostMeasurement::time_ns},
                      Field{"world_from_sensor", &HostMeasurement::world_from_sensor},
                      Field{"outputs", &HostMeasurement::outputs}};
  }
};

}  // namespace simvis::ros
