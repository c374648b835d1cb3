// The fields of a message type, from which its encoding, decoding, description and hash all follow.
//
// To add a message type, write a struct with its ROS 2 name and its fields, in the order of its .msg file:
//
//   struct Header {
//     SIMVIS_MESSAGE("std_msgs/msg/Header", stamp, frame_id);
//     Time stamp;
//     std::string frame_id;
//   };
//
// A std::array is an array of ROS, a std::vector a sequence without a limit, and std::byte the type `byte`. Constants
// of the .msg file stand in a string kConstants, a line "uint8 INFRARED=1" each.
#pragma once

#include <algorithm>
#include <string_view>
#include <tuple>

// Defines the name of a message type, its fields in order, and their names.
#define SIMVIS_MESSAGE(name, ...)                           \
  auto all_fields() { return std::tie(__VA_ARGS__); }       \
  auto all_fields() const { return std::tie(__VA_ARGS__); } \
  static constexpr std::string_view kName = name, kFieldNames = #__VA_ARGS__

namespace simvis::ros {

template <typename M>
concept Message = requires {
  M::kName;
  M::kFieldNames;
};

/// Calls action(value) for each field of the message, in order.
template <typename M, typename Action>
void for_each_field(M& message, const Action& action) {
  std::apply([&](auto&... values) { (action(values), ...); }, message.all_fields());
}

/// Takes the first name from the names of fields.
inline std::string_view take_field_name(std::string_view& names) {
  constexpr std::string_view kBetween = ", ";
  const std::string_view name = names.substr(0, names.find(kBetween));
  names.remove_prefix(std::min(name.size() + kBetween.size(), names.size()));
  return name;
}

}  // namespace simvis::ros
