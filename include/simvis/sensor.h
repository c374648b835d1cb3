// Sensors: they are made by commands as elements are, and give measurements instead of taking parameters.
//
// To add a sensor type, add a pair of files with a class, its attribute table, and one static SensorRegistration; no
// other file changes. A class in a user's own program or in a plug-in library registers in the same way.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/command.h>
#include <simvis/cost_model.h>
#include <simvis/effect.h>
#include <simvis/export.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/frame_time.h>
#include <simvis/image.h>
#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include <simvis/scan.h>
#include <simvis/version.h>

namespace simvis {

class Device;

struct SensorType;

/// One attribute of a preset.
struct PresetAttribute {
  std::string_view name,  ///< as in a command
      value;              ///< as in a command
};

/// A device, as attributes of a sensor type. The strings live as long as the type.
struct SensorPreset {
  std::string_view name;                        ///< the value of the attribute `preset`: "sick_lms200"
  std::string_view summary;                     ///< the device, and which of its settings
  std::string_view source;                      ///< data sheets: title, revision, place in it
  std::span<const PresetAttribute> attributes;  ///< its attributes
};

/// The row `preset`, for the table of a sensor type that has presets.
inline constexpr AttributeSpec kPresetAttribute{
    .name = "preset",
    .kind = AttributeKind::text,
    .text = "a device (see below) that sets the defaults of other attributes; default: none"};

/// Expands the attribute `preset`: the result has the preset's attributes where the command does not write them itself,
/// with the place of `preset`, and has no attribute `preset`.
///
/// Errors   InputError at the attribute if the type has no preset of that name.
SIMVIS_API Command with_preset(Command command, const SensorType& type);

/// The presets of a type as `--describe` prints them; empty if it has none.
SIMVIS_API std::string describe_presets(const SensorType& type);

/// An insertion point of the scene.
struct SensedPoint {
  std::string name;                  ///< of the insertion point
  std::uint32_t number = 0;          ///< by name, among all that match, those that are off included
  glm::dmat4 world_from_point{1.0};  ///< rigid
};

/// A joint of the scene: an element of type `joint`.
struct SensedJoint {
  std::string name;     ///< the element's name
  bool slides = false;  ///< its position is in metres, otherwise in radians
  double position = 0,  ///< m or rad
      velocity = 0;     ///< m/s or rad/s, the mean since the previous frame; 0 at the first
};

/// Consecutive items of the draw list.
struct ItemRange {
  std::uint32_t first = 0,  ///< in DrawList::items
      end = 0;              ///< one past the last
};

/// What a sensor needs to know about the scene beyond its own pose and the draw list. Only this is computed.
struct SensorNeeds {
  bool motion = false;               ///< SensedWorld::motion()
  bool item_motion = false;          ///< SensedWorld::velocity_mps()
  std::vector<std::string> parts{};  ///< insertion points for SensedWorld::items_of()
  std::string points{};              ///< pattern of names for SensedWorld::points(): * any text, ? any character
  std::string joints_of{};           ///< insertion point for SensedWorld::joints()
  bool item_moves = false;           ///< SensedWorld::item_moves()
  std::string contacts_of{};         ///< insertion point for SensedWorld::contacts()
  std::string load_of{};             ///< element of type joint for SensedWorld::joint_load()

  /// Whether it is nothing.
  bool none() const {
    return !motion && !item_motion && !item_moves && parts.empty() && points.empty() && joints_of.empty() &&
           contacts_of.empty() && load_of.empty();
  }
};

/// What a sensor may know about the scene of the frame, as far as its SensorNeeds name it.
///
/// Lifetime  valid from Sensor::sense() until the end of cast() of the same frame.
class SIMVIS_API SensedWorld {
 public:
  virtual ~SensedWorld() = default;
  /// The motion of the sensor.
  virtual Motion motion() const = 0;
  /// The velocity of the matter of an item at a point of the world; world frame.
  virtual glm::dvec3 velocity_mps(std::uint32_t item, const glm::dvec3& point_m) const = 0;
  /// The items of what stands at an insertion point: of its part, and of everything inserted there. Empty if it is off.
  virtual ItemRange items_of(std::string_view point) const = 0;
  /// The insertion points whose names match the pattern, sorted by name, without those that are off. ROOT is not among
  /// them.
  virtual std::vector<SensedPoint> points() const = 0;
  /// The joints of the part that has the insertion point, those in its file included, in the order of their commands;
  /// of ROOT: all joints.
  virtual std::vector<SensedJoint> joints() const = 0;
  /// The items that have moved since the sensor was last due, in the order of the list. An item that is new since then,
  /// or that has changed its shape or scale, is not among them.
  virtual std::span<const ItemMove> item_moves() const = 0;
  /// Where physics has the body at the insertion point touch other bodies; at the point of a robot's link: this link,
  /// with what fixed joints hold on it. Empty if no body of physics stands there.
  virtual std::optional<std::vector<Contact>> contacts() const = 0;
  /// What the joint carries. Empty if no robot of physics has it.
  virtual std::optional<JointLoad> joint_load() const = 0;
};

/// One entry about a sensor in run.json.
struct SensorNote {
  std::string name;                                        ///< the key
  std::variant<double, std::uint64_t, std::string> value;  ///< the value
};

/// What a sensor reports about its measurements in addition to its method.
struct SensorReport {
  std::vector<SensorNote> notes;  ///< for run.json, in this order; names as there
  std::string explanation;        ///< for --explain: whole lines
};

/// Receives the output of a sensor after a frame. Implemented by the code that writes files.
///
/// Lifetime  arguments are valid during the call only.
/// Threads   called in the thread that calls Simulation::write().
class SIMVIS_API OutputSink {
 public:
  virtual ~OutputSink() = default;
  /// One image per frame. Either pointer may be null. `stem` is appended to the folder's name for sensors with several
  /// images ("left", "right"); empty for one image.
  virtual void picture(const std::string& stem, const Image* color, const Image* depth) = 0;
  /// One more image per frame, with a single channel of that name: "disparity".
  virtual void plane(const std::string& stem, const std::string& channel, const Image& plane) = 0;
  /// Gives the calibration of the camera whose images have this stem. It is called before picture() and plane().
  virtual void calibration(const std::string& /*stem*/, const CameraCalibration&) {}
  /// A text that stays the same throughout the run, with the extension of its file's name ("yaml"). The first call
  /// writes it, so a sensor may pass it after every frame.
  virtual void text(const std::string& stem, const std::string& extension, std::string_view text) = 0;
  /// Whole rows of a table that grows with each frame and always has the same columns. A column "time_s" replaces the
  /// column with the frame's time.
  virtual void rows(std::span<const TableColumn> columns, std::span<const double> values) = 0;
};

/// How a measurement depends on earlier frames.
enum class HistoryDependence : std::uint8_t {
  none,         ///< it does not
  poses,        ///< on the poses of the sensor at earlier due frames
  measurements  ///< on what this or another sensor measured in earlier frames
};

/// A sensor of a scene.
///
/// Frames    the sensor frame: x forward, y left, z up (REP 103); a camera looks along +x.
/// Lifetime  made from its command; check(); then, in each frame in which it is due: begin(), plan(), collect() once
///           the frame has been rendered, and cast(). Destroyed with the simulation. Pointers and spans that getters
///           return are valid as long as the sensor; their content changes with the next measurement.
/// Errors    the constructor and check() throw InputError with the place; cast() may throw InputError.
/// Threads   all calls come from the thread that calls the simulation.
class SIMVIS_API Sensor {
 public:
  virtual ~Sensor() = default;

  /// Throws InputError, with the place, if the device cannot do what the sensor's command requests.
  virtual void check(const TargetLimits&) const {}

  /// Called once before the first plan(), if the type has measure_costs. A sensor that selects a method by predicted
  /// cost keeps the function and calls it when it needs the costs; the first call measures the device unless a file
  /// holds its costs.
  virtual void use_cost_model(const std::function<const CostModel&()>&) {}

  /// Decides whether frames can be skipped, see Simulation::skip_frame().
  virtual HistoryDependence history_dependence() const {
    return visualization() ? HistoryDependence::measurements : HistoryDependence::none;
  }

  /// Called instead of begin() to cast() in a frame that is due but skipped: the sensor may record its pose.
  virtual void skip_frame(const FrameTime&, const glm::dmat4& /*world_from_sensor*/) {}

  /// What sense() is to give. It is asked when the sensor is made, and must not change.
  virtual SensorNeeds needs() const { return {}; }

  /// Announces the frame that is planned next.
  virtual void begin(const FrameTime&) {}

  /// Follows begin() if needs() are any. `world` stays valid until the end of cast().
  virtual void sense(const SensedWorld& /*world*/) {}

  /// Adds the views that this frame needs to `plan`. `world_from_sensor` is rigid: scale along the path is removed.
  virtual void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) = 0;

  /// Reads the rendered results. `results[i]` belongs to `plan.passes[i]`; they are valid during the call only.
  virtual void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) = 0;

  /// Casts the planned rays into the draw list of this frame; follows collect(). Throws InputError if the requested
  /// accuracy cannot be reached in this frame; what the sensor measured before the exception stays complete.
  virtual void cast(RayCaster&) {}

  virtual const Image* color() const { return nullptr; }  ///< last colour image; null if the sensor has none
  virtual const Image* depth() const { return nullptr; }  ///< last depth image; null if the sensor has none
  virtual const Scan* scan() const { return nullptr; }    ///< last scan; null if the sensor gives none
  /// Last reading; null if the sensor gives none. It has its columns, and no rows before the first measurement.
  virtual const Reading* reading() const { return nullptr; }
  /// Further images, by names that the sensor's header gives. Null for any other name.
  virtual const Image* picture(std::string_view) const { return nullptr; }
  /// Single numbers, always the same names in the same order; NaN before the first collect().
  virtual std::span<const NamedValue> values() const { return {}; }

  /// Passes the last measurement to `sink`, for files.
  virtual void write(OutputSink& sink) const = 0;

  /// Whether the sensor sees the content that elements draw for people only: beams, paths, graphs.
  virtual bool visualization() const { return false; }

  /// The measuring method for run.json, e.g. "rasterised" or "planar".
  virtual std::string method() const = 0;

  /// The report on the last measurement.
  virtual SensorReport report() const { return {}; }

  double rate_hz = 0;  ///< from the attribute `rate`; 0: every frame
};

/// A sensor whose measurement is a Reading. A derived class gives the columns to the constructor and calls
/// set_reading() once in each measurement, in collect() or cast(). Files, values, messages and clients follow from the
/// reading.
class SIMVIS_API ReadingSensor : public Sensor {
 public:
  /// Keeps the pose. A sensor that draws or casts overrides it and calls it first.
  void plan(const glm::dmat4& world_from_sensor, const DrawList&, FramePlan&) override {
    world_from_sensor_ = world_from_sensor;
  }
  const Reading* reading() const override { return &reading_; }
  /// The columns of a reading with one row; NaN before the first measurement. Empty for a table of several rows.
  std::span<const NamedValue> values() const override { return values_; }
  void write(OutputSink& sink) const override;
  /// Motion is followed in skipped frames too.
  HistoryDependence history_dependence() const override {
    const SensorNeeds needs = this->needs();
    const bool looks_back = needs.motion || needs.item_motion || needs.item_moves || !needs.joints_of.empty();
    return looks_back ? HistoryDependence::poses : HistoryDependence::none;
  }

 protected:
  /// `one_row` is false for a table whose number of rows varies.
  explicit ReadingSensor(std::vector<TableColumn> columns, bool one_row = true);
  /// Replaces the columns and makes the reading one row of them; for a sensor that learns them from the scene.
  void set_columns(std::vector<TableColumn> columns);
  /// Sets a number of the reading beside its columns; `name` is static text.
  void set_constant(std::string_view name, double value);
  /// Publishes whole rows, measured at the pose of plan(). Their number of values must be a multiple of the number of
  /// columns (asserted).
  void set_reading(const FrameTime& time, std::vector<double> values);
  /// The pose of the last plan().
  const glm::dmat4& world_from_sensor() const { return world_from_sensor_; }

 private:
  Reading reading_;
  std::vector<NamedValue> values_;
  glm::dmat4 world_from_sensor_{1.0};
};

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
  /// messages/from_reading.h lists them, and the columns that each uses. Empty: a std_msgs/msg/Float64 for each column.
  std::string_view message{};
  AttributeTable attributes;  ///< its own attributes; all_attributes() adds those of its effects
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
};

/// A sensor of the scene, as run.json and users see it.
struct SIMVIS_API SensorInfo {
  std::string name,                             ///< the sensor's name
      type,                                     ///< its type
      method;                                   ///< how it measures, see Sensor::method()
  std::uint64_t frames = 0;                     ///< number of measurements so far
  bool enabled = true;                          ///< false: turned off
  SensorReport report{};                        ///< on its last measurement
  std::optional<double> depth_error_bound_m{};  ///< of its last depth image; empty unless with_bounds() sets it
  std::vector<std::string> effects{};           ///< effects that any of its measurements had, as the plan named them
  std::uint8_t capabilities = 0;                ///< of its type, as a sum of SensorCapability
  double rate_hz = 0;                           ///< measurements per second; 0: every frame

  /// The note of the report with this name, if it is a number; empty otherwise.
  std::optional<double> number(std::string_view note) const;
};

/// The row `rate`, for the table of a sensor type.
inline constexpr AttributeSpec kRateAttribute{.name = "rate",
                                              .kind = AttributeKind::number,
                                              .unit = "Hz",
                                              .text = "measurements per second; default: every frame",
                                              .min = 0,
                                              .open_min = true};

/// Attributes that every sensor command may carry in addition to its type's own.
inline constexpr std::string_view kSensorCommonAttributes[] = {"type",        "name",       "insert_at",
                                                               "pose_offset", "quaternion", "look_at"};

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
