// Sensor types and their registry: a type is a name, tables of attributes and of outputs, and a function that makes a
// sensor of it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/command.h>
#include <simvis/cost_model.h>
#include <simvis/effect.h>
#include <simvis/export.h>
#include <simvis/output_spec.h>
#include <simvis/ray_caster.h>
#include <simvis/sensor_preset.h>
#include <simvis/version.h>

namespace simvis {

class Device;
class Sensor;

/// What a sensor's constructor gets. It is valid during the call of SensorType::create only.
struct SensorContext {
  const Command& command;             ///< the whole command
  const AttributeValues& attributes;  ///< checked against all_attributes() of the type
  std::string name;                   ///< the sensor's name
  std::uint64_t seed = 0;             ///< of all random numbers of the run

  /// The insertion point of the command; ROOT if it says none.
  std::string insertion_point() const {
    const CommandAttribute* const point = command.find("insert_at");
    return point == nullptr ? "ROOT" : point->value;
  }
};

/// One row of a price list: values of the accuracy attributes of a scanner. A value is set only if the method uses it.
struct ScanVariant {
  std::string method;                   ///< as written in the scene; empty: the type has no attribute `method`
  std::optional<double> resolution_px;  ///< `resolution`: pixels across 90 degrees
  std::optional<double> max_error_rel;  ///< largest bound as a share of the range
  std::optional<double> max_error_m{};  ///< largest bound in metres

  bool operator==(const ScanVariant&) const = default;  ///< member by member
};

/// The variants of one scanner that a price list compares. Those of method "raycast" are what errors are taken from.
struct ScanVariants {
  ScanVariant own;                     ///< that the scanner's command selects, with the defaults of what it omits
  std::vector<ScanVariant> priced;     ///< for --price; contains `own`
  std::vector<ScanVariant> by_method;  ///< for --summary: one of each method
};

/// The description of a sensor type for the registry.
struct SensorType {
  std::string_view name;          ///< the command's `type`
  std::string_view summary;       ///< one sentence
  std::string_view notes{};       ///< what the table does not say: paragraphs, separated by '\n'; may be empty
  std::uint8_t capabilities = 0;  ///< what its sensors have, as a sum of SensorCapability
  /// Of a type whose sensors give readings: the ROS 2 message that is made of one, "sensor_msgs/msg/Imu".
  /// exchange/messages/from_reading.h lists them, and the columns that each uses. Of a reading with one row, each
  /// column without a message gives a std_msgs/msg/Float64; so do all if this is empty.
  std::string_view message{};
  AttributeTable attributes{};  ///< its own attributes; all_attributes() adds those of its effects
  std::unique_ptr<Sensor> (*create)(const SensorContext& context);  ///< makes a sensor; may throw InputError
  std::span<const SensorPreset> presets{};  ///< a type with presets has the row kPresetAttribute
  /// Measures on this device what each term of the cost model costs, in nanoseconds, for sensors that choose a method
  /// by predicted cost. It takes about 0.3 s. Null: the sensors of this type do not choose.
  CostModel (*measure_costs)(Device& device, RayCaster& rays) = nullptr;
  /// For types that cast beams: the variants of the sensor that a command describes. Throws what create() throws. Null:
  /// one variant for each choice of the attribute `method`, with the other attributes of the command; without this
  /// attribute, the sensor as it is.
  ScanVariants (*scan_variants)(const SensorContext& context) = nullptr;
  /// Everything that a sensor of the type can give, in the order of its columns and images. What this command does not
  /// make it give is not `given`. It is also called for a command with nothing but type, name and insert_at, even if
  /// the type requires more, and does not throw then. Null: the type describes no output.
  std::vector<OutputSpec> (*outputs)(const SensorContext& context) = nullptr;
  /// Whether its sensors see shapes: they draw, cast rays, or read the items of the draw list. Files that have only
  /// shapes are not read for others.
  bool sees_shapes = true;
};

/// Expands the attribute `preset`: the result has the preset's attributes where the command does not write them itself,
/// with the place of `preset`, and has no attribute `preset`.
///
/// Errors   InputError at the attribute if the type has no preset of that name.
SIMVIS_API Command with_preset(Command command, const SensorType& type);

/// The presets of a type as `--describe` prints them; empty if it has none.
SIMVIS_API std::string describe_presets(const SensorType& type);

/// The row `rate`, for the table of a sensor type.
inline constexpr AttributeSpec kRateAttribute{.name = "rate",
                                              .kind = AttributeKind::number,
                                              .unit = "Hz",
                                              .text = "measurements per second; default: every frame",
                                              .min = 0,
                                              .open_min = true};

/// Attributes that every sensor command may carry in addition to its type's own.
inline constexpr std::string_view kSensorCommonAttributes[] = {"type",       "name",    "insert_at", "pose_offset",
                                                               "quaternion", "look_at", "frame",     "topics"};

/// A static object of this type registers a sensor type.
///
/// Errors    the constructor does not throw. A type whose name is taken, whose table has a mistake, or that was
///           compiled with headers of another version is refused: load_plugin() then refuses the plug-in that has it,
///           and Simulation::load() throws InputError for a type of the program itself.
/// Lifetime  strings and the table of the type must live as long as the registry.
/// Threads   any thread; other threads may look types up meanwhile.
struct SIMVIS_API SensorRegistration {
  /// `built_for` is the version of the headers that the caller is compiled with.
  explicit SensorRegistration(const SensorType& type, std::string_view built_for = kHeaderVersion);
};

/// The sensor type of this name, or null. The pointer is valid for the rest of the program, except for a type of a
/// plug-in that load_plugin() refuses.
SIMVIS_API const SensorType* find_sensor_type(std::string_view name);
/// All sensor types, sorted by name. Lifetime as find_sensor_type().
SIMVIS_API std::vector<const SensorType*> sensor_types();

/// The type's own attributes and those of the effects in the catalogue that it may have, see <simvis/effect.h>.
SIMVIS_API std::vector<AttributeSpec> all_attributes(const SensorType& type);

/// Everything that sensors of the type can give; shapes are those of a command without attributes.
SIMVIS_API std::vector<OutputSpec> all_outputs(const SensorType& type);
/// What the sensor of this command gives. Throws InputError at an attribute that the type does not allow.
SIMVIS_API std::vector<OutputSpec> outputs_of(const SensorType& type, const Command& command);
/// The outputs of a sensor whose reading has these columns, with the message of its type.
SIMVIS_API std::vector<OutputSpec> reading_outputs(const SensorContext& context, std::span<const TableColumn> columns,
                                                   bool one_row = true);

/// Whether sensors of the type of this name may carry the effect's attributes. False for an unknown name.
SIMVIS_API bool may_have(std::string_view sensor_type, const EffectType& effect);

}  // namespace simvis
