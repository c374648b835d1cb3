// The parts of a running scene as entities of simulation_interfaces: they are listed, placed, spawned and removed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <simvis/command.h>
#include <simvis/simulation.h>
#include "exchange/messages/types/simulation_types.h"
#include "simvis/scene_builder.h"
#include "simvis/sharing/allowed_folders.h"

namespace simvis {

/// Why a service does not do what a request asks for: a code of Result.msg or of the service, and its text.
struct ServiceRefusal : std::runtime_error {
  ServiceRefusal(std::uint8_t code, const std::string& message) : std::runtime_error(message), result(code) {}
  std::uint8_t result;
};

/// Frames  states are in the world's frame; requests name frames as tf does, and parts and links by their own names.
/// Errors  ServiceRefusal for what a request may not have; InputError and MachineError of the simulation.
class SceneEntities {
 public:
  /// The scene is at its start now. `simulation` must outlive it. Resources lie below `folders`. Throws InputError:
  /// there is no such folder.
  SceneEntities(Simulation& simulation, std::span<const std::filesystem::path> folders);

  /// The names that match.
  std::vector<std::string> names(const ros::EntityFilters& filters);
  /// As the scene stands, with the velocity of a body of physics in the last frame. Empty: the entity is switched off.
  std::optional<ros::EntityState> state(const std::string& entity);
  /// The same of many entities, all of which are there.
  std::vector<std::optional<ros::EntityState>> states(std::span<const std::string> entities);
  /// Puts an entity somewhere, and its body at rest. The codes of a wrong pose are those of SetEntityState.
  void place(const std::string& entity, const ros::EntityState& state);
  /// Returns the name of the new entity.
  std::string spawn(const ros::EntitySpawn& request);
  void remove(const std::string& entity);
  void remove_spawned();
  /// Removes all parts, elements and sensors that were added since the start, by whatever request. Throws InputError if
  /// one of the start was removed, and then removes nothing.
  void remove_added();
  /// A frame has been made: bodies that were put somewhere may move again.
  void forget_places() { placed_.clear(); }

 private:
  const BuiltScene& scene();
  void require(const std::string& entity);
  glm::dmat4 world_from_frame(const std::string& frame);
  std::optional<glm::dmat4> world_from(const std::string& point);
  std::optional<std::size_t> find_pose_element(const std::string& entity);
  glm::dmat4 world_from_element(const std::string& element);
  std::size_t pose_element(const std::string& entity);
  void set_pose(const ElementDescriptor& element, const glm::dmat4& parent_from_child);
  std::string free_name(const ros::EntitySpawn& request, const std::string& stem);
  bool is_taken(const std::string& name);
  bool has_element(const std::string& name);
  bool has_sensor(const std::string& name);
  std::string free_element(const std::string& entity);
  bool stands(const Command& made);
  void remove_made_by(std::span<const std::size_t> commands);
  void execute(const std::string& xml);

  Simulation& simulation_;
  AllowedFolders folders_;
  // Numbers in the log of changes: of the commands whose objects stood at the start, and of those that have spawned.
  std::vector<std::size_t> start_, spawned_;
  std::set<std::string> placed_;  // since the last frame
};

}  // namespace simvis
