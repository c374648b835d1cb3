#include <simvis/sensor_type.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "sensors/timing_faults.h"

namespace simvis {
namespace {

// The message of a number that no other message of its sensor has.
constexpr std::string_view kNumberMessage = "std_msgs/msg/Float64";

std::vector<OutputSpec> listed_outputs(const SensorType& type, const Command& command) {
  if (type.outputs == nullptr) return {};
  const AttributeValues attributes(command, all_attributes(type), kSensorCommonAttributes);
  return type.outputs({.command = command, .attributes = attributes, .name = command.require("name").value, .seed = 0});
}

}  // namespace

std::vector<OutputSpec> all_outputs(const SensorType& type) {
  Command command{.kind = CommandKind::sensor, .attributes = {}, .where = {}, .folder = {}};
  for (const auto& [name, value] :
       {std::pair<std::string_view, std::string_view>("type", type.name), {"name", "SENSOR"}, {"insert_at", "ROOT"}}) {
    command.attributes.push_back({std::string(name), std::string(value), {}});
  }
  return listed_outputs(type, command);
}

std::vector<OutputSpec> outputs_of(const SensorType& type, const Command& command) {
  const Command complete = with_preset(command, type);
  std::vector<OutputSpec> outputs = listed_outputs(type, complete);
  std::erase_if(outputs, [](const OutputSpec& each) { return !each.given; });
  const AttributeValues attributes(complete, all_attributes(type), kSensorCommonAttributes);
  if (TimingFaults::of(attributes) != TimingFaults{}) std::ranges::move(timing_outputs(), std::back_inserter(outputs));
  return outputs;
}

std::vector<OutputSpec> reading_outputs(const SensorContext& context, std::span<const TableColumn> columns,
                                        bool one_row) {
  const SensorType* const type = find_sensor_type(context.command.require("type").value);
  std::vector<OutputSpec> outputs =
      one_row ? column_outputs(columns, OutputKind::scalar)
              : column_outputs(columns, OutputKind::table_column, {.rows = 0, .columns = 1, .channels = 1});
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (!type->message.empty() && columns[i].in_message) {
      outputs[i].message = type->message;
    } else if (one_row) {
      outputs[i].message = kNumberMessage;
    }
  }
  return outputs;
}

}  // namespace simvis
