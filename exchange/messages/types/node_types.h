// What makes a participant of DDS a node of ROS 2: its place in the graph, and the services of its parameters as
// rmw_cyclonedds sends them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/system_types.h"

namespace simvis::ros {

struct Gid {
  SIMVIS_MESSAGE("rmw_dds_common/msg/Gid", data);
  std::array<std::uint8_t, 16> data{};
  bool operator==(const Gid&) const = default;
};

struct NodeEntitiesInfo {
  SIMVIS_MESSAGE("rmw_dds_common/msg/NodeEntitiesInfo", node_namespace, node_name, reader_gid_seq, writer_gid_seq);
  std::string node_namespace;
  std::string node_name;
  std::vector<Gid> reader_gid_seq;
  std::vector<Gid> writer_gid_seq;
};

struct ParticipantEntitiesInfo {
  SIMVIS_MESSAGE("rmw_dds_common/msg/ParticipantEntitiesInfo", gid, node_entities_info_seq);
  Gid gid;
  std::vector<NodeEntitiesInfo> node_entities_info_seq;
};

/// In front of each request and of its reply, which repeats it.
struct RequestHeader {
  SIMVIS_MESSAGE("simvis_msgs/msg/RequestHeader", client, sequence);
  std::uint64_t client = 0;
  std::int64_t sequence = 0;
};

struct ListParametersRequest {
  SIMVIS_MESSAGE("rcl_interfaces/srv/ListParameters_Request", header, prefixes, depth);
  RequestHeader header;
  std::vector<std::string> prefixes;
  std::uint64_t depth = 0;
};

/// The result is rcl_interfaces/msg/ListParametersResult, whose fields stand in its place.
struct ListParametersReply {
  SIMVIS_MESSAGE("rcl_interfaces/srv/ListParameters_Response", header, names, prefixes);
  RequestHeader header;
  std::vector<std::string> names;
  std::vector<std::string> prefixes;
};

/// Requests of GetParameters, GetParameterTypes and DescribeParameters are the same.
struct NamedParametersRequest {
  SIMVIS_MESSAGE("rcl_interfaces/srv/GetParameters_Request", header, names);
  RequestHeader header;
  std::vector<std::string> names;
};

struct GetParametersReply {
  SIMVIS_MESSAGE("rcl_interfaces/srv/GetParameters_Response", header, values);
  RequestHeader header;
  std::vector<ParameterValue> values;
};

struct GetParameterTypesReply {
  SIMVIS_MESSAGE("rcl_interfaces/srv/GetParameterTypes_Response", header, types);
  RequestHeader header;
  std::vector<std::uint8_t> types;
};

struct FloatingPointRange {
  SIMVIS_MESSAGE("rcl_interfaces/msg/FloatingPointRange", from_value, to_value, step);
  double from_value = 0;
  double to_value = 0;
  double step = 0;
};

struct IntegerRange {
  SIMVIS_MESSAGE("rcl_interfaces/msg/IntegerRange", from_value, to_value, step);
  std::int64_t from_value = 0;
  std::int64_t to_value = 0;
  std::uint64_t step = 0;
};

struct ParameterDescriptor {
  SIMVIS_MESSAGE("rcl_interfaces/msg/ParameterDescriptor", name, type, description, additional_constraints, read_only,
                 dynamic_typing, floating_point_range, integer_range);
  std::string name;
  std::uint8_t type = 0;
  std::string description;
  std::string additional_constraints;
  bool read_only = false;
  bool dynamic_typing = false;
  std::vector<FloatingPointRange> floating_point_range;
  std::vector<IntegerRange> integer_range;
};

struct DescribeParametersReply {
  SIMVIS_MESSAGE("rcl_interfaces/srv/DescribeParameters_Response", header, descriptors);
  RequestHeader header;
  std::vector<ParameterDescriptor> descriptors;
};

/// Requests of SetParameters and SetParametersAtomically are the same.
struct SetParametersRequest {
  SIMVIS_MESSAGE("rcl_interfaces/srv/SetParameters_Request", header, parameters);
  RequestHeader header;
  std::vector<Parameter> parameters;
};

struct SetParametersResult {
  SIMVIS_MESSAGE("rcl_interfaces/msg/SetParametersResult", successful, reason);
  bool successful = false;
  std::string reason;
};

struct SetParametersReply {
  SIMVIS_MESSAGE("rcl_interfaces/srv/SetParameters_Response", header, results);
  RequestHeader header;
  std::vector<SetParametersResult> results;
};

struct SetParametersAtomicallyReply {
  SIMVIS_MESSAGE("rcl_interfaces/srv/SetParametersAtomically_Response", header, result);
  RequestHeader header;
  SetParametersResult result;
};

}  // namespace simvis::ros
