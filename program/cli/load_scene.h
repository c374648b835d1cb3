// Loads the scene that the command line names, with the options that concern it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <simvis/error.h>
#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "program/cli/loading_bar.h"
#include "program/options/options.h"

namespace simvis {

/// Runs `action`; its errors name this option of the command line.
template <typename Action>
void in_option(const std::string& option, const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    throw InputError(option + ": " + error.what());
  }
}

/// Whether progress bars are shown.
bool shows_progress(const Options& options);

/// What the options say of the scene and of the device: rate, seed, overrides, packages. Throws InputError.
SimulationDesc scene_desc(const Options& options);

/// The folders below which requests of clients may name files: those of --allow, or the scene's.
std::vector<std::filesystem::path> request_folders(const Options& options);

/// How the options of --serve say that the simulation is served.
ServeDesc serve_desc(const Options& options);
DdsDesc dds_desc(const Options& options);
/// Empty: the default domain. Throws InputError.
std::optional<std::uint32_t> dds_domain(const std::string& text);

/// Loads the scene, restores a state, sets parameters and turns sensors off. `loading` shows the progress of loading
/// until it is reset.
Simulation load(const Options& options, std::optional<LoadingBar>& loading);

/// Empty without --trajectory. Warns of parameters that --set sets too.
std::optional<Trajectory> read_trajectory(const Options& options, Simulation& simulation);

/// The number of frames until the end of the trajectory.
std::uint64_t frames_of(const Trajectory& trajectory, const Options& options, const Simulation& simulation);

}  // namespace simvis
