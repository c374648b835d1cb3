// Builds a scene from commands: inserts parts, creates elements and mounts sensors.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/command.h>
#include <simvis/element.h>
#include <simvis/parameters.h>
#include <simvis/scene.h>
#include <simvis/sensor.h>
#include <simvis/simulation_desc.h>
#include "scenegraph/name_set.h"

namespace simvis {

class DelayedSensor;
class RandomizeElement;

/// A sensor and the node of the scene graph that defines its pose.
struct BuiltSensor {
  std::size_t id = 0;  ///< no other sensor of the scene ever has it; ascending in BuiltScene::sensors
  std::string name, type;
  Command command;  ///< as executed: with overrides, with the attributes of its preset, and with prefixed names
  std::vector<OutputSpec> outputs;  ///< that the command makes the sensor give
  std::unique_ptr<Sensor> sensor;
  DelayedSensor* delayed = nullptr;  ///< the same sensor, if its measurements have timing faults
  std::shared_ptr<Mount> mount;
};

struct BuiltScene {
  std::string name;  ///< of its file, as it was given, or of its text: what messages call the scene
  Scene scene;
  Parameters parameters;  ///< with the change log of the executed commands
  /// elements[i] belongs to parameters.elements()[i]; null if that was removed.
  std::vector<std::unique_ptr<Element>> elements;
  std::vector<BuiltSensor> sensors;  ///< in the order of their commands, without removed ones
  std::size_t next_sensor_id = 0;
};

/// Whether the sensor of this name is on.
using SensorSelection = std::function<bool(std::string_view name)>;

/// What needs the shapes of a scene that has not been built, for people, as its commands say it: a sensor that sees
/// them. A scene without sensors needs them too, because what it is for is not known. Empty: no sensor that is on
/// needs them, but the file of a part may carry one.
std::optional<std::string> need_of_shapes(std::span<const Command> commands, const SensorSelection& is_on);

/// Executes commands in order. A command may refer only to insertion points, parts and elements that exist when it is
/// executed; sensors that it refers to may follow later in the same list.
///
/// Carried  the commands in a part file are executed right after the part is inserted. Relative file names in these
///          commands start at the folder of the part; `insert_at` is optional and defaults to the insertion point of
///          the part. If the same list of commands inserts the file several times, the names in its commands and its
///          insertion points become N/NAME for each insertion N, the first one too. They also do so if a list that was
///          executed before has inserted the file, or if one of its names is taken.
/// Included commands of an included file have its scope: their names, and those of the parts that they insert, get its
///          prefix.
/// Removed  `remove` takes out a part, element or sensor with everything that was inserted at its insertion points, and
///          with what the commands in its file have made. What stays may not refer to any of it.
/// Seed     the seed of all random numbers; each sensor receives it.
/// Override replaces or adds an attribute of every sensor of its type, including the sensors in part files.
class SceneBuilder {
 public:
  /// Throws InputError for an override of a type that does not exist. `overrides` must live as long as the builder.
  SceneBuilder(BuiltScene& built, std::span<const AttributeOverride> overrides, std::uint64_t seed = 0,
               ProgressCallback progress = {});

  /// All or nothing: if it throws InputError, which contains the location, the scene is unchanged.
  void execute(std::span<const Command> commands);

  /// See Simulation::add_variant(). All or nothing.
  void add_variant(std::size_t sensor, const Command& command);

  /// From now on `check` is called after each change, before it is kept. If it throws InputError, the change is undone
  /// and the error goes on; it may lack the location.
  void check_changes(std::function<void(const BuiltScene&)> check) { check_ = std::move(check); }

  /// From now on, only these sensors count as those that need shapes and pictures. Until then all do.
  void select(SensorSelection is_on) { is_on_ = std::move(is_on); }

  /// Reads what the sensors need that are on and has been postponed: shapes and pictures. Throws InputError, and then
  /// keeps the scene as it was.
  void read_for_sensors();

  /// From now on, sensors that draw must be within the limits of the device, which are asked for when there is one.
  /// Throws InputError if an existing sensor that is on is not.
  void require(std::function<const TargetLimits&()> limits);

 private:
  // What a command inserted before an insertion point.
  struct Inserted {
    CommandKind kind;
    bool moves = false;  // what follows it
    std::string name, insert_at;
    Location where;
  };
  static void check_override(const AttributeOverride& override);
  template <typename Action>
  void all_or_nothing(const Action& action);
  void read_needed();
  void run(std::span<const Command> commands);
  void note_copies(std::span<const Command> commands);
  void execute_one(const Command& command);
  void execute_named(const Command& command);
  void announce(std::span<const Command> commands);
  Command named(Command command) const;
  void resolve(CommandKind kind, CommandAttribute& reference, const IncludeScope* scope) const;
  std::string prefix_of_pattern(const std::string& pattern, const IncludeScope* scope) const;
  bool exists(CommandKind kind, const std::string& name) const;
  void check_order(const Command& command, std::span<const Command> later) const;
  void check_references(const AttributeValues& attributes, AttributeTable table);
  void check_awaited(std::uint64_t first_made) const;
  void remember(const Command& command, bool moves);
  void note_made(const Command& command, AttributeTable table, std::size_t first_step);
  void remove(const Command& command);
  std::uint64_t find_made(const Command& command) const;
  std::optional<std::uint64_t> find_made(const Command& command, const std::string& name) const;
  std::set<std::uint64_t> hanging_on(std::uint64_t made) const;
  void refuse_referred(const Command& command, const std::set<std::uint64_t>& doomed) const;
  void take_out(std::uint64_t made);
  void take_out_element(const std::string& name);
  void take_out_sensor(const std::string& name);
  void warn_of_unmoved_sensors();
  void log_change(Command command);
  void claim(NameSet& names, const CommandAttribute& name);
  void run_carried(const Command& part, const PartContent& content, const std::string& prefix);
  std::vector<Command> carried_commands(const Command& part, const PartContent& content) const;
  bool clashes(std::span<const Command> carried, const PartContent& content, const std::string& prefix,
               const std::string& part_name) const;
  void insert_part(const Command& command);
  void insert_logged_part(const Command& command);
  void insert_element(const Command& command);
  void insert_sensor(const Command& command);
  BuiltSensor make_sensor(const Command& written);
  void add_sensor(BuiltSensor sensor);
  Command overridden(Command command) const;
  Element* find_element(std::string_view name) const;
  void bind(RandomizeElement& randomized) const;

  BuiltScene& built_;
  std::span<const AttributeOverride> overrides_;
  std::uint64_t seed_;
  ProgressCallback progress_;
  std::function<const TargetLimits&()> limits_;
  std::function<void(const BuiltScene&)> check_;  // empty: none
  SensorSelection is_on_;                         // empty: all are
  NameSet element_names_{"element"}, sensor_names_{"sensor"};
  std::set<std::string> announced_sensors_;  // of included files, in the commands that are being executed
  // A file with the prefix of the file that includes its command.
  using Carrier = std::pair<std::string, std::filesystem::path>;
  void note_carrier(const Carrier& carrier);
  std::multiset<Carrier> carriers_;          // files whose carried commands have been executed, once for each part
  std::set<Carrier> copied_;                 // files that a list of commands inserts several times
  std::vector<std::filesystem::path> open_;  // files whose carried commands are being executed
  std::vector<Inserted> inserted_;           // by the commands that are being executed, in order

  // What an executed command made.
  struct Made {
    struct Reference {
      CommandKind kind;
      std::string attribute, name;
      std::string object;  // that the name of a part or of what stands in one finds; else empty
      Location where;
    };
    CommandKind kind;
    std::string name, insert_at;
    Location where;
    std::vector<Reference> references;     // of its attributes
    std::vector<std::string> points;       // insertion points of a part
    std::optional<std::uint64_t> carrier;  // the part whose file has the command
    std::vector<UndoLog::Step> steps;      // they take it out of the scene
  };
  std::map<std::uint64_t, Made> made_;  // in the order of their commands, without removed ones
  std::uint64_t next_made_ = 0;
  std::vector<std::uint64_t> open_parts_;  // parts whose carried commands are being executed
  bool removed_ = false;                   // by the commands that are being executed
};

/// Builds a scene from `commands`. Throws InputError.
BuiltScene build_scene(std::span<const Command> commands, std::span<const AttributeOverride> overrides = {},
                       std::uint64_t seed = 0);

}  // namespace simvis
