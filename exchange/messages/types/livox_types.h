// Messages of livox_ros_driver2 (github.com/Livox-SDK/livox_ros_driver2).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct CustomPoint {
  SIMVIS_MESSAGE("livox_ros_driver2/msg/CustomPoint", offset_time, x, y, z, reflectivity, tag, line);
  std::uint32_t offset_time = 0;  ///< nanoseconds behind timebase
  float x = 0;
  float y = 0;
  float z = 0;
  std::uint8_t reflectivity = 0;
  std::uint8_t tag = 0;   ///< 0: one return, of full confidence
  std::uint8_t line = 0;  ///< number of the laser
};

struct CustomMsg {
  SIMVIS_MESSAGE("livox_ros_driver2/msg/CustomMsg", header, timebase, point_num, lidar_id, rsvd, points);
  Header header;
  std::uint64_t timebase = 0;  ///< of the first point, nanoseconds
  std::uint32_t point_num = 0;
  std::uint8_t lidar_id = 0;
  std::array<std::uint8_t, 3> rsvd{};
  std::vector<CustomPoint> points;
};

}  // namespace simvis::ros
