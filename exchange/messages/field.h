// The field table of a message type, from which its encoding, decoding, description and hash all follow.
//
// To add a message type, write a struct with its ROS 2 name and its fields, in the order of its .msg file:
//
//   struct Header {
//     static constexpr std::string_view kName = "std_msgs/msg/Header";
//     Time stamp;
//     std::string frame_id;
//     static constexpr auto field_table() {
//       return std::tuple{Field{"stamp", &Header::stamp}, Field{"frame_id", &Header::frame_id}};
//     }
//   };
#pragma once

#include <string_view>
#include <tuple>

namespace simvis::ros {

/// One field of the message `Owner`. A std::array is an array of ROS, a std::vector a sequence without a limit, and
/// std::byte the type `byte`.
template <typename Owner, typename Value>
struct Field {
  std::string_view name;
  Value Owner::*member;
};
template <typename Owner, typename Value>
Field(const char*, Value Owner::*) -> Field<Owner, Value>;

template <typename M>
concept Message = requires {
  M::kName;
  M::field_table();
};

/// Calls action(name, value) for each field of the message, in order.
template <typename M, typename Action>
void visit(M& message, const Action& action) {
  std::apply([&](const auto&... fields) { (action(fields.name, message.*fields.member), ...); }, M::field_table());
}

}  // namespace simvis::ros
