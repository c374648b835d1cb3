// Sensors: the same mechanism as elements, with data out instead of parameters in.
//
// To add one: a pair of files here with a class, its attribute table, and one static SensorRegistration. Nothing else
// is edited. A class in a user's own program or in a plug-in library registers the same way.
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
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/frame_time.h>
#include <simvis/image.h>
#include <simvis/ray_caster.h>
#include <simvis/scan.h>
#include <simvis/sensor_preset.h>
#include <simvis/target_limits.h>
#include <simvis/version.h>

namespace simvis {

class Device;

/// One column of a table that a sensor writes, and how its numbers are printed (a printf format for one double, or
/// for one long long where `integer`). A value that is NaN is printed as an empty cell.
struct TableColumn {
  std::string name;
  std::string format;
  bool integer = false;
};

/// One number that a sensor measured; its unit is in the name, as in "range_m".
struct NamedValue {
  std::string_view name;
  double value = 0;
};

/// One thing that run.json says of a sensor.
struct SensorNote {
  std::string name;
  std::variant<double, std::uint64_t, std::string> value;
};

/// What a sensor has to say of how it measures, besides its method.
struct SensorReport {
  std::vector<SensorNote> notes;  ///< for run.json, in this order; names as there
  std::string explanation;        ///< for --explain: whole lines
};

/// Takes what a sensor has to write after a frame. Implemented by whoever makes files.
class OutputSink {
 public:
  virtual ~OutputSink() = default;
  /// One picture per frame. Either may be null. `stem` is added to the folder's name for sensors with several
  /// pictures ("left", "right"); empty for one.
  virtual void picture(const std::string& stem, const Image* color, const Image* depth) = 0;
  /// One more picture per frame, of a single channel of that name: "disparity".
  virtual void plane(const std::string& stem, const std::string& channel, const Image& plane) = 0;
  /// A text that is the same throughout the run, with the extension of its file's name ("yaml"). It is written when it
  /// first comes; so a sensor may hand it over after every frame.
  virtual void text(const std::string& stem, const std::string& extension, std::string_view text) = 0;
  /// Whole rows of a table that grows with each frame, of the same columns; "time_s" takes the place of the frame's.
  virtual void rows(std::span<const TableColumn> columns, std::span<const double> values) = 0;
};

/// What of earlier frames a measurement depends on: nothing; where the sensor stood when it was due; what it, or
/// others, measured then.
enum class HistoryDependence : std::uint8_t { none, poses, measurements };

/// Frames   the sensor frame: x forward, y left, z up (REP 103); a camera looks along +x.
/// Life     made from its command; check(); then, in each frame in which it is due: begin(), plan(), collect() once
///          the frame has been rendered, and cast().
class Sensor {
 public:
  virtual ~Sensor() = default;

  /// Throws InputError, with the place, where the device cannot do what the sensor's command asks for.
  virtual void check(const TargetLimits&) const {}

  /// Called once before the first plan(), where the sensor's type has measure_costs. Sensors that choose a method by
  /// predicted cost call the function; the first call measures the device or reads its costs from the cache.
  virtual void use_cost_model(const std::function<const CostModel&()>&) {}

  /// Who is asked decides whether frames can be passed over, see Simulation::skip_frame().
  virtual HistoryDependence history_dependence() const {
    return visualization() ? HistoryDependence::measurements : HistoryDependence::none;
  }

  /// In place of begin() to cast(), in a frame that is due but passed over: only where it stands then is of interest.
  virtual void skip_frame(const FrameTime&, const glm::dmat4& /*world_from_sensor*/) {}

  /// The frame that is planned next.
  virtual void begin(const FrameTime&) {}

  /// Adds the views that this frame needs to `plan`. `world_from_sensor` is rigid: scale along the way is taken out.
  virtual void plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) = 0;

  /// Takes its results. `results[i]` belongs to `plan.passes[i]`.
  virtual void collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) = 0;

  /// Casts what it has planned to cast, into the draw list of this frame; follows collect(). Throws InputError where
  /// what the user asked for cannot be had in this frame; what was taken before then stands, whole.
  virtual void cast(RayCaster&) {}

  /// What collect() and cast() last took; null where the sensor has none of the kind.
  virtual const Image* color() const { return nullptr; }
  virtual const Image* depth() const { return nullptr; }
  virtual const Scan* scan() const { return nullptr; }
  /// Pictures besides those, by names that the sensor's header gives.
  virtual const Image* picture(std::string_view) const { return nullptr; }
  /// Single numbers, always the same names in the same order; NaN before the first collect().
  virtual std::span<const NamedValue> values() const { return {}; }

  /// Hands over what the last collect() took, for files.
  virtual void write(OutputSink& sink) const = 0;

  /// Whether it looks at the scene as people do, with what elements draw for them alone: beams, paths, graphs.
  virtual bool visualization() const { return false; }

  /// For run.json: how the sensor measures, e.g. "rasterised" or "planar".
  virtual std::string method() const = 0;

  /// Of the last measurement.
  virtual SensorReport report() const { return {}; }

  double rate_hz = 0;  ///< from the attribute `rate`; 0 = every frame
};

/// What a sensor's constructor gets.
struct SensorContext {
  const Command& command;
  const AttributeValues& attributes;
  std::string name;
  std::uint64_t seed = 0;  ///< of all random numbers of the run
};

struct SensorType {
  std::string_view name;      ///< the command's `type`
  std::string_view summary;   ///< one sentence
  std::string_view notes{};   ///< what the table does not say: paragraphs, separated by '\n'; may be empty
  AttributeTable attributes;  ///< its own: all_attributes() has those of its effects besides
  std::unique_ptr<Sensor> (*create)(const SensorContext& context);
  std::span<const SensorPreset> presets{};  ///< a type with some has the row kPresetAttribute
  /// Measures on this device what each term of the cost model costs, in nanoseconds, for sensors that choose a method
  /// by predicted cost. It takes about 0.3 s. Null: the sensors of this type do not choose.
  CostModel (*measure_costs)(Device& device, RayCaster& rays) = nullptr;
};

/// The row `rate`, for the table of a sensor type.
inline constexpr AttributeSpec kRateAttribute{.name = "rate",
                                              .kind = AttributeKind::number,
                                              .unit = "Hz",
                                              .text = "measurements per second; default: every frame",
                                              .min = 0,
                                              .open_min = true};

/// Attributes that every sensor command may carry besides its type's own.
inline constexpr std::string_view kSensorCommonAttributes[] = {"type", "name", "insert_at", "pose_offset"};

/// A static object of this type makes a sensor type known; the strings and the table must live as long.
/// A type whose name is taken, whose table has a mistake, or that was compiled with headers of another version is not
/// made known: load_plugin() refuses the plug-in that has it, and Simulation::load() throws InputError for one of the
/// program itself.
struct SensorRegistration {
  explicit SensorRegistration(const SensorType& type, std::string_view built_for = kHeaderVersion);
};

/// Null when there is none of that name.
const SensorType* find_sensor_type(std::string_view name);
/// Sorted by name.
std::vector<const SensorType*> sensor_types();

/// Its own attributes and those of the effects in the catalogue that it may have, see effects/effect.h.
std::vector<AttributeSpec> all_attributes(const SensorType& type);

}  // namespace simvis
