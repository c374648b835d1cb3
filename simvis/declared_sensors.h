// Sensors that the file of a model declares for another simulator, and that become sensors of the scene around it.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include <simvis/command.h>
#include <simvis/part_importer.h>
#include "simvis/scene_builder.h"

namespace simvis {

/// Whether a command that the file carries is a sensor that it declares. Files that are no models have sensors that
/// were written for a scene.
bool is_declared(const Command& command, const PartContent& content);

/// Names of a scene.
struct SceneNames {
  const std::set<std::string>& written_sensors;  ///< in the commands under way
  const std::vector<BuiltSensor>& sensors;       ///< that exist
  std::function<bool(const std::string&)> is_point;
};

/// Makes the declared sensors among the commands such that the scene takes them, with a warning for each change:
///
/// left out  a sensor whose name a sensor of the scene's own has, and one with a value that its type does not take
/// dropped   a topic of the simulation, one that another sensor has or that lies below its name, and a frame that is
///           another insertion point, sensor or frame of a sensor, or whose optical frame is
void adapt_declared_sensors(std::vector<Command>& commands, const PartContent& content, const SceneNames& names,
                            const std::function<void(const std::string&)>& warn);

}  // namespace simvis
