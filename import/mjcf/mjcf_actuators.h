// The actuators of an MJCF model at its joints.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "import/mjcf/mjcf_tree.h"
#include "import/model/import_report.h"
#include "import/model/model_description.h"

namespace simvis {

/// The two numbers of an attribute such as "forcerange" if they count: those that are written do, unless the attribute
/// `limited` or the model says otherwise. Throws InputError if they do not rise.
std::optional<std::array<double, 2>> mjcf_limits(const MjcfElement& element, const char* range, const char* limited);

/// The drives of joints by the joint's name in the file, in its coordinates there, which count from `ref`. A motor has
/// the effort at the joint as its target, gear included. What is not taken over is reported: actuators of tendons,
/// sites and bodies, a second one at a joint, activation, gains that are not constant. Throws InputError for wrong
/// numbers.
std::map<std::string, ModelDrive> read_mjcf_drives(const MjcfTree& tree, ImportReport& report);

}  // namespace simvis
