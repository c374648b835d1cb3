// The services by which ROS 2 lists, reads, describes and sets the parameters of a node: `ros2 param`.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/parameters.h>

namespace simvis {

/// Parameters are "ELEMENT.PARAM", doubles in the unit of the element's table.
struct ParameterService {
  std::string_view name,  ///< "get_parameters"
      type;               ///< "rcl_interfaces/srv/GetParameters"
  /// The reply to a request, both in CDR with their headers. Throws InputError for bytes that are no request of the
  /// service; what it asks for in vain is in the reply.
  std::string (*answer)(Parameters& parameters, std::string_view request);
};

/// All services of a node's parameters.
const std::vector<ParameterService>& parameter_services();

/// The index of "ELEMENT.PARAM". Throws InputError.
std::size_t parameter_index(const Parameters& parameters, const std::string& name);

}  // namespace simvis
