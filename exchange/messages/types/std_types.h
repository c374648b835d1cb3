// Messages of builtin_interfaces and std_msgs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"

namespace simvis::ros {

struct Time {
  SIMVIS_MESSAGE("builtin_interfaces/msg/Time", sec, nanosec);
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};

struct Header {
  SIMVIS_MESSAGE("std_msgs/msg/Header", stamp, frame_id);
  Time stamp;  ///< simulated
  std::string frame_id;
};

struct Float64 {
  SIMVIS_MESSAGE("std_msgs/msg/Float64", data);
  double data = 0;
};

struct MultiArrayDimension {
  SIMVIS_MESSAGE("std_msgs/msg/MultiArrayDimension", label, size, stride);
  std::string label;
  std::uint32_t size = 0, stride = 0;
};

struct MultiArrayLayout {
  SIMVIS_MESSAGE("std_msgs/msg/MultiArrayLayout", dim, data_offset);
  std::vector<MultiArrayDimension> dim;
  std::uint32_t data_offset = 0;
};

struct Float64MultiArray {
  SIMVIS_MESSAGE("std_msgs/msg/Float64MultiArray", layout, data);
  MultiArrayLayout layout;
  std::vector<double> data;
};

struct String {
  SIMVIS_MESSAGE("std_msgs/msg/String", data);
  std::string data;
};

}  // namespace simvis::ros
