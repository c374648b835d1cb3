// From commands to a scene that can run: parts in place, elements made, sensors mounted.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include <simvis/element.h>
#include <simvis/parameters.h>
#include <simvis/scene.h>
#include <simvis/sensor.h>
#include <simvis/simulation_desc.h>
#include "scenegraph/name_set.h"

namespace simvis {

/// A sensor and the place in the graph that gives its pose.
struct BuiltSensor {
  std::string name, type;
  Command command;  ///< as executed: with overrides, its preset written out, and names as its part has given them
  std::unique_ptr<Sensor> sensor;
  std::shared_ptr<Mount> mount;
};

struct BuiltScene {
  Scene scene;
  Parameters parameters;                           ///< with the change log of the executed commands
  std::vector<std::unique_ptr<Element>> elements;  ///< elements[i] belongs to parameters.elements()[i]
  std::vector<BuiltSensor> sensors;                ///< in the order of their commands
};

/// Executes commands in order. One may refer only to insertion points, parts and elements that exist by then; sensors
/// may come later in the same list.
///
/// Carried  the commands that a part file carries are executed right after the part is inserted. Relative file names in
///          them start at the part's folder; `insert_at` may be left out and is then the part's own insertion point.
///          When the same file is inserted again under a name N, or one of its names is taken, the names that its
///          commands give and the insertion points within it become N/NAME.
/// Seed     of all random numbers; each sensor gets it.
/// Override replaces or adds an attribute of every sensor of its type, those that parts carry too.
class SceneBuilder {
 public:
  /// Throws InputError for an override of a type that does not exist. `overrides` must live as long as the builder.
  SceneBuilder(BuiltScene& built, std::span<const AttributeOverride> overrides, std::uint64_t seed = 0,
               ProgressCallback progress = {});

  /// All or nothing: when it throws InputError, with the place, the scene is as it was.
  void execute(std::span<const Command> commands);

  /// See Simulation::add_variant(). All or nothing.
  void add_variant(std::size_t sensor, const Command& command);

  /// From now on sensors must be within what this device can do; throws InputError for one that is not yet.
  void require(const TargetLimits& limits);

 private:
  // What a carried command or one of the scene's own waits for: a sensor of this name that gives scans.
  struct Awaited {
    std::string sensor;
    Location where;
  };
  template <typename Action>
  void all_or_nothing(const Action& action);
  void run(std::span<const Command> commands);
  void execute_one(const Command& command);
  void check_order(const Command& command, std::span<const Command> later) const;
  void check_references(const AttributeValues& attributes, AttributeTable table);
  void check_awaited();
  void log_change(const Command& command);
  void run_carried(const Command& part, const PartContent& content, const std::string& prefix);
  std::vector<Command> carried_commands(const Command& part, const PartContent& content) const;
  bool clashes(std::span<const Command> carried, const PartContent& content) const;
  void insert_part(const Command& command);
  void insert_element(const Command& command);
  void insert_sensor(const Command& command);
  BuiltSensor make_sensor(const Command& written);
  void add_sensor(BuiltSensor sensor);
  Command overridden(Command command) const;
  Element* find_element(std::string_view name) const;

  BuiltScene& built_;
  std::span<const AttributeOverride> overrides_;
  std::uint64_t seed_;
  ProgressCallback progress_;
  std::optional<TargetLimits> limits_;
  NameSet element_names_{"element"}, sensor_names_{"sensor"};
  std::set<std::filesystem::path> carriers_;  // files whose carried commands were executed before
  std::vector<std::filesystem::path> open_;   // files whose carried commands are being executed
  std::vector<Awaited> awaited_;
};

/// A scene of these commands. Throws InputError.
BuiltScene build_scene(std::span<const Command> commands, std::span<const AttributeOverride> overrides = {});

}  // namespace simvis
