#include "simvis/sharing/parameter_services.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "messages/cdr.h"
#include "messages/types/node_types.h"

namespace simvis {
namespace {

constexpr std::uint8_t kNotSetType = 0, kIntegerType = 2, kDoubleType = 3;

std::optional<std::size_t> find_parameter(const Parameters& parameters, const std::string& name) {
  try {
    const std::size_t index = parameter_index(parameters, name);
    return parameters.is_removed(index) ? std::nullopt : std::optional(index);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// The value that a parameter is set to. Throws InputError if it is not allowed.
std::pair<std::size_t, double> setting_of(const Parameters& parameters, const ros::Parameter& parameter) {
  const std::size_t index = parameter_index(parameters, parameter.name);
  const ros::ParameterValue& value = parameter.value;
  if (value.type != kDoubleType && value.type != kIntegerType) {
    throw InputError(parameter.name + ": its value has type " + std::to_string(value.type) +
                     ", expected 3, a double, or 2, an integer");
  }
  const double number = value.type == kDoubleType ? value.double_value : static_cast<double>(value.integer_value);
  const std::string wrong = check_number(parameters.spec(index), number);
  if (!wrong.empty()) throw InputError(parameter.name + ": " + wrong);
  return {index, number};
}

// A name has levels, ELEMENT and PARAM; a depth of 0 means all of them.
std::string answer_list(Parameters& parameters, std::string_view bytes) {
  const auto request = ros::decode<ros::ListParametersRequest>(bytes);
  ros::ListParametersReply reply{.header = request.header, .names = {}, .prefixes = {}};
  for (std::size_t i = 0; i < parameters.values().size(); ++i) {
    if (parameters.is_removed(i)) continue;
    const std::string name = parameters.name(i), element = name.substr(0, name.rfind('.'));
    const bool fits = request.prefixes.empty() ? request.depth != 1
                                               : std::ranges::any_of(request.prefixes, [&](const std::string& prefix) {
                                                   return name == prefix || element == prefix;
                                                 });
    if (!fits) continue;
    reply.names.push_back(name);
    if (std::ranges::count(reply.prefixes, element) == 0) reply.prefixes.push_back(element);
  }
  return ros::encode(reply);
}

std::string answer_get(Parameters& parameters, std::string_view bytes) {
  const auto request = ros::decode<ros::NamedParametersRequest>(bytes);
  ros::GetParametersReply reply{.header = request.header, .values = {}};
  for (const std::string& name : request.names) {
    ros::ParameterValue& value = reply.values.emplace_back();
    const std::optional<std::size_t> index = find_parameter(parameters, name);
    value.type = index ? kDoubleType : kNotSetType;
    if (index) value.double_value = parameters.values()[*index];
  }
  return ros::encode(reply);
}

std::string answer_types(Parameters& parameters, std::string_view bytes) {
  const auto request = ros::decode<ros::NamedParametersRequest>(bytes);
  ros::GetParameterTypesReply reply{.header = request.header, .types = {}};
  for (const std::string& name : request.names) {
    reply.types.push_back(find_parameter(parameters, name) ? kDoubleType : kNotSetType);
  }
  return ros::encode(reply);
}

std::string answer_describe(Parameters& parameters, std::string_view bytes) {
  const auto request = ros::decode<ros::NamedParametersRequest>(bytes);
  ros::DescribeParametersReply reply{.header = request.header, .descriptors = {}};
  for (const std::string& name : request.names) {
    ros::ParameterDescriptor& descriptor = reply.descriptors.emplace_back();
    descriptor.name = name;
    const std::optional<std::size_t> index = find_parameter(parameters, name);
    if (!index) continue;
    const AttributeSpec& spec = parameters.spec(*index);
    descriptor.type = kDoubleType;
    descriptor.description = std::string(spec.text) + (spec.unit.empty() ? "" : " (" + std::string(spec.unit) + ")");
    const bool is_limited = std::isfinite(spec.min) && std::isfinite(spec.max);
    if (is_limited) descriptor.floating_point_range.push_back({spec.min, spec.max, 0});
  }
  return ros::encode(reply);
}

// Each parameter by itself.
std::string answer_set(Parameters& parameters, std::string_view bytes) {
  const auto request = ros::decode<ros::SetParametersRequest>(bytes);
  ros::SetParametersReply reply{.header = request.header, .results = {}};
  for (const ros::Parameter& parameter : request.parameters) {
    ros::SetParametersResult& result = reply.results.emplace_back();
    try {
      const auto [index, value] = setting_of(parameters, parameter);
      parameters.set(index, value);
      result.successful = true;
    } catch (const InputError& error) {
      result.reason = error.what();
    }
  }
  return ros::encode(reply);
}

// All parameters, or none.
std::string answer_set_atomically(Parameters& parameters, std::string_view bytes) {
  const auto request = ros::decode<ros::SetParametersRequest>(bytes);
  ros::SetParametersAtomicallyReply reply{.header = request.header, .result = {}};
  try {
    std::vector<std::pair<std::size_t, double>> settings;
    for (const ros::Parameter& parameter : request.parameters) settings.push_back(setting_of(parameters, parameter));
    for (const auto& [index, value] : settings) parameters.set(index, value);
    reply.result.successful = true;
  } catch (const InputError& error) {
    reply.result.reason = error.what();
  }
  return ros::encode(reply);
}

}  // namespace

const std::vector<ParameterService>& parameter_services() {
  static const std::vector<ParameterService> services = {
      {"list_parameters", "rcl_interfaces/srv/ListParameters", answer_list},
      {"get_parameters", "rcl_interfaces/srv/GetParameters", answer_get},
      {"get_parameter_types", "rcl_interfaces/srv/GetParameterTypes", answer_types},
      {"describe_parameters", "rcl_interfaces/srv/DescribeParameters", answer_describe},
      {"set_parameters", "rcl_interfaces/srv/SetParameters", answer_set},
      {"set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically", answer_set_atomically}};
  return services;
}

std::size_t parameter_index(const Parameters& parameters, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) throw InputError(in_quotes(name) + " names no parameter, expected ELEMENT.PARAM");
  return parameters.index(name.substr(0, dot), name.substr(dot + 1));
}

}  // namespace simvis
