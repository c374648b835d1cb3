// What makes a participant of DDS a node of ROS 2: its place in the graph, and the services of its parameters as
// rmw_cyclonedds sends them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/system_types.h"

namespace simvis::ros {

struct Gid {
  static constexpr std::string_view kName = "rmw_dds_common/msg/Gid";
  std::array<std::uint8_t, 16> data{};
  bool operator==(const Gid&) const = default;
  static constexpr auto field_table() { return std::tuple{Field{"data", &Gid::data}}; }
};

struct NodeEntitiesInfo {
  static constexpr std::string_view kName = "rmw_dds_common/msg/NodeEntitiesInfo";
  std::string node_namespace;
  std::string node_name;
  std::vector<Gid> reader_gid_seq;
  std::vector<Gid> writer_gid_seq;
  static constexpr auto field_table() {
    return std::tuple{Field{"node_namespace", &NodeEntitiesInfo::node_namespace},
                      Field{"node_name", &NodeEntitiesInfo::node_name},
                      Field{"reader_gid_seq", &NodeEntitiesInfo::reader_gid_seq},
                      Field{"writer_gid_seq", &NodeEntitiesInfo::writer_gid_seq}};
  }
};

struct ParticipantEntitiesInfo {
  static constexpr std::string_view kName = "rmw_dds_common/msg/ParticipantEntitiesInfo";
  Gid gid;
  std::vector<NodeEntitiesInfo> node_entities_info_seq;
  static constexpr auto field_table() {
    return std::tuple{Field{"gid", &ParticipantEntitiesInfo::gid},
                      Field{"node_entities_info_seq", &ParticipantEntitiesInfo::node_entities_info_seq}};
  }
};

/// In front of each request and of its reply, which repeats it.
struct RequestHeader {
  static constexpr std::string_view kName = "simvis_msgs/msg/RequestHeader";
  std::uint64_t client = 0;
  std::int64_t sequence = 0;
  static constexpr auto field_table() {
    return std::tuple{Field{"client", &RequestHeader::client}, Field{"sequence", &RequestHeader::sequence}};
  }
};

struct ListParametersRequest {
  static constexpr std::string_view kName = "rcl_interfaces/srv/ListParameters_Request";
  RequestHeader header;
  std::vector<std::string> prefixes;
  std::uint64_t depth = 0;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &ListParametersRequest::header},
                      Field{"prefixes", &ListParametersRequest::prefixes},
                      Field{"depth", &ListParametersRequest::depth}};
  }
};

/// The result is rcl_interfaces/msg/ListParametersResult, whose fields stand in its place.
struct ListParametersReply {
  static constexpr std::string_view kName = "rcl_interfaces/srv/ListParameters_Response";
  RequestHeader header;
  std::vector<std::string> names;
  std::vector<std::string> prefixes;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &ListParametersReply::header}, Field{"names", &ListParametersReply::names},
                      Field{"prefixes", &ListParametersReply::prefixes}};
  }
};

/// Requests of GetParameters, GetParameterTypes and DescribeParameters are the same.
struct NamedParametersRequest {
  static constexpr std::string_view kName = "rcl_interfaces/srv/GetParameters_Request";
  RequestHeader header;
  std::vector<std::string> names;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &NamedParametersRequest::header}, Field{"names", &NamedParametersRequest::names}};
  }
};

struct GetParametersReply {
  static constexpr std::string_view kName = "rcl_interfaces/srv/GetParameters_Response";
  RequestHeader header;
  std::vector<ParameterValue> values;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &GetParametersReply::header}, Field{"values", &GetParametersReply::values}};
  }
};

struct GetParameterTypesReply {
  static constexpr std::string_view kName = "rcl_interfaces/srv/GetParameterTypes_Response";
  RequestHeader header;
  std::vector<std::uint8_t> types;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &GetParameterTypesReply::header}, Field{"types", &GetParameterTypesReply::types}};
  }
};

struct FloatingPointRange {
  static constexpr std::string_view kName = "rcl_interfaces/msg/FloatingPointRange";
  double from_value = 0;
  double to_value = 0;
  double step = 0;
  static constexpr auto field_table() {
    return std::tuple{Field{"from_value", &FloatingPointRange::from_value},
                      Field{"to_value", &FloatingPointRange::to_value}, Field{"step", &FloatingPointRange::step}};
  }
};

struct IntegerRange {
  static constexpr std::string_view kName = "rcl_interfaces/msg/IntegerRange";
  std::int64_t from_value = 0;
  std::int64_t to_value = 0;
  std::uint64_t step = 0;
  static constexpr auto field_table() {
    return std::tuple{Field{"from_value", &IntegerRange::from_value}, Field{"to_value", &IntegerRange::to_value},
                      Field{"step", &IntegerRange::step}};
  }
};

struct ParameterDescriptor {
  static constexpr std::string_view kName = "rcl_interfaces/msg/ParameterDescriptor";
  std::string name;
  std::uint8_t type = 0;
  std::string description;
  std::string additional_constraints;
  bool read_only = false;
  bool dynamic_typing = false;
  std::vector<FloatingPointRange> floating_point_range;
  std::vector<IntegerRange> integer_range;
  static constexpr auto field_table() {
    return std::tuple{Field{"name", &ParameterDescriptor::name},
                      Field{"type", &ParameterDescriptor::type},
                      Field{"description", &ParameterDescriptor::description},
                      Field{"additional_constraints", &ParameterDescriptor::additional_constraints},
                      Field{"read_only", &ParameterDescriptor::read_only},
                      Field{"dynamic_typing", &ParameterDescriptor::dynamic_typing},
                      Field{"floating_point_range", &ParameterDescriptor::floating_point_range},
                      Field{"integer_range", &ParameterDescriptor::integer_range}};
  }
};

struct DescribeParametersReply {
  static constexpr std::string_view kName = "rcl_interfaces/srv/DescribeParameters_Response";
  RequestHeader header;
  std::vector<ParameterDescriptor> descriptors;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &DescribeParametersReply::header},
                      Field{"descriptors", &DescribeParametersReply::descriptors}};
  }
};

/// Requests of SetParameters and SetParametersAtomically are the same.
struct SetParametersRequest {
  static constexpr std::string_view kName = "rcl_interfaces/srv/SetParameters_Request";
  RequestHeader header;
  std::vector<Parameter> parameters;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &SetParametersRequest::header},
                      Field{"parameters", &SetParametersRequest::parameters}};
  }
};

struct SetParametersResult {
  static constexpr std::string_view kName = "rcl_interfaces/msg/SetParametersResult";
  bool successful = false;
  std::string reason;
  static constexpr auto field_table() {
    return std::tuple{Field{"successful", &SetParametersResult::successful},
                      Field{"reason", &SetParametersResult::reason}};
  }
};

struct SetParametersReply {
  static constexpr std::string_view kName = "rcl_interfaces/srv/SetParameters_Response";
  RequestHeader header;
  std::vector<SetParametersResult> results;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &SetParametersReply::header}, Field{"results", &SetParametersReply::results}};
  }
};

struct SetParametersAtomicallyReply {
  static constexpr std::string_view kName = "rcl_interfaces/srv/SetParametersAtomically_Response";
  RequestHeader header;
  SetParametersResult result;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &SetParametersAtomicallyReply::header},
                      Field{"result", &SetParametersAtomicallyReply::result}};
  }
};

}  // namespace simvis::ros
