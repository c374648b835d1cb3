// What simvis-run prints of a scene in place of a run, without a device.
#pragma once

#include <string>
#include <vector>

#include <simvis/simulation_desc.h>

namespace simvis {

/// What --list prints: the scene file as loaded with the overrides and packages of `desc`. Throws InputError.
std::string scene_listing(const std::string& scene, const SimulationDesc& desc, bool json);

/// What --check prints of a scene that is loaded as for --list. Throws InputError.
struct SceneCheck {
  std::string text;
  std::vector<std::string> warnings;
  bool has_problems = false;
};
SceneCheck scene_check(const std::string& scene, const SimulationDesc& desc);

}  // namespace simvis
