// Maps as ground truth: --export of a name that ends with .yaml, .npz or .bt.
#pragma once

#include <memory>

#include <simvis/simulation.h>
#include "program/cli/run_outlet.h"
#include "program/options/options.h"

namespace simvis {

/// The map of the scene after the last frame, see program/maps/map_files.h. Its files appear with finish(), or not at
/// all. The picture of a ROS map appears before the file that names it, and an earlier file of that name is removed
/// before: it never names the picture of another map. Throws InputError of the options that describe maps, with the
/// option's name, of a name that is reserved for the calibration of a sensor, and as export_outlet(). finish() adds a
/// warning to the simulation if the map lacks shapes without a surface, or has no occupied cell.
std::unique_ptr<RunOutlet> map_outlet(const Options& options, Simulation& simulation);

/// Throws InputError if an option that describes maps is given and `--export` names no map.
void require_map_for_map_options(const Options& options);

}  // namespace simvis
