// A scene that accepts commands during its whole lifetime and uses a default light while it declares no other light.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <simvis/command.h>
#include "engine/base/program_api.h"
#include "simvis/scene_builder.h"

namespace simvis {

class LiveScene {
 public:
  /// Throws InputError for an error in the commands, for an override that is invalid for its sensor type, for a package
  /// whose folder does not exist, and, if `strict`, for a warning. With `is_on`, only what these sensors need is read,
  /// unless `strict`; without it, all is read but the pictures that no sensor shows.
  SIMVIS_PROGRAM_API LiveScene(std::vector<AttributeOverride> overrides, std::span<const Command> commands,
                               std::uint64_t seed = 0, ProgressCallback progress = {},
                               std::vector<PackageFolder> packages = {}, bool strict = false,
                               SensorSelection is_on = {});
  LiveScene(const LiveScene&) = delete;
  LiveScene& operator=(const LiveScene&) = delete;

  /// All or nothing: if it throws InputError, which contains the location, the scene is unchanged.
  void execute(std::span<const Command> commands);

  /// See Simulation::add_variant().
  void add_variant(std::size_t sensor, const Command& command) { builder_.add_variant(sensor, command); }

  /// See SceneBuilder::check_changes().
  void check_changes(std::function<void(const BuiltScene&)> check) { builder_.check_changes(std::move(check)); }

  /// See SceneBuilder::select() and read_for_sensors().
  void select(SensorSelection is_on) { builder_.select(std::move(is_on)); }
  void read_for_sensors() { builder_.read_for_sensors(); }

  /// See SceneBuilder::require().
  void require(std::function<const TargetLimits&()> limits) { builder_.require(std::move(limits)); }

  BuiltScene built;

 private:
  bool declares_light() const;

  std::vector<AttributeOverride> overrides_;
  SceneBuilder builder_;
  std::shared_ptr<Switch> default_light_;
};

}  // namespace simvis
