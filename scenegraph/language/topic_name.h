// Names of ROS topics.
#pragma once

#include <string>
#include <string_view>

namespace simvis {

/// Whether ROS 2 takes it as the full name of a topic: "/robot/scan".
bool is_topic_name(std::string_view text);

/// "/NAME/WHAT" as ROS allows it: every other character of a name is "_", and a part of it that begins with a digit
/// gets an "n" in front.
std::string topic_name(std::string_view name, std::string_view what);

}  // namespace simvis
