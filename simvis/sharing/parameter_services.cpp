#include "simvis/sharing/parameter_services.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <unordered_set>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "exchange/messages/cdr.h"
#include "exchange/messages/types/node_types.h"

namespace simvis {
namespace {

constexpr std::uint8_t kNotSetType = 0, kIntegerType = 2, kDoubleType = 3;

/// The value that a parameter is set to. Throws InputError if it is not allowed.
std::pair<std::size_t, double> setting_of(const Parameters& parameters, ParameterNames& names,
                                          const ros::Parameter& parameter) {
  const std::size_t index = names.index(parameter.name);
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

/// Whether list_parameters returns this name. Dots separate the levels of a name. A name is listed if it is one of the
/// prefixes, or if it lies at most `depth` levels below one of them; without prefixes all names with at most `depth`
/// levels are listed. A depth of 0 has no limit. This is the rule of rclcpp's NodeParameters::list_parameters().
bool is_listed(std::string_view name, const std::unordered_set<std::string_view>& prefixes, std::uint64_t depth) {
  const auto is_within_depth = [&](std::string_view rest) {
    return depth == 0 || static_cast<std::uint64_t>(std::ranges::count(rest, '.')) < depth;
  };
  if (prefixes.empty()) return is_within_depth(name);
  if (prefixes.contains(name)) return true;
  for (std::size_t dot = name.find('.'); dot != name.npos; dot = name.find('.', dot + 1)) {
    if (prefixes.contains(name.substr(0, dot)) && is_within_depth(name.substr(dot + 1))) return true;
  }
  return false;
}

std::string answer_list(Parameters& parameters, ParameterNames& /*names*/, std::string_view bytes) {
  const auto request = ros::decode<ros::ListParametersRequest>(bytes);
  const std::unordered_set<std::string_view> prefixes(request.prefixes.begin(), request.prefixes.end());
  ros::ListParametersReply reply{.header = request.header, .names = {}, .prefixes = {}};
  std::set<std::string> listed;
  for (std::size_t i = 0; i < parameters.values().size(); ++i) {
    if (parameters.is_removed(i)) continue;
    const std::string name = parameters.name(i), element = name.substr(0, name.rfind('.'));
    if (!is_listed(name, prefixes, request.depth)) continue;
    reply.names.push_back(name);
    if (listed.insert(element).second) reply.prefixes.push_back(element);
  }
  return ros::encode(reply);
}

std::string answer_get(Parameters& parameters, ParameterNames& names, std::string_view bytes) {
  const auto request = ros::decode<ros::NamedParametersRequest>(bytes);
  names.follow(parameters);
  ros::GetParametersReply reply{.header = request.header, .values = {}};
  for (const std::string& name : request.names) {
    ros::ParameterValue& value = reply.values.emplace_back();
    const std::optional<std::size_t> index = names.find(name);
    value.type = index ? kDoubleType : kNotSetType;
    if (index) value.double_value = parameters.values()[*index];
  }
  return ros::encode(reply);
}

std::string answer_types(Parameters& parameters, ParameterNames& names, std::string_view bytes) {
  const auto request = ros::decode<ros::NamedParametersRequest>(bytes);
  names.follow(parameters);
  ros::GetParameterTypesReply reply{.header = request.header, .types = {}};
  for (const std::string& name : request.names) {
    reply.types.push_back(names.find(name) ? kDoubleType : kNotSetType);
  }
  return ros::encode(reply);
}

std::string answer_describe(Parameters& parameters, ParameterNames& names, std::string_view bytes) {
  const auto request = ros::decode<ros::NamedParametersRequest>(bytes);
  names.follow(parameters);
  ros::DescribeParametersReply reply{.header = request.header, .descriptors = {}};
  for (const std::string& name : request.names) {
    ros::ParameterDescriptor& descriptor = reply.descriptors.emplace_back();
    descriptor.name = name;
    const std::optional<std::size_t> index = names.find(name);
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
std::string answer_set(Parameters& parameters, ParameterNames& names, std::string_view bytes) {
  const auto request = ros::decode<ros::SetParametersRequest>(bytes);
  names.follow(parameters);
  ros::SetParametersReply reply{.header = request.header, .results = {}};
  for (const ros::Parameter& parameter : request.parameters) {
    ros::SetParametersResult& result = reply.results.emplace_back();
    try {
      const auto [index, value] = setting_of(parameters, names, parameter);
      parameters.set(index, value);
      result.successful = true;
    } catch (const InputError& error) {
      result.reason = error.what();
    }
  }
  return ros::encode(reply);
}

// All parameters, or none.
std::string answer_set_atomically(Parameters& parameters, ParameterNames& names, std::string_view bytes) {
  const auto request = ros::decode<ros::SetParametersRequest>(bytes);
  ros::SetParametersAtomicallyReply reply{.header = request.header, .result = {}};
  try {
    names.follow(parameters);
    std::vector<std::pair<std::size_t, double>> settings;
    for (const ros::Parameter& parameter : request.parameters) {
      settings.push_back(setting_of(parameters, names, parameter));
    }
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

// A command that is refused may move elements in memory but changes none, so the index holds places, not pointers.
void ParameterNames::follow(const Parameters& parameters) {
  has_suggested_ = false;
  if (std::exchange(parameters_, &parameters) == &parameters && changes_ == parameters.changes().size()) return;
  changes_ = parameters.changes().size();
  elements_.clear();
  const std::vector<ElementDescriptor>& elements = parameters.elements();
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (!elements[i].removed) elements_.emplace(elements[i].name, i);
  }
}

std::optional<std::size_t> ParameterNames::find(std::string_view name) const {
  const std::size_t dot = name.rfind('.');
  if (dot == name.npos) return std::nullopt;
  const auto found = elements_.find(name.substr(0, dot));
  if (found == elements_.end()) return std::nullopt;
  const ElementDescriptor& element = parameters_->elements()[found->second];
  const auto row = std::ranges::find(element.parameters, name.substr(dot + 1), &AttributeSpec::name);
  if (row == element.parameters.end()) return std::nullopt;
  return element.first_value + static_cast<std::size_t>(row - element.parameters.begin());
}

std::size_t ParameterNames::index(const std::string& name) {
  if (const std::optional<std::size_t> found = find(name)) return *found;
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) throw InputError(in_quotes(name) + " names no parameter, expected ELEMENT.PARAM");
  if (std::exchange(has_suggested_, true)) throw InputError("there is no parameter " + in_quotes(name));
  return parameters_->index(name.substr(0, dot), name.substr(dot + 1));
}

}  // namespace simvis
