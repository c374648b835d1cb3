// From commands to a scene that can run: parts in place, elements made, sensors mounted.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "elements/element.h"
#include "scenegraph/command.h"
#include "scenegraph/scene.h"
#include "sensors/sensor.h"
#include "simvis/parameters.h"
#include "simvis/simulation.h"

namespace simvis {

/// A sensor and the place in the graph that gives its pose.
struct BuiltSensor {
  std::string name, type;
  std::unique_ptr<Sensor> sensor;
  std::shared_ptr<Mount> mount;
};

struct BuiltScene {
  Scene scene;
  Parameters parameters;                           ///< with the change log of the executed commands
  std::vector<std::unique_ptr<Element>> elements;  ///< elements[i] belongs to parameters.elements()[i]
  std::vector<BuiltSensor> sensors;                ///< in the order of their commands
};

/// Executes commands in order. One may refer only to insertion points that exist by then.
///
/// Carried  the commands that a part file carries are executed right after the part is inserted. Relative file names in
///          them start at the part's folder; `insert_at` may be left out and is then the part's own insertion point.
///          When the same file is inserted again under a name N, the names that its commands give become N/NAME.
/// Override replaces or adds an attribute of every sensor of its type, those that parts carry too.
/// Seed     of all random numbers; each sensor gets it.
/// Errors   InputError with the place.
BuiltScene build_scene(std::span<const Command> commands, std::span<const AttributeOverride> overrides = {},
                       std::uint64_t seed = 0);

}  // namespace simvis
