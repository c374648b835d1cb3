// What ROS 2 calls its topics and types on DDS.
#pragma once

#include <string>
#include <string_view>

namespace simvis::ros {

/// "/FRONT/scan" is "rt/FRONT/scan".
inline std::string dds_topic(std::string_view topic) { return "rt" + std::string(topic); }

/// "sensor_msgs/msg/LaserScan" is "sensor_msgs::msg::dds_::LaserScan_".
inline std::string dds_type(std::string_view type) {
  std::string name;
  for (const char c : type.substr(0, type.rfind('/') + 1)) name += c == '/' ? "::" : std::string(1, c);
  return name + "dds_::" + std::string(type.substr(type.rfind('/') + 1)) + "_";
}

}  // namespace simvis::ros
