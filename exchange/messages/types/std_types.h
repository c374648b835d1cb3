// Messages of builtin_interfaces and std_msgs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "exchange/messages/field.h"

namespace simvis::ros {

struct Time {
  static constexpr std::string_view kName = "builtin_interfaces/msg/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static constexpr auto field_table() { return std::tuple{Field{"sec", &Time::sec}, Field{"nanosec", &Time::nanosec}}; }
};

struct Header {
  static constexpr std::string_view kName = "std_msgs/msg/Header";
  Time stamp;  ///< simulated
  std::string frame_id;
  static constexpr auto field_table() {
    return std::tuple{Field{"stamp", &Header::stamp}, Field{"frame_id", &Header::frame_id}};
  }
};

struct Float64 {
  static constexpr std::string_view kName = "std_msgs/msg/Float64";
  double data = 0;
  static constexpr auto field_table() { return std::tuple{Field{"data", &Float64::data}}; }
};

struct String {
  static constexpr std::string_view kName = "std_msgs/msg/String";
  std::string data;
  static constexpr auto field_table() { return std::tuple{Field{"data", &String::data}}; }
};

}  // namespace simvis::ros
