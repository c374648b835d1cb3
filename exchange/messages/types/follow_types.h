// Messages of SimVis's own, from which a follower on another machine makes the scene of a host.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/output_types.h"

namespace simvis::ros {

/// Commands that the host has executed, in order. All messages of a host together are its log from the start.
struct ChangeLog {
  SIMVIS_MESSAGE("simvis_msgs/msg/ChangeLog", host, first, frame, commands);
  std::uint64_t host = 0;             ///< the sender: a host that begins later has a larger number
  std::uint64_t first = 0;            ///< number of commands in earlier messages
  std::uint64_t frame = 0;            ///< the first that is made with these commands
  std::vector<std::string> commands;  ///< each in the form of a scene file
};

/// A frame that the host has finished.
struct HostFrame {
  SIMVIS_MESSAGE("simvis_msgs/msg/HostFrame", host, name, frame, time_ns, changes, values);
  std::uint64_t host = 0;
  std::string name;            ///< under which the host is served
  std::uint64_t frame = 0;     ///< its index
  std::int64_t time_ns = 0;    ///< simulated
  std::uint64_t changes = 0;   ///< number of commands that it is made with
  std::vector<double> values;  ///< of all parameters, removed ones included
};

/// What a sensor of the host has measured.
struct HostMeasurement {
  SIMVIS_MESSAGE("simvis_msgs/msg/HostMeasurement", host, time_ns, world_from_sensor, outputs);
  std::uint64_t host = 0;
  std::int64_t time_ns = 0;
  std::array<double, 16> world_from_sensor{};  ///< column by column
  std::vector<Output> outputs;
};

}  // namespace simvis::ros
