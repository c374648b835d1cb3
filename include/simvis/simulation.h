// The way in for programs: load a scene, set parameters, step, read what the sensors saw.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include <simvis/device.h>
#include <simvis/error.h>
#include <simvis/image.h>
#include <simvis/parameters.h>
#include <simvis/progress.h>
#include <simvis/renderer.h>
#include <simvis/scan.h>
#include <simvis/sensor.h>
#include <simvis/sensor_cost.h>

namespace simvis {

/// An attribute written over those of all sensors of one type, before the scene is built.
struct AttributeOverride {
  std::string sensor_type, attribute;
  std::optional<std::string> value;  ///< nothing: what the scene says is dropped, so that the default counts
  std::string origin;                ///< who asks for it, for messages: "--method"; empty: "SENSOR_TYPE.ATTRIBUTE"
};

struct SimulationDesc {
  double rate_hz = 15;     ///< frames per simulated second, finite and above 0
  std::uint64_t seed = 0;  ///< of all random numbers
  DeviceDesc device;
  std::vector<AttributeOverride> overrides;
  /// Called while parts are read (load, execute) and while the meshes that a step shows for the first time are
  /// prepared.
  ProgressCallback progress{};
};

/// A sensor of the scene, as run.json and users see it.
struct SensorInfo {
  std::string name, type, method;
  std::uint64_t frames = 0;  ///< how often it has measured
  bool enabled = true;
  SensorReport report{};                        ///< of its last measurement
  std::optional<double> depth_error_bound_m{};  ///< of its last depth image; empty unless asked for, see with_bounds()
  std::vector<std::string> effects{};           ///< that any of its measurements had, as the plan named them

  /// A note of the report that is a number, by its name; empty if there is none.
  std::optional<double> number(std::string_view note) const;
};

/// One stage of a step, on the steady clock. "render" ends when the device has done, and what casts alone has cast;
/// with step_async() the caller's own work lies in it.
struct StageTime {
  std::string_view name;  ///< "elements", "flatten", "plan", "render", "collect" or "visualization"
  std::int64_t start_ns = 0, end_ns = 0;
};

/// A running simulation. All sensors are enabled at load; what is off is not rendered.
///
/// Frames   world and sensors: x forward, y left, z up (REP 103), metres.
/// Time     frame k is taken at round(k * 10^9 / rate) nanoseconds; a sensor with `rate` f fires at the first frame at
///          or after each j / f.
/// Errors   InputError for what the user gave (scene, names, values), MachineError for the device.
/// Threading  one thread at a time, of any.
class Simulation {
 public:
  /// Throws InputError with FILE:LINE:COLUMN for any mistake in the scene or its parts, before anything is rendered;
  /// MachineError if no device fits.
  static Simulation load(const std::filesystem::path& scene, const SimulationDesc& desc = {});
  /// The same from text; relative file names start at `folder`, and `name` stands for the file in messages.
  static Simulation from_string(std::string_view xml, const SimulationDesc& desc = {},
                                const std::filesystem::path& folder = ".", const std::string& name = "<string>");

  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  /// Sets a parameter, in the unit of its element's table (angles in degrees). It takes effect at the next step().
  /// Throws InputError: no such element or parameter (the nearest suggested), not finite, out of range; the old value
  /// is then kept.
  void set(std::string_view element, std::string_view parameter, double value);
  double get(std::string_view element, std::string_view parameter) const;

  /// Executes more commands: parts, elements and sensors come into the running scene, and show from the next step() on.
  /// Relative file names start at `folder`, and `name` stands for the text in messages. All or nothing: when it throws
  /// InputError, with the place, the scene is as it was. The text is logged in parameters().change_requests().
  void execute(std::string_view xml, const std::filesystem::path& folder = ".", const std::string& name = "<string>");

  /// The command that made a sensor, as it was executed: with overrides, its preset written out, and with its names and
  /// insertion point as the part that carries it has given them. Throws InputError when there is no such sensor.
  const Command& command(std::string_view sensor) const;

  /// Adds a sensor that stands where `sensor` does, whatever moves that one, and measures as `command` says; overrides
  /// do not touch it. To see one thing by several methods: `command` is that of `sensor` with another name and other
  /// attributes (type and view stay; insert_at and pose_offset play no part). All or nothing, as execute().
  void add_variant(std::string_view sensor, const Command& command);

  /// Turns a sensor on or off.
  void enable(std::string_view sensor, bool on);

  /// Makes one frame: elements, flattening, planning, rendering, collecting.
  /// Throws InputError where a scanner cannot keep its tolerance: the frame then counts as not made, measured() is
  /// empty, and each sensor holds a whole measurement, its last one or that of this frame. It can be tried again.
  void step();

  /// The first half of a step: all that comes before the device's work, which goes on when it returns. Frames made so
  /// are to the byte those of step(). It begins with finish(), so that in
  ///
  ///   for (...) { simulation.set(...); simulation.step_async(); use(simulation.scan("FRONT")); }  simulation.finish();
  ///
  /// each scan is that of the frame before, and is used while the device draws the next. Until finish() there are
  ///   set(), get(), parameters()  of the frame after: what they set takes effect at the next step
  ///   next_frame()                the frame after
  ///   measured(), scan(), color(), depth(), picture(), write()  of the frame before
  /// and nothing else: other calls throw InputError.
  void step_async();

  /// Waits for the frame that is under way, if one is, casts what is cast and hands over the results. Throws as step():
  /// the frame then counts as not made, is no longer under way, and can be tried again.
  void finish();

  /// Passes over the frame that step() would make next: nothing is rendered or measured, and results stay as they are.
  /// Only sensors that look back at where they stood (`sweep`, `rolling_shutter`) take note of it; where none does,
  /// this costs nothing. Frames made between others that are passed over are to the byte those of a run that makes all.
  /// Throws InputError where they cannot be: see require_skippable().
  void skip_frame();

  /// Throws InputError naming a sensor that is on and looks back at what was measured before: a scanner of method
  /// "auto", whose choices follow from the frames before, or a visualization camera.
  void require_skippable() const;

  /// Of the frame that the next step makes.
  FrameTime next_frame() const;

  /// What a sensor last measured. Empty (no pixels, no ranges) before it first fired.
  /// Throws InputError when there is no such sensor, or it has no such output.
  const Scan& scan(std::string_view sensor) const;
  const Image& color(std::string_view sensor) const;
  const Image& depth(std::string_view sensor) const;
  /// Pictures that only some sensors take, by names that the sensor's header gives: "right", "disparity".
  const Image& picture(std::string_view sensor, std::string_view name) const;
  /// One of a sensor's single numbers, as its table names them: "voltage_v". NaN before it first fired.
  double value(std::string_view sensor, std::string_view name) const;
  /// The same; empty where the sensor has no number of that name.
  std::optional<double> find_value(std::string_view sensor, std::string_view name) const;

  /// The four arrays: descriptors, values, change requests, changes.
  Parameters& parameters();
  const Parameters& parameters() const;

  /// world_from_sensor as of the last step(): rigid, in the sensor frame x forward, y left, z up. False if the sensor
  /// stands in a part that is switched off. Throws InputError when there is no such sensor.
  bool sensor_pose(std::string_view sensor, glm::dmat4& world_from_sensor) const;

  std::vector<SensorInfo> sensors() const;
  /// Names of the sensors that measured in the last step().
  std::span<const std::string> measured() const;
  /// Hands what the named sensor last measured to `sink`.
  void write(std::string_view sensor, OutputSink& sink) const;

  const std::vector<std::string>& warnings() const;
  const DeviceInfo& device() const;
  const FrameCounters& counters() const;  ///< of the last step()
  RayCounters ray_counters() const;       ///< of all steps
  const DrawList& draw_list() const;      ///< of the last step()
  const FramePlan& frame_plan() const;    ///< of the last step(), complete: see engine/frame_plan.h
  /// Of the last step(); null unless SimulationDesc::device is instrumented.
  const FrameCosts* frame_costs() const;
  /// The same of what visualization cameras saw. Null while the scene has none.
  const FramePlan* visualization_plan() const;
  const FrameCounters* visualization_counters() const;
  const FrameCosts* visualization_costs() const;
  /// Of the sensors that measured in the last step(), in this order; empty unless the device is instrumented.
  std::span<const SensorCost> sensor_costs() const;
  /// All that SimVis holds of the device's memory: what the plans name, and nothing else.
  std::uint64_t device_memory_bytes() const;
  /// The stages of the last step(), in order. Empty before the first.
  std::span<const StageTime> stages() const;
  std::uint64_t validation_messages() const;

 private:
  struct Impl;
  explicit Simulation(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// SimVis's version, "MAJOR.MINOR.PATCH".
std::string_view version();

}  // namespace simvis
