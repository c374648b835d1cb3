// Messages of rosgraph_msgs, diagnostic_msgs and rcl_interfaces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct Clock {
  SIMVIS_MESSAGE("rosgraph_msgs/msg/Clock", clock);
  Time clock;
};

struct KeyValue {
  SIMVIS_MESSAGE("diagnostic_msgs/msg/KeyValue", key, value);
  std::string key;
  std::string value;
};

struct DiagnosticStatus {
  SIMVIS_MESSAGE("diagnostic_msgs/msg/DiagnosticStatus", level, name, message, hardware_id, values);
  static constexpr std::string_view kConstants =
      "byte OK=0\n"
      "byte WARN=1\n"
      "byte ERROR=2\n"
      "byte STALE=3\n";
  std::byte level{};  ///< 0 OK, 1 WARN, 2 ERROR, 3 STALE
  std::string name;
  std::string message;
  std::string hardware_id;
  std::vector<KeyValue> values;
};

struct DiagnosticArray {
  SIMVIS_MESSAGE("diagnostic_msgs/msg/DiagnosticArray", header, status);
  Header header;
  std::vector<DiagnosticStatus> status;
};

struct ParameterValue {
  SIMVIS_MESSAGE("rcl_interfaces/msg/ParameterValue", type, bool_value, integer_value, double_value, string_value,
                 byte_array_value, bool_array_value, integer_array_value, double_array_value, string_array_value);
  std::uint8_t type = 0;  ///< 3: double_value counts
  bool bool_value = false;
  std::int64_t integer_value = 0;
  double double_value = 0;
  std::string string_value;
  std::vector<std::byte> byte_array_value;
  std::vector<bool> bool_array_value;
  std::vector<std::int64_t> integer_array_value;
  std::vector<double> double_array_value;
  std::vector<std::string> string_array_value;
};

struct Parameter {
  SIMVIS_MESSAGE("rcl_interfaces/msg/Parameter", name, value);
  std::string name;
  ParameterValue value;
};

struct ParameterEvent {
  SIMVIS_MESSAGE("rcl_interfaces/msg/ParameterEvent", stamp, node, new_parameters, changed_parameters,
                 deleted_parameters);
  Time stamp;
  std::string node;
  std::vector<Parameter> new_parameters;
  std::vector<Parameter> changed_parameters;
  std::vector<Parameter> deleted_parameters;
};

}  // namespace simvis::ros
