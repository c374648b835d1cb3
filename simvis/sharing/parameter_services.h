// The services by which ROS 2 lists, reads, describes and sets the parameters of a node: `ros2 param`.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <simvis/parameters.h>

namespace simvis {

/// An index of parameters by name, for messages with many names.
class ParameterNames {
 public:
  /// The names of a message are those of `parameters`, which must outlive the message. The index is built again only if
  /// elements were added or removed since the last call.
  void follow(const Parameters& parameters);
  /// The index of "ELEMENT.PARAM"; empty if there is none.
  std::optional<std::size_t> find(std::string_view name) const;
  /// As find(). Throws InputError if there is none. Only the first error of a message suggests the nearest name, since
  /// that compares the name with all others.
  std::size_t index(const std::string& name);

 private:
  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view name) const { return std::hash<std::string_view>()(name); }
  };
  const Parameters* parameters_ = nullptr;
  std::size_t changes_ = 0;  // of the scene, that `elements_` follow
  std::unordered_map<std::string, std::size_t, Hash, std::equal_to<>> elements_;
  bool has_suggested_ = false;
};

/// Parameters are "ELEMENT.PARAM", doubles in the unit of the element's table.
struct ParameterService {
  std::string_view name,  ///< "get_parameters"
      type;               ///< "rcl_interfaces/srv/GetParameters"
  /// The reply to a request, both in CDR with their headers. `names` is kept from request to request. Throws InputError
  /// for bytes that are no request of the service; what it asks for in vain is in the reply.
  std::string (*answer)(Parameters& parameters, ParameterNames& names, std::string_view request);
};

/// All services of a node's parameters.
const std::vector<ParameterService>& parameter_services();

}  // namespace simvis
