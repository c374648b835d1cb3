// The name under which a simulation is a node of ROS 2.
#pragma once

#include <string>
#include <string_view>

#include "engine/base/program_api.h"

namespace simvis {

/// The full name of the node unless a user names another one. Recordings have it too.
inline constexpr std::string_view kDefaultNode = "/simvis";

/// The full name of a node that is named as "NAME" or "/NAMESPACE/NAME": "/NAME", "/NAMESPACE/NAME". Throws InputError
/// if ROS 2 takes no node of this name, or if the names of the node's services would be longer than it takes.
SIMVIS_PROGRAM_API std::string full_node_name(std::string_view name);

}  // namespace simvis
