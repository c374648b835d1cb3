// Messages of rosgraph_msgs, diagnostic_msgs and rcl_interfaces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct Clock {
  static constexpr std::string_view kName = "rosgraph_msgs/msg/Clock";
  Time clock;
  static constexpr auto field_table() { return std::tuple{Field{"clock", &Clock::clock}}; }
};

struct KeyValue {
  static constexpr std::string_view kName = "diagnostic_msgs/msg/KeyValue";
  std::string key;
  std::string value;
  static constexpr auto field_table() {
    return std::tuple{Field{"key", &KeyValue::key}, Field{"value", &KeyValue::value}};
  }
};

struct DiagnosticStatus {
  static constexpr std::string_view kName = "diagnostic_msgs/msg/DiagnosticStatus";
  std::byte level{};  ///< 0 OK, 1 WARN, 2 ERROR, 3 STALE
  std::string name;
  std::string message;
  std::string hardware_id;
  std::vector<KeyValue> values;
  static constexpr auto field_table() {
    return std::tuple{Field{"level", &DiagnosticStatus::level}, Field{"name", &DiagnosticStatus::name},
                      Field{"message", &DiagnosticStatus::message},
                      Field{"hardware_id", &DiagnosticStatus::hardware_id}, Field{"values", &DiagnosticStatus::values}};
  }
};

struct DiagnosticArray {
  static constexpr std::string_view kName = "diagnostic_msgs/msg/DiagnosticArray";
  Header header;
  std::vector<DiagnosticStatus> status;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &DiagnosticArray::header}, Field{"status", &DiagnosticArray::status}};
  }
};

struct ParameterValue {
  static constexpr std::string_view kName = "rcl_interfaces/msg/ParameterValue";
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
  static constexpr auto field_table() {
    return std::tuple{Field{"type", &ParameterValue::type},
                      Field{"bool_value", &ParameterValue::bool_value},
                      Field{"integer_value", &ParameterValue::integer_value},
                      Field{"double_value", &ParameterValue::double_value},
                      Field{"string_value", &ParameterValue::string_value},
                      Field{"byte_array_value", &ParameterValue::byte_array_value},
                      Field{"bool_array_value", &ParameterValue::bool_array_value},
                      Field{"integer_array_value", &ParameterValue::integer_array_value},
                      Field{"double_array_value", &ParameterValue::double_array_value},
                      Field{"string_array_value", &ParameterValue::string_array_value}};
  }
};

struct Parameter {
  static constexpr std::string_view kName = "rcl_interfaces/msg/Parameter";
  std::string name;
  ParameterValue value;
  static constexpr auto field_table() {
    return std::tuple{Field{"name", &Parameter::name}, Field{"value", &Parameter::value}};
  }
};

struct ParameterEvent {
  static constexpr std::string_view kName = "rcl_interfaces/msg/ParameterEvent";
  Time stamp;
  std::string node;
  std::vector<Parameter> new_parameters;
  std::vector<Parameter> changed_parameters;
  std::vector<Parameter> deleted_parameters;
  static constexpr auto field_table() {
    return std::tuple{Field{"stamp", &ParameterEvent::stamp}, Field{"node", &ParameterEvent::node},
                      Field{"new_parameters", &ParameterEvent::new_parameters},
                      Field{"changed_parameters", &ParameterEvent::changed_parameters},
                      Field{"deleted_parameters", &ParameterEvent::deleted_parameters}};
  }
};

}  // namespace simvis::ros
