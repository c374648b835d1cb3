#include "simvis/ros/node_name.h"

#include <cstddef>

#include <simvis/error.h>
#include <simvis/location.h>
#include "scenegraph/language/topic_name.h"

namespace simvis {
namespace {

// RMW_TOPIC_MAX_NAME_LENGTH of rmw/validate_full_topic_name.h in ROS 2, in bytes, and the longest topic of a node.
constexpr std::size_t kMaxTopicName = 247;
constexpr std::string_view kLongestTopic = "/set_parameters_atomically";
constexpr std::size_t kMaxNodeName = kMaxTopicName - kLongestTopic.size();

}  // namespace

// A full name has the form of a topic's, by rmw/validate_node_name.c and rmw/validate_namespace.c of ROS 2. A name with
// a slash that does not begin with one would be relative to a namespace, and there is none.
std::string full_node_name(std::string_view name) {
  const bool is_full = name.starts_with('/');
  const std::string full = is_full ? std::string(name) : "/" + std::string(name);
  if (!is_topic_name(full) || (!is_full && name.find('/') != name.npos)) {
    throw InputError(in_quotes(name) +
                     " is no name of a node of ROS 2, expected NAME or /NAMESPACE/NAME of letters, digits and _, "
                     "each not beginning with a digit");
  }
  if (full.size() > kMaxNodeName) {
    throw InputError("the name of the node has " + std::to_string(full.size()) + " characters with its namespace, " +
                     "expected " + std::to_string(kMaxNodeName) + " or fewer");
  }
  return full;
}

}  // namespace simvis
