// Messages and services of simulation_interfaces 2.1.0, as far as a simulation answers them. Requests and replies have
// the header of rmw_cyclonedds in front.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/node_types.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct SimulationResult {
  SIMVIS_MESSAGE("simulation_interfaces/msg/Result", result, error_message);
  static constexpr std::uint8_t kUnsupported = 0, kOk = 1, kNotFound = 2, kIncorrectState = 3, kFailed = 4;
  std::uint8_t result = kOk;
  std::string error_message;
};

struct SimulatorFeatures {
  SIMVIS_MESSAGE("simulation_interfaces/msg/SimulatorFeatures", features, spawn_formats, custom_info);
  static constexpr std::uint16_t kSpawning = 0, kDeleting = 1, kStateGetting = 10, kStateSetting = 11, kReset = 20,
                                 kResetSpawned = 23, kSimulationStateGetting = 24, kSimulationStateSetting = 25,
                                 kPause = 26, kStepSingle = 31, kStepMultiple = 32, kSpawningEntities = 50;
  std::vector<std::uint16_t> features;
  std::vector<std::string> spawn_formats;
  std::string custom_info;
};

struct SimulationState {
  SIMVIS_MESSAGE("simulation_interfaces/msg/SimulationState", state);
  static constexpr std::uint8_t kStopped = 0, kPlaying = 1, kPaused = 2, kQuitting = 3;
  std::uint8_t state = kStopped;
};

struct Resource {
  SIMVIS_MESSAGE("simulation_interfaces/msg/Resource", uri, resource_string);
  std::string uri;
  std::string resource_string;
};

struct EntityCategory {
  SIMVIS_MESSAGE("simulation_interfaces/msg/EntityCategory", category);
  std::uint8_t category = 0;
};

struct TagsFilter {
  SIMVIS_MESSAGE("simulation_interfaces/msg/TagsFilter", tags, filter_mode);
  std::vector<std::string> tags;
  std::uint8_t filter_mode = 0;
};

struct Bounds {
  SIMVIS_MESSAGE("simulation_interfaces/msg/Bounds", type, points);
  std::uint8_t type = 0;
  std::vector<Vector3> points;
};

struct EntityFilters {
  SIMVIS_MESSAGE("simulation_interfaces/msg/EntityFilters", filter, categories, tags, bounds);
  std::string filter;
  std::vector<EntityCategory> categories;
  TagsFilter tags;
  Bounds bounds;
};

struct Accel {
  SIMVIS_MESSAGE("geometry_msgs/msg/Accel", linear, angular);
  Vector3 linear;
  Vector3 angular;
};

struct EntityState {
  SIMVIS_MESSAGE("simulation_interfaces/msg/EntityState", header, pose, twist, acceleration);
  Header header;
  Pose pose;
  Twist twist;
  Accel acceleration;
};

struct EntitySpawn {
  SIMVIS_MESSAGE("simulation_interfaces/msg/SpawnEntity", name, allow_renaming, entity_resource, entity_namespace,
                 initial_pose);
  std::string name;
  bool allow_renaming = false;
  Resource entity_resource;
  std::string entity_namespace;
  PoseStamped initial_pose;
};

struct SpawnResult {
  SIMVIS_MESSAGE("simulation_interfaces/msg/SpawnResult", result, entity_name);
  static constexpr std::uint8_t kNameNotUnique = 101, kNameInvalid = 102, kUnsupportedFormat = 103, kNoResource = 104,
                                kNamespaceInvalid = 105, kResourceParseError = 106, kInvalidPose = 109;
  SimulationResult result;
  std::string entity_name;
};

/// Requests of GetSimulatorFeatures and GetSimulationState are the same: ROS 2 gives a message without fields one.
struct EmptyRequest {
  SIMVIS_MESSAGE("simulation_interfaces/srv/GetSimulationState_Request", header, structure_needs_at_least_one_member);
  RequestHeader header;
  std::uint8_t structure_needs_at_least_one_member = 0;
};

struct GetSimulatorFeaturesReply {
  SIMVIS_MESSAGE("simulation_interfaces/srv/GetSimulatorFeatures_Response", header, features);
  RequestHeader header;
  SimulatorFeatures features;
};

struct SpawnEntityRequest {
  SIMVIS_MESSAGE("simulation_interfaces/srv/SpawnEntity_Request", header, spawn);
  RequestHeader header;
  EntitySpawn spawn;
};

struct SpawnEntityReply {
  SIMVIS_MESSAGE("simulation_interfaces/srv/SpawnEntity_Response", header, result, entity_name);
  RequestHeader header;
  SimulationResult result;
  std::string entity_name;
};

struct SpawnEntitiesRequest {
  SIMVIS_MESSAGE("simulation_interfaces/srv/SpawnEntities_Request", header, spawn_requests);
  RequestHeader header;
  std::vector<EntitySpawn> spawn_requests;
};

struct SpawnEntitiesReply {
  SIMVIS_MESSAGE("simulation_interfaces/srv/SpawnEntities_Response", header, result, results);
  static constexpr std::uint8_t kSpawnFailed = 150;
  RequestHeader header;
  SimulationResult result;
  std::vector<SpawnResult> results;
};

/// Requests of DeleteEntity and GetEntityState are the same.
struct EntityRequest {
  SIMVIS_MESSAGE("simulation_interfaces/srv/GetEntityState_Request", header, entity);
  RequestHeader header;
  std::string entity;
};

/// Replies of DeleteEntity, SetEntityState, SetSimulationState, StepSimulation and ResetSimulation are the same.
struct ResultReply {
  SIMVIS_MESSAGE("simulation_interfaces/srv/DeleteEntity_Response", header, result);
  RequestHeader header;
  SimulationResult result;
};

/// Requests of GetEntities and GetEntitiesStates are the same.
struct EntitiesRequest {
  SIMVIS_MESSAGE("simulation_interfaces/srv/GetEntities_Request", header, filters);
  RequestHeader header;
  EntityFilters filters;
};

struct GetEntitiesReply {
  SIMVIS_MESSAGE("simulation_interfaces/srv/GetEntities_Response", header, result, entities);
  RequestHeader header;
  SimulationResult result;
  std::vector<std::string> entities;
};

struct GetEntitiesStatesReply {
  SIMVIS_MESSAGE("simulation_interfaces/srv/GetEntitiesStates_Response", header, result, entities, states);
  RequestHeader header;
  SimulationResult result;
  std::vector<std::string> entities;
  std::vector<EntityState> states;
};

struct GetEntityStateReply {
  SIMVIS_MESSAGE("simulation_interfaces/srv/GetEntityState_Response", header, result, state);
  RequestHeader header;
  SimulationResult result;
  EntityState state;
};

struct SetEntityStateRequest {
  SIMVIS_MESSAGE("simulation_interfaces/srv/SetEntityState_Request", header, entity, state, set_pose, set_twist,
                 set_acceleration);
  static constexpr std::uint8_t kInvalidPose = 101;
  RequestHeader header;
  std::string entity;
  EntityState state;
  bool set_pose = false;
  bool set_twist = false;
  bool set_acceleration = false;
};

struct GetSimulationStateReply {
  SIMVIS_MESSAGE("simulation_interfaces/srv/GetSimulationState_Response", header, state, result);
  RequestHeader header;
  SimulationState state;
  SimulationResult result;
};

struct SetSimulationStateRequest {
  SIMVIS_MESSAGE("simulation_interfaces/srv/SetSimulationState_Request", header, state);
  static constexpr std::uint8_t kAlreadyInTargetState = 101, kTransitionError = 102, kIncorrectTransition = 103;
  RequestHeader header;
  SimulationState state;
};

struct StepSimulationRequest {
  SIMVIS_MESSAGE("simulation_interfaces/srv/StepSimulation_Request", header, steps);
  RequestHeader header;
  std::uint64_t steps = 1;
};

struct ResetSimulationRequest {
  SIMVIS_MESSAGE("simulation_interfaces/srv/ResetSimulation_Request", header, scope);
  static constexpr std::uint8_t kDefault = 0, kTime = 1, kState = 2, kSpawned = 4;  // bits
  RequestHeader header;
  std::uint8_t scope = kDefault;
};

}  // namespace simvis::ros
