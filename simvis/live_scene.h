// A scene that takes commands for as long as it lives, and lights itself while nothing else does.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <simvis/command.h>
#include "simvis/scene_builder.h"

namespace simvis {

class LiveScene {
 public:
  /// Throws InputError for a mistake in the commands, and for an override that no sensor of its type could have.
  LiveScene(std::vector<AttributeOverride> overrides, std::span<const Command> commands, std::uint64_t seed = 0,
            ProgressCallback progress = {});
  LiveScene(const LiveScene&) = delete;
  LiveScene& operator=(const LiveScene&) = delete;

  /// All or nothing: when it throws InputError, with the place, the scene is as it was.
  void execute(std::span<const Command> commands);

  /// See Simulation::add_variant().
  void add_variant(std::size_t sensor, const Command& command) { builder_.add_variant(sensor, command); }

  /// From now on sensors must be within what this device can do; throws InputError for one that is not yet.
  void require(const TargetLimits& limits) { builder_.require(limits); }

  BuiltScene built;

 private:
  bool declares_light() const;

  std::vector<AttributeOverride> overrides_;
  SceneBuilder builder_;
  std::shared_ptr<Switch> default_light_;
};

}  // namespace simvis
