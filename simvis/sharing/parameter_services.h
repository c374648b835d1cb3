// The services by which ROS 2 lists, reads, describes and sets the parameters of a node: `ros2 param`.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
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

/// An index of parameters by name, for messages with many names.
///
/// Lifetime  until an element is added or removed.
class ParameterNames {
 public:
  explicit ParameterNames(const Parameters& parameters);
  /// The index of "ELEMENT.PARAM"; empty if there is none.
  std::optional<std::size_t> find(std::string_view name) const;
  /// As find(). Throws InputError if there is none. Only the first error of this object suggests the nearest name,
  /// since that compares the name with all others.
  std::size_t index(const std::string& name);

 private:
  const Parameters& parameters_;
  std::unordered_map<std::string_view, const ElementDescriptor*> elements_;
  bool has_suggested_ = false;
};

}  // namespace simvis
