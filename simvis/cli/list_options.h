// The options of simvis-run that list what a scene has, or which types there are. They need no device.
#pragma once

#include <string>

#include <simvis/simulation_desc.h>

namespace CLI {
class App;
}

namespace simvis {

struct ListOptions {
  bool scene = false, types = false, json = false;
};

/// Declares --list, --json and --list-types. The options that they exclude are declared already.
void declare_list_options(CLI::App& app, ListOptions& options);

/// What --list prints: the scene file as loaded with the overrides and packages of `desc`. Throws InputError.
std::string scene_listing(const std::string& scene, const SimulationDesc& desc, bool json);

}  // namespace simvis
